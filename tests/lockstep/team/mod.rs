//! Teams of two robots in sessions, in one thread, millisecond by millisecond: goals that begin
//! together, and a fault of one robot that brakes the other.

mod beginning;
mod faults;
mod stops;
mod waiting;

use std::time::Duration;

use franka_lockstep::{Lockstep, outcomes_of, turned};
use franka_model::{READY, RobotKind};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{Deadman, Goal, GoalId, Guard, Lapse, OnArrival, Target};
use franka_rt::team::{Coordinator, Member, MemberFault, Round, TeamStop, team};
use franka_sim::{Arm, Config};

/// An FR3 and an FER that stick and lag as real arms do, in one team.
struct Pair {
    robots: [Lockstep; 2],
    sessions: [GoalId; 2],
    coordinator: Coordinator,
    /// True if the milliseconds of the second robot come first.
    swapped: bool,
    /// The tick at which the team was first seen to have stopped, and those at which the records of
    /// the members say so.
    stopped: Option<u64>,
    braked: [Option<u64>; 2],
    ticks: u64,
    /// Deadman of the first robot, which is silent for good once it is dropped.
    deadman: Option<Deadman>,
}

impl Pair {
    fn new(swapped: bool) -> Self {
        Self::of(team(), swapped)
    }

    fn of((coordinator, [left, right]): (Coordinator, [Member; 2]), swapped: bool) -> Self {
        let robot = |kind| {
            Lockstep::new(Config {
                arm: Some(Arm::realistic(kind)),
                ..Lockstep::config_of(kind)
            })
        };
        let mut robots = [robot(RobotKind::Fr3), robot(RobotKind::Fer)];
        let wary = CollisionBehavior::uniform([20.0; 7], [25.0; 7], [25.0; 6], [30.0; 6]);
        robots[0].request(&Request::SetCollisionBehavior(wary));
        robots[0].run(5);
        let mut members = [Some(left), Some(right)];
        let (deadman, monitor) = Deadman::new(Duration::from_secs(3600));
        let mut monitor = Some(monitor);
        let sessions = core::array::from_fn(|i| {
            robots[i].engage_with(Engagement {
                team: members[i].take(),
                deadman: monitor.take(),
                ..Engagement::default()
            })
        });
        Self {
            deadman: Some(deadman),
            robots,
            sessions,
            coordinator,
            swapped,
            stopped: None,
            braked: [None; 2],
            ticks: 0,
        }
    }

    fn tick(&mut self) {
        self.ticks += 1;
        for i in if self.swapped { [1, 0] } else { [0, 1] } {
            self.robots[i].tick();
            let record = &self.robots[i].client.record;
            if record.bindings.contains(Guard::Team) {
                self.braked[i].get_or_insert(self.ticks);
            }
            if self.coordinator.stopped().is_some() {
                self.stopped.get_or_insert(self.ticks);
            }
        }
    }

    fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }

    fn submit(&mut self, member: usize, round: Option<Round>, target: Target) -> GoalId {
        let goal = self.robots[member].goal(target, OnArrival::ReportAndHold);
        self.submit_goal(member, Goal { round, ..goal })
    }

    fn submit_goal(&mut self, member: usize, goal: Goal) -> GoalId {
        let session = self.sessions[member];
        let taken = self.robots[member].submit_within(session, goal);
        taken.expect("the session takes it")
    }

    /// A joint motion of both arms, turned by so much.
    fn both(&mut self, by: [f64; 2]) -> [GoalId; 2] {
        let round = Some(self.coordinator.begin());
        [0, 1].map(|i| self.submit(i, round, turned(by[i])))
    }

    fn until_resolved(&mut self, goals: [GoalId; 2], most: u64) -> [Result<(), MotionError>; 2] {
        for _ in 0..most {
            if let Some(outcomes) = outcomes_of(self.robots.each_ref(), goals) {
                return outcomes;
            }
            self.tick();
        }
        panic!("unresolved after {most} ms");
    }

    /// Runs until the goal of this member is resolved.
    fn until_one_resolved(
        &mut self,
        member: usize,
        goal: GoalId,
        most: u64,
    ) -> Result<(), MotionError> {
        for _ in 0..most {
            if let Some([outcome]) = outcomes_of([&self.robots[member]], [goal]) {
                return outcome;
            }
            self.tick();
        }
        panic!("unresolved after {most} ms");
    }

    fn moved(&self, member: usize) -> f64 {
        (self.robots[member].robot.q() - READY).amax()
    }
}

fn stopped_by(fault: MemberFault) -> Result<(), MotionError> {
    let stop = TeamStop::Member { member: 0, fault };
    Err(MotionError::Braked(Lapse::Team(stop)))
}
