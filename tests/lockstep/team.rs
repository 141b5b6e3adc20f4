//! Teams of two robots in sessions: goals that begin together, and a fault of one that brakes the
//! other, both in one thread, millisecond by millisecond.

use franka_model::{READY, RobotKind};
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::driver::Driver;
use franka_rt::lifecycle::{Engagement, MotionError, NewMotion};
use franka_rt::session::condition::elapsed;
use franka_rt::session::{Deadman, Goal, GoalId, Guard, Lapse, OnArrival, Reaction, Target};
use franka_rt::team::{Coordinator, Member, MemberFault, Round, TeamStop, team, team_tolerating};
use franka_sim::{Arm, Config, Touch};
use franka_tests::lockstep::{Lockstep, Outcome};
use nalgebra::{Isometry3, Translation3, Vector3};
use std::time::Duration;

/// An FR3 and an FER that stick and lag as real arms do, in one team.
struct Pair {
    robots: [Lockstep; 2],
    sessions: [GoalId; 2],
    coordinator: Coordinator,
    /// Whether the milliseconds of the second robot come first.
    swapped: bool,
    /// The tick at which the team was first seen to have stopped, and those at which the records of
    /// the members say so.
    stopped: Option<u64>,
    braked: [Option<u64>; 2],
    ticks: u64,
    /// That of the first robot, which is silent for good once it is dropped.
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
            let of = |i: usize| self.robots[i].client.outcome(goals[i]).cloned();
            if let (Some(left), Some(right)) = (of(0), of(1)) {
                let plain = |outcome: Outcome| outcome.map(drop);
                return [plain(left), plain(right)];
            }
            self.tick();
        }
        panic!("unresolved after {most} ms");
    }

    fn moved(&self, member: usize) -> f64 {
        (self.robots[member].robot.q() - READY).amax()
    }
}

fn turned(by: f64) -> Target {
    let mut q: [f64; 7] = READY.into();
    q[0] += by;
    Target::Joints(q)
}

fn stopped_by(fault: MemberFault) -> Result<(), MotionError> {
    let stop = TeamStop::Member { member: 0, fault };
    Err(MotionError::Braked(Lapse::Team(stop)))
}

#[test]
fn goals_begin_in_the_same_millisecond_and_each_resolves_when_it_arrives() {
    for (swapped, late) in [(false, 0), (true, 0), (false, 1), (true, 700)] {
        let mut pair = Pair::new(swapped);
        // Twice, in the same sessions.
        for by in [0.1, -0.1] {
            let before = [0, 1].map(|i| *pair.robots[i].robot.q());
            let round = Some(pair.coordinator.begin());
            let first = pair.submit(0, round, turned(by));
            pair.run(late);
            assert!((pair.robots[0].robot.q() - before[0]).amax() < 2e-3);
            let second = pair.submit(1, round, turned(2.0 * by));
            let mut began = [None; 2];
            for ms in 0..50 {
                pair.tick();
                for (i, began) in began.iter_mut().enumerate() {
                    if pair.robots[i].client.record.dq_ref != [0.0; 7] {
                        began.get_or_insert(ms);
                    }
                }
            }
            let [Some(left), Some(right)] = began else {
                panic!("both have begun: {began:?}")
            };
            assert!(i32::abs_diff(left, right) <= 1, "{began:?}");
            let ended = pair.until_resolved([first, second], 20_000);
            assert_eq!(ended, [Ok(()), Ok(())]);
        }
        // The shorter motion has arrived long before the other: that is no fault.
        assert_eq!((pair.stopped, pair.braked), (None, [None; 2]));
    }
}

/// What happens to the first robot, and what the second one's motion ends with.
struct Case {
    name: &'static str,
    happen: fn(&mut Pair, GoalId),
    fault: MemberFault,
    /// Cycles from that to the one in which the thread of the first robot has to have seen it.
    seen_after: core::ops::RangeInclusive<u64>,
    /// Whether its session goes on.
    goes_on: bool,
}

const CASES: [Case; 10] = [
    Case {
        name: "deadman dropped",
        happen: |pair, _| pair.deadman = None,
        fault: MemberFault::GivenUp,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "user stop",
        happen: |pair, _| pair.robots[0].robot.press_user_stop(true),
        fault: MemberFault::RobotStopped,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "collision",
        happen: |pair, _| {
            let robot = &mut pair.robots[0].robot;
            let hand = robot.true_pose().translation.vector;
            let wall = Touch::wall(hand + Vector3::y() * 0.01, -Vector3::y());
            robot.touch(wall.stiffness(20_000.0));
        },
        fault: MemberFault::RobotStopped,
        seen_after: 1..=400,
        goes_on: false,
    },
    Case {
        name: "link cut",
        happen: |pair, _| pair.robots[0].link.drop_states(1500),
        fault: MemberFault::Silent,
        seen_after: 20..=20,
        goes_on: false,
    },
    Case {
        name: "control thread gone",
        happen: |pair, _| {
            let client = &mut pair.robots[0].client;
            client.driver = Driver::new(client.version());
        },
        fault: MemberFault::Gone,
        seen_after: 0..=1,
        goes_on: false,
    },
    Case {
        name: "future dropped",
        happen: |pair, goal| pair.robots[0].cancel(goal),
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: true,
    },
    Case {
        name: "stopped",
        happen: |pair, _| {
            let stopping = pair.robots[0].stop();
            stopping.expect("it moves");
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "disengaged",
        happen: |pair, _| {
            let session = pair.sessions[0];
            pair.robots[0].disengage(session);
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "another goal",
        happen: |pair, _| {
            pair.submit(0, None, turned(0.0));
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: true,
    },
    Case {
        name: "connection closed",
        happen: |pair, _| {
            let reason = franka_rt::lifecycle::CloseReason::ClosedByPeer;
            pair.robots[0].client.close(reason);
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: false,
    },
];

#[test]
fn a_fault_of_one_brakes_the_other_within_two_cycles() {
    for case in CASES {
        for swapped in [false, true] {
            let name = case.name;
            let mut pair = Pair::new(swapped);
            let goals = pair.both([1.0, 1.0]);
            pair.run(700);
            let speed = pair.robots[1].client.record.dq_ref[0];
            assert!(speed > 0.2, "{name}: it is under way, {speed} rad/s");
            assert_eq!(pair.stopped, None, "{name}");
            let happened = pair.ticks;
            (case.happen)(&mut pair, goals[0]);
            while pair.stopped.is_none() {
                pair.tick();
                assert!(pair.ticks < happened + 2000, "{name}: nothing happens");
            }
            let seen = pair.stopped.expect("it was waited for");
            let after = seen - happened;
            assert!(case.seen_after.contains(&after), "{name}: {after} cycles");
            if case.fault == MemberFault::RobotStopped {
                // In the very cycle in which the state said so.
                let mode = pair.robots[0].client.state.robot_mode;
                assert_ne!(mode, RobotMode::Move, "{name}");
            }
            pair.run(2);
            let braked = pair.braked[1].unwrap_or_else(|| panic!("{name}: it goes on"));
            let cycles = braked - seen;
            assert!(cycles <= 2, "{name}: {cycles} cycles");
            println!("{name}: seen after {after} cycles, brakes after {cycles} more");
            pair.run(400);
            let record = &pair.robots[1].client.record;
            assert_eq!(record.dq_ref, [0.0; 7], "{name}: it rests after 0.4 s");
            let outcome = pair.robots[1].until_resolved(goals[1], 3000);
            assert_eq!(outcome.map(drop), stopped_by(case.fault), "{name}");
            assert!(pair.moved(1) < 0.9, "{name}: {}", pair.moved(1));
            let own = pair.robots[0].client.outcome(goals[0]);
            assert!(
                matches!(own, None | Some(Err(_))),
                "{name}: its own error names the cause: {own:?}"
            );
            // The other session goes on, alone or with the next joint motion.
            let back = [0, 1].map(|i| pair.robots[i].robot.q()[0] - READY[0] + 0.1);
            if case.goes_on {
                let goals = pair.both(back);
                let ended = pair.until_resolved(goals, 20_000);
                assert_eq!(ended, [Ok(()), Ok(())], "{name}");
            } else {
                let alone = pair.submit(1, None, turned(back[1]));
                let outcome = pair.robots[1].until_resolved(alone, 20_000);
                outcome.unwrap_or_else(|error| panic!("{name}: {error}"));
            }
        }
    }
}

#[test]
fn each_silence_of_one_brakes_the_other_anew() {
    let mut pair = Pair::of(team_tolerating(Duration::from_millis(5)), false);
    for (by, silence) in [(0.5, 4), (-0.5, 8), (0.5, 8)] {
        let goals = pair.both([by, by]);
        pair.run(300);
        // Too short for the robot to stop by itself.
        pair.robots[0].link.drop_states(silence);
        let [_, other] = pair.until_resolved(goals, 20_000);
        let braked = stopped_by(MemberFault::Silent);
        assert_eq!(other, if silence < 5 { Ok(()) } else { braked });
    }
}

/// The clock of the second robot runs at half the speed of the first one's, which would so be ahead
/// by 5 cm with what both hold.
#[test]
fn a_reference_halts_while_it_is_ahead_of_another_one() {
    let mut pair = Pair::new(false);
    let round = Some(pair.coordinator.begin());
    let start = [0, 1].map(|i| pair.robots[i].reference_pose().translation.vector);
    let goals = [0, 1].map(|i| {
        let hand = pair.robots[i].reference_pose();
        let up = Target::Pose(Translation3::new(0.0, 0.0, 0.1) * hand);
        let goal = pair.robots[i].goal(up, OnArrival::ReportAndHold);
        let goal = Goal {
            round,
            grasp: Some(Isometry3::identity()),
            budget: goal.budget.scaled(0.1),
            ..goal
        };
        pair.submit_goal(i, goal)
    });
    let mut ahead = 0.0_f64;
    for ms in 0..20_000 {
        pair.robots[0].tick();
        if ms % 2 == 0 {
            pair.robots[1].tick();
        }
        let [one, other] = [0, 1].map(|i| {
            let hand = pair.robots[i].reference_pose().translation.vector;
            (hand - start[i]).norm()
        });
        ahead = ahead.max((one - other).abs());
    }
    println!("ahead by {ahead:.4} m");
    // 2 mm, and the way in which it halts at 3 cm/s.
    assert!(ahead < 4e-3, "{ahead} m");
    assert_eq!(pair.until_resolved(goals, 20_000), [Ok(()), Ok(())]);
}

#[test]
fn an_arm_that_something_holds_brakes_the_other() {
    let mut pair = Pair::new(false);
    let hand = pair.robots[0].robot.true_pose();
    let wall = Touch::wall(hand.translation.vector + Vector3::z() * 0.02, -Vector3::z());
    pair.robots[0].robot.touch(wall.stiffness(2000.0));
    let round = Some(pair.coordinator.begin());
    let up = |by: f64| Target::Pose(Translation3::new(0.0, 0.0, by) * hand);
    let first = pair.robots[0].goal(up(0.06), OnArrival::ReportAndHold);
    let first = Goal {
        force_cap: franka_rt::session::ForceCap::Newtons(8.0),
        round,
        ..first
    };
    let first = pair.submit_goal(0, first);
    // Slow enough to be under way when the first one gives up.
    let second = pair.robots[1].goal(turned(1.2), OnArrival::ReportAndHold);
    let second = Goal {
        budget: second.budget.scaled(0.08),
        round,
        ..second
    };
    let second = pair.submit_goal(1, second);
    let [held, braked] = pair.until_resolved([first, second], 30_000);
    assert!(
        matches!(held, Err(MotionError::TargetNotReached(_))),
        "{held:?}"
    );
    assert_eq!(braked, stopped_by(MemberFault::NotReached));
}

#[test]
fn a_stop_from_outside_brakes_all_and_the_next_motion_begins() {
    let mut pair = Pair::new(false);
    let goals = pair.both([0.6, 0.6]);
    pair.run(500);
    pair.coordinator.stop();
    let stopped = pair.ticks;
    pair.run(2);
    for braked in pair.braked {
        let braked = braked.expect("each brakes");
        assert!(braked <= stopped + 2, "{braked}, {stopped}");
    }
    let requested = Err(MotionError::Braked(Lapse::Team(TeamStop::Requested)));
    let ended = pair.until_resolved(goals, 3000);
    assert_eq!(ended, [requested.clone(), requested]);
    let goals = pair.both([0.1, 0.1]);
    assert_eq!(pair.until_resolved(goals, 20_000), [Ok(()), Ok(())]);
}

#[test]
fn without_the_others_nothing_begins() {
    // The goal of the first robot is refused.
    let mut pair = Pair::new(false);
    let round = pair.coordinator.begin();
    let second = pair.submit(1, Some(round), turned(0.3));
    pair.run(100);
    let goal = pair.robots[0].goal(turned(9.0), OnArrival::ReportAndHold);
    let session = pair.sessions[0];
    let round_of = |goal| Goal {
        round: Some(round),
        ..goal
    };
    let refused = pair.robots[0].submit_within(session, round_of(goal));
    assert!(matches!(refused, Err(MotionError::Goal(_))), "{refused:?}");
    pair.coordinator.refuse(round, 0);
    let outcome = pair.robots[1].until_resolved(second, 2000);
    assert_eq!(outcome.map(drop), stopped_by(MemberFault::Refused));
    assert!(pair.moved(1) < 2e-3, "{}", pair.moved(1));

    // It is taken back while it waits.
    let round = Some(pair.coordinator.begin());
    let first = pair.submit(0, round, turned(0.3));
    pair.run(100);
    pair.robots[0].cancel(first);
    pair.run(2);
    let second = pair.submit(1, round, turned(0.3));
    let ended = pair.until_resolved([first, second], 2000);
    assert_eq!(ended[0], Err(MotionError::Stopped));
    assert_eq!(ended[1], stopped_by(MemberFault::TakenBack));

    // It never comes.
    let round = Some(pair.coordinator.begin());
    let first = pair.submit(0, round, turned(0.3));
    let outcome = pair.robots[0].until_resolved(first, 12_000);
    assert_eq!(outcome.map(drop), stopped_by(MemberFault::TimedOut));
    assert!(pair.moved(0) < 2e-3 && pair.moved(1) < 2e-3);
}

#[test]
fn a_reaction_and_a_motion_of_one_arm_alone_concern_no_other() {
    let mut pair = Pair::new(false);
    let round = Some(pair.coordinator.begin());
    let reacting = Goal {
        round,
        reaction: Some(Reaction::from(elapsed(Duration::from_millis(400)))),
        ..pair.robots[0].goal(turned(0.6), OnArrival::ReportAndHold)
    };
    let first = pair.submit_goal(0, reacting);
    let second = pair.submit(1, round, turned(0.6));
    let ended = pair.until_resolved([first, second], 20_000);
    assert_eq!(ended, [Ok(()), Ok(())]);
    assert!(pair.moved(0) < 0.5 && pair.moved(1) > 0.59);
    let alone = pair.submit(0, None, turned(0.2));
    pair.run(100);
    pair.robots[0].cancel(alone);
    pair.run(1000);
    assert_eq!(pair.stopped, None);
    // But the end of its session brakes whatever the other one does.
    let other = pair.submit(1, None, turned(0.0));
    pair.run(300);
    pair.robots[0].robot.press_user_stop(true);
    pair.run(3);
    let outcome = pair.robots[1].until_resolved(other, 3000);
    assert_eq!(outcome.map(drop), stopped_by(MemberFault::RobotStopped));
}

#[test]
fn a_goal_that_comes_before_the_first_state_of_its_session_waits_too() {
    let (coordinator, [left, mut right]) = team();
    let mut robot = Lockstep::ready();
    let session = robot.begin_session(Engagement {
        team: Some(left),
        ..Engagement::default()
    });
    let round = coordinator.begin();
    let goal = robot.goal(turned(0.2), OnArrival::ReportAndHold);
    let goal = Goal {
        round: Some(round),
        ..goal
    };
    let id = robot
        .client
        .begin(NewMotion::Goal {
            goal: Box::new(goal),
            ticket: None,
            session: Some(session),
        })
        .expect("it is taken");
    robot.run(500);
    assert!((robot.robot.q() - READY).amax() < 1e-3, "it waits");
    right.pass(round, 0);
    robot.until_resolved(id, 10_000).expect("it arrives");
    right.leave();
}
