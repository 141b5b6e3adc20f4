//! Tries every input in every state of a running session. Its reference never jumps, a brake ends
//! at rest, and a stop finishes the session without another motion.

use super::*;
use crate::law::Gains;
use crate::session::reference::Reference;
use crate::team::{Coordinator, team};

/// Inputs from the caller, the arm, the team and time. Except for the first three, they apply to
/// the newest goal and use its id.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Begin,
    /// A goal that ends the session.
    Finish,
    /// A held goal with a moving target and a watchdog.
    Stream,
    Guide,
    Update,
    UpdateMoving,
    Points,
    Tune,
    Pause,
    GoOn,
    Cancel,
    /// The condition of the goal becomes true.
    Touch,
    /// The team stops.
    Team,
    /// The deadman is dropped.
    Drop,
    /// Some cycles pass.
    Run,
    /// Goals arrive and watchdogs time out.
    Wait,
}

use Step::*;

const STEPS: [Step; 16] = [
    Begin,
    Finish,
    Stream,
    Guide,
    Update,
    UpdateMoving,
    Points,
    Tune,
    Pause,
    GoOn,
    Cancel,
    Touch,
    Team,
    Drop,
    Run,
    Wait,
];

/// Steps that lead to each state: aim, stage and status of a goal.
const STATES: [&[Step]; 18] = [
    &[Begin],
    &[Begin, Run],
    &[Begin, Run, Pause, Run],
    &[Begin, Run, Cancel, Run],
    &[Begin, Run, Touch, Run],
    &[Begin, Run, Team, Run],
    &[Begin, Run, Drop, Run],
    &[Begin, Wait],
    &[Finish, Run],
    &[Finish, Wait],
    &[Stream, Run],
    &[Stream, Wait],
    &[Stream, Run, Touch, Wait],
    &[Guide, Run],
    &[Points, Run],
    &[Points, Run, Cancel, Run],
    &[Points, Wait],
    &[Points, Run, UpdateMoving, Wait],
];

/// The longest time from a brake until the reference rests, `[ms]`.
const BRAKE: u32 = 600;

/// The longest time from a stop until the session has finished, `[ms]`.
const STOP: u32 = 2000;

/// Joint velocity of a reference at rest, `[rad/s]`.
const REST: f64 = 1e-3;

/// A session whose arm is always at its reference.
struct Bench {
    session: TargetSession,
    goals: Writer<Goal>,
    chunks: ChunkWriter,
    deadman: Option<Deadman>,
    coordinator: Coordinator,
    _other: Member,
    state: RobotState,
    dq: JointVector,
    current: Goal,
    ids: u64,
    settled: Vec<GoalId>,
    is_finished: bool,
    way: Vec<Step>,
}

impl Bench {
    fn in_state(state: &[Step]) -> Self {
        let Arm {
            session,
            goals,
            state: at_start,
            ..
        } = Arm::new();
        let (chunks, reader) = chunk_ring();
        let (deadman, monitor) = Deadman::new(Duration::from_millis(100));
        let (coordinator, [member, other]) = team();
        let limits = Model::fr3().joint_limits();
        let mut bench = Self {
            session: session
                .with_chunks(reader)
                .bound_to(monitor)
                .in_team(member)
                .going_on(),
            goals,
            chunks,
            deadman: Some(deadman),
            coordinator,
            _other: other,
            state: at_start,
            dq: JointVector::zeros(),
            current: Goal::new(GoalId(0), Target::Rest, OnArrival::Hold, limits),
            ids: 0,
            settled: Vec::new(),
            is_finished: false,
            way: Vec::new(),
        };
        for step in state {
            bench.take(*step);
        }
        bench
    }

    /// Positions near the arm, `[rad]`.
    fn near(&self) -> [f64; 7] {
        let mut q = self.state.q;
        q[0] += if self.ids.is_multiple_of(2) {
            0.1
        } else {
            -0.1
        };
        q
    }

    fn moving(&self) -> Target {
        let mut dq = [0.0; 7];
        dq[0] = 0.2;
        let q = self.near();
        Target::MovingJoints { q, dq }
    }

    fn begin(&mut self, target: Target, on_arrival: OnArrival) {
        self.ids += 1;
        let limits = Model::fr3().joint_limits();
        let mut goal = Goal::new(GoalId(self.ids), target, on_arrival, limits);
        match on_arrival {
            OnArrival::Hold => {
                goal.watchdog = Some(Watchdog {
                    silence: Duration::from_millis(300),
                    on_timeout: OnTimeout::Hold,
                });
            }
            _ => goal.reaction = Some(force_z(5.0).then(Target::Rest)),
        }
        self.write(goal);
    }

    /// Changes the newest goal; a `redirected` goal is a new revision.
    fn change(&mut self, redirected: bool, change: impl FnOnce(&mut Goal)) {
        let mut goal = self.current;
        change(&mut goal);
        goal.revision += u64::from(redirected);
        self.write(goal);
    }

    fn write(&mut self, goal: Goal) {
        self.current = goal;
        self.goals.write(goal);
    }

    fn take(&mut self, step: Step) {
        self.way.push(step);
        match step {
            Begin => self.begin(Target::Joints(self.near()), OnArrival::ReportAndHold),
            Finish => self.begin(Target::Joints(self.near()), OnArrival::ReportAndFinish),
            Stream => self.begin(self.moving(), OnArrival::Hold),
            Guide => self.begin(Target::Guide(Free::ALL), OnArrival::Hold),
            Update => {
                let target = Target::Joints(self.near());
                self.change(true, |goal| {
                    (goal.target, goal.along_path) = (target, false)
                });
            }
            // Only a held goal may have a moving target.
            UpdateMoving if self.current.on_arrival == OnArrival::Hold => {
                let target = self.moving();
                self.change(true, |goal| goal.target = target);
            }
            UpdateMoving => {}
            Points => {
                let mut q = self.state.q;
                let points = [0, 100, 200, 300].map(|ms| {
                    q[0] += 0.005;
                    (Duration::from_millis(ms), q)
                });
                // The first chunk's goal also identifies the chunks after it.
                let streams =
                    self.current.watchdog.is_some() && self.current.target == Target::Rest;
                if !streams {
                    self.begin(Target::Rest, OnArrival::Hold);
                }
                let chunk = Chunk::joints(points).expect("they follow each other");
                // If there is no room, the chunk is not sent.
                let _ = self.chunks.send(self.current.id, chunk);
                while self.chunks.collect().is_some() {}
            }
            Tune => {
                let gains = match self.current.target {
                    Target::Guide(_) => self.current.gains,
                    _ => Gains::cartesian(),
                };
                let budget = self.current.budget.scaled(0.5);
                self.change(false, |goal| (goal.gains, goal.budget) = (gains, budget));
            }
            Pause => self.change(false, |goal| goal.paused = true),
            GoOn => self.change(false, |goal| goal.paused = false),
            Cancel => {
                let goal = self.current.at_rest(OnArrival::ReportAndHold);
                self.change(true, |it| *it = goal);
            }
            Touch => {
                self.state.O_F_ext_hat_K[2] = -20.0;
                self.run(5);
                self.state.O_F_ext_hat_K[2] = 0.0;
            }
            Team => self.coordinator.stop(),
            Drop => self.deadman = None,
            Run => self.run(60),
            Wait => self.run(1500),
        }
    }

    fn run(&mut self, cycles: u32) {
        for _ in 0..cycles {
            self.cycle();
        }
    }

    /// Answers a state. After its last answer a session gets no more states.
    fn cycle(&mut self) {
        if self.is_finished {
            return;
        }
        if let Some(deadman) = &self.deadman {
            deadman.keep_alive();
        }
        self.state.message_id += 1;
        let mut event = None;
        let step = self.session.answer(Gate::Open, &self.state, &mut event);
        self.session.prepare();
        self.is_finished = step.finished;
        if let Some(SessionEvent::Settled { goal, .. }) = event {
            self.settled.push(goal);
        }
        let Reference { q, dq, .. } = step.trace.reference;
        if self.session.active.is_none() {
            return;
        }
        let limits = Model::fr3().joint_limits();
        for i in 0..7 {
            let way = (q[i] - self.state.q[i]).abs();
            let change = (dq[i] - self.dq[i]).abs();
            let jumps = way > 1.001e-3 * limits.velocity[i]
                || change > 1.001e-3 * limits.acceleration[i].max(REST * 1e3);
            assert!(
                !jumps,
                "{:?}: joint {i} jumps by {way} and {change}",
                self.way
            );
        }
        (self.state.q, self.state.dq, self.dq) = (q.into(), dq.into(), dq);
    }

    fn brakes(&mut self) {
        self.run(BRAKE);
        let at = JointVector::from(self.state.q);
        self.run(400);
        let moved = (JointVector::from(self.state.q) - at).amax();
        assert!(moved < REST, "{:?}: moves on by {moved} rad", self.way);
    }

    fn stops(&mut self) {
        if self.is_finished {
            return;
        }
        self.ids += 1;
        let stop = GoalId(self.ids);
        self.settled.clear();
        self.write(Goal {
            id: stop,
            ..self.current.at_rest(OnArrival::ReportAndFinish)
        });
        self.run(BRAKE);
        let at = JointVector::from(self.state.q);
        self.run(STOP - BRAKE);
        let moved = (JointVector::from(self.state.q) - at).amax();
        assert!(moved < REST, "{:?}: moves on by {moved} rad", self.way);
        assert!(self.is_finished, "{:?}: does not finish", self.way);
        // A goal may have settled in the cycle before the stop was read.
        let of_stop = self.settled.iter().filter(|goal| **goal == stop).count();
        let last = self.settled.last() == Some(&stop);
        assert!(of_stop == 1 && last, "{:?}: {:?}", self.way, self.settled);
    }
}

/// Returns all steps with `FRANKA_THOROUGH=1`, and only a sample without it.
fn second_steps() -> impl Iterator<Item = Step> {
    STEPS.into_iter().step_by(sample(1, 8))
}

#[test]
fn stop_after_every_step_in_every_state_finishes_at_rest() {
    for state in STATES {
        for first in STEPS {
            for second in second_steps() {
                let mut bench = Bench::in_state(state);
                bench.take(first);
                bench.take(second);
                bench.stops();
            }
        }
    }
}

#[test]
fn brake_after_every_step_in_every_state_ends_at_rest() {
    for state in STATES {
        for step in STEPS {
            for brake in [Cancel, Team, Drop] {
                let mut bench = Bench::in_state(state);
                bench.take(step);
                bench.take(Run);
                bench.take(brake);
                bench.brakes();
            }
        }
    }
}

#[test]
fn no_input_moves_an_arm_whose_deadman_is_gone() {
    for state in STATES {
        for step in STEPS {
            let mut bench = Bench::in_state(state);
            bench.take(Drop);
            bench.run(BRAKE);
            let at = JointVector::from(bench.state.q);
            bench.take(step);
            bench.take(Wait);
            let moved = (JointVector::from(bench.state.q) - at).amax();
            assert!(moved < REST, "{:?}: moves by {moved} rad", bench.way);
        }
    }
}

#[test]
fn paused_goal_rests_until_it_continues() {
    for state in STATES {
        let mut bench = Bench::in_state(state);
        // The points of chunks have fixed times, and a guided arm follows a hand.
        if bench.way.iter().any(|step| matches!(step, Points | Guide)) {
            continue;
        }
        bench.take(Pause);
        bench.brakes();
        bench.take(Tune);
        bench.brakes();
    }
}
