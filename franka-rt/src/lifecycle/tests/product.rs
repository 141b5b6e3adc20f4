//! Tries every input in every state, with a stop before and after each. No stop is lost, no path
//! becomes a straight line, and nothing that has ended moves the arm again.

use std::collections::BTreeMap;

use super::*;
use crate::lifecycle::{Engagement, Tuning};
use crate::session::Budget;

/// Steps of callers, the robot, the thread and the connection. Each step refers to the newest goal.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Begin,
    BeginPath,
    Engage,
    Within,
    WithinPath,
    Points,
    Tune,
    Update,
    Close,
    Pause,
    GoOn,
    Cancel,
    Disengage,
    Stop,
    /// The robot does what it was asked, and time passes.
    Run,
    /// The robot leaves the motion without a reply.
    Leaves,
    /// The robot reports the end of the motion, but still shows the motion.
    Preempts,
    Garbles,
    Stalls,
    Revives,
    Hangs,
    Disconnects,
}

use Step::*;

const STEPS: [Step; 22] = [
    Begin,
    BeginPath,
    Engage,
    Within,
    WithinPath,
    Points,
    Tune,
    Update,
    Close,
    Pause,
    GoOn,
    Cancel,
    Disengage,
    Stop,
    Run,
    Leaves,
    Preempts,
    Garbles,
    Stalls,
    Revives,
    Hangs,
    Disconnects,
];

/// Steps that lead to each state of the motion, its goals, its session and its stops.
const STATES: [&[Step]; 24] = [
    &[],
    &[Begin],
    &[Begin, Run],
    &[Begin, Run, Pause],
    &[Begin, Run, Cancel],
    &[Begin, Run, Stop],
    &[Begin, Stop],
    &[BeginPath],
    &[BeginPath, Run],
    &[BeginPath, Run, Pause],
    &[BeginPath, Run, Cancel],
    &[Engage],
    &[Engage, Run],
    &[Engage, Run, Within, Run],
    &[Engage, Run, WithinPath],
    &[Engage, Run, WithinPath, Run],
    &[Engage, Run, Points, Run],
    &[Engage, Run, Points, Run, Cancel],
    &[Engage, Run, WithinPath, Run, Disengage],
    &[Begin, Run, Leaves],
    &[Begin, Run, Preempts],
    &[Begin, Run, Preempts, BeginPath],
    &[Begin, Run, Garbles, BeginPath],
    &[Begin, Run, Stalls],
];

#[derive(Clone, Copy, Debug, Default)]
struct Accepted {
    path: bool,
    /// The goal got another target, or its motion was asked to end.
    redirected: bool,
    /// The goal was cancelled, or a stop came after it.
    over: bool,
}

struct Bench {
    pair: LifecycleAndDriver,
    /// Motion that the robot was asked to run. Once it runs, the motion that it runs, until it
    /// ends.
    robot: Robot,
    motions: u64,
    ids: u64,
    newest: GoalId,
    session: GoalId,
    goals: BTreeMap<GoalId, Accepted>,
    stops: Vec<GoalId>,
    seen: usize,
    way: Vec<Step>,
    faults: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Robot {
    Idle,
    Asked(MotionId, Modes),
    Runs(MotionId),
    /// The robot no longer shows a motion, but has not reported how the motion ended.
    Left(MotionId),
    /// The robot has reported how the motion ended, and shows the motion for one more state.
    Ended,
}

impl Bench {
    fn new() -> Self {
        Self {
            pair: LifecycleAndDriver::new(),
            robot: Robot::Idle,
            motions: 0,
            ids: 0,
            newest: GoalId(0),
            session: GoalId(0),
            goals: BTreeMap::new(),
            stops: Vec::new(),
            seen: 0,
            way: Vec::new(),
            faults: Vec::new(),
        }
    }

    fn in_state(state: &[Step]) -> Self {
        let mut bench = Self::new();
        for step in state {
            bench.take(*step);
        }
        bench
    }

    fn goal(&mut self, on_arrival: OnArrival) -> Goal {
        self.ids += 1;
        let mut q = self.pair.state.q;
        q[0] += 0.02;
        let limits = Model::fr3().joint_limits();
        Goal::new(GoalId(self.ids), Target::Joints(q), on_arrival, limits)
    }

    fn begin(&mut self, session: Option<GoalId>, path: bool) {
        let goal = Box::new(self.goal(match session {
            Some(_) => OnArrival::ReportAndHold,
            None => OnArrival::ReportAndFinish,
        }));
        let id = goal.id;
        let path = path.then(|| {
            let mut q = self.pair.state.q;
            q[1] += 0.02;
            let mut end = q;
            end[0] += 0.02;
            let way = [Waypoint::new(q), Waypoint::new(end)];
            let state = &self.pair.state;
            let path = Chunk::through(&way, &state.q, &goal, Model::fr3(), state);
            Box::new(path.expect("it is reachable"))
        });
        let accepted = Accepted {
            path: path.is_some(),
            ..Accepted::default()
        };
        let motion = NewMotion::Goal {
            goal,
            path,
            ticket: None,
            session,
        };
        let begun = self.pair.lifecycle.begin(motion, &self.pair.state, NOW);
        if begun.is_ok() {
            self.accept(id, accepted);
        }
    }

    fn accept(&mut self, id: GoalId, accepted: Accepted) {
        self.newest = id;
        self.goals.insert(id, accepted);
    }

    fn of_newest(&mut self) -> Option<&mut Accepted> {
        self.goals.get_mut(&self.newest)
    }

    fn take(&mut self, step: Step) {
        self.way.push(step);
        let (newest, session) = (self.newest, self.session);
        let state = self.pair.state;
        let lifecycle = &mut self.pair.lifecycle;
        match step {
            Begin => self.begin(None, false),
            BeginPath => self.begin(None, true),
            Within => self.begin(Some(session), false),
            WithinPath => self.begin(Some(session), true),
            Engage => {
                let goal = Box::new(self.goal(OnArrival::Hold));
                let id = goal.id;
                let engagement = Engagement::default();
                let motion = NewMotion::Session { goal, engagement };
                if self.pair.lifecycle.begin(motion, &state, NOW).is_ok() {
                    self.session = id;
                    self.accept(id, Accepted::default());
                }
            }
            Points => {
                let goal = self.goal(OnArrival::Hold);
                let id = goal.id;
                let mut q = state.q;
                let points = [0, 50, 100].map(|ms| {
                    q[0] += 0.0002;
                    (Duration::from_millis(ms), q)
                });
                let chunk = Chunk::joints(points).expect("they follow each other");
                let before = self.pair.lifecycle.heading().map(|(id, _)| id);
                let taken = self.pair.lifecycle.chunk(session, goal, chunk, &state);
                let after = self.pair.lifecycle.heading().map(|(id, _)| id);
                if taken.is_ok() && (after == Some(id) || before == after) {
                    // The motion has its own id only if it is the first motion or comes too late.
                    self.accept(id, Accepted::default());
                    if after != Some(id) && !self.pair.lifecycle.is_ending() {
                        self.goals.remove(&id);
                        self.newest = newest;
                    }
                }
            }
            Tune => {
                let tuning = Tuning {
                    budget: Some(Budget::of(Model::fr3().joint_limits())),
                    posture: Some(READY.into()),
                    ..Tuning::default()
                };
                let _ = lifecycle.tune(session, tuning, &state);
            }
            Update => {
                let mut q = state.q;
                q[2] += 0.02;
                let updated = lifecycle.update(newest, Target::Joints(q), &state);
                if updated == Ok(true) {
                    self.of_newest().expect("it is known").redirected = true;
                }
            }
            Close => lifecycle.close(newest),
            Pause => lifecycle.pause(newest, true),
            GoOn => lifecycle.pause(newest, false),
            Cancel if self.stops.contains(&newest) => {}
            Cancel => {
                lifecycle.cancel(newest, NOW);
                if let Some(goal) = self.of_newest() {
                    goal.over = true;
                }
            }
            Disengage => {
                lifecycle.disengage(session);
                if lifecycle.heading().is_some_and(|(id, _)| id == session) {
                    self.goals.values_mut().for_each(|goal| goal.over = true);
                }
            }
            Stop => {
                self.ids += 1;
                let id = GoalId(self.ids);
                self.goals.values_mut().for_each(|goal| goal.over = true);
                if lifecycle.stop(id, &state, NOW) {
                    self.stops.push(id);
                    let stop = Accepted {
                        over: true,
                        ..Accepted::default()
                    };
                    self.accept(id, stop);
                }
            }
            Run => self.run(10),
            Leaves => {
                if let Robot::Runs(motion) = self.robot {
                    self.robot = Robot::Left(motion);
                    self.shows_no_motion(RobotMode::UserStopped);
                }
            }
            Preempts => self.ends(MoveStatus::Preempted),
            Garbles => {
                if let Robot::Asked(motion, _) | Robot::Runs(motion) = self.robot {
                    let violation = Violation::SecondMotionStarted { id: CommandId(1) };
                    lifecycle.on_move_violation(motion, violation, NOW);
                }
            }
            Stalls => lifecycle.on_stall(Some(Duration::from_millis(100)), NOW),
            Revives => lifecycle.on_stall(None, NOW),
            Hangs => {
                if let Some(deadline) = lifecycle.deadline() {
                    lifecycle.on_time(deadline, None);
                }
            }
            Disconnects => lifecycle.on_connection_closed(CloseReason::ClosedByPeer),
        }
        self.settle();
    }

    fn settle(&mut self) {
        self.pair.settle();
        for request in std::mem::take(&mut self.pair.sent) {
            match request {
                Request::Move(request) => {
                    self.motions += 1;
                    self.robot = Robot::Asked(MotionId(self.motions), Modes::of(&request));
                }
                Request::StopMove => self.ends(MoveStatus::Preempted),
                _ => {}
            }
        }
        self.look();
    }

    fn ends(&mut self, status: MoveStatus) {
        let (motion, shows) = match self.robot {
            Robot::Asked(motion, _) | Robot::Left(motion) => (motion, false),
            Robot::Runs(motion) => (motion, true),
            Robot::Idle | Robot::Ended => return,
        };
        self.robot = if shows { Robot::Ended } else { Robot::Idle };
        self.pair.lifecycle.on_move_reply(motion, status, NOW);
        self.settle();
    }

    fn shows_no_motion(&mut self, mode: RobotMode) {
        let idle = RobotState::default();
        self.pair.state.motion_generator_mode = MotionGeneratorMode::Idle;
        self.pair.state.controller_mode = idle.controller_mode;
        self.pair.state.dq = idle.dq;
        self.pair.cycle(mode);
        self.settle();
    }

    /// The robot runs the requested motion. Its arm follows the reference.
    fn run(&mut self, cycles: u32) {
        for _ in 0..cycles {
            match self.robot {
                Robot::Idle => self.shows_no_motion(RobotMode::Idle),
                Robot::Left(_) => self.ends(MoveStatus::Preempted),
                Robot::Ended => {
                    self.robot = Robot::Idle;
                    self.shows_no_motion(RobotMode::Idle);
                }
                Robot::Asked(motion, modes) => {
                    self.robot = Robot::Runs(motion);
                    self.pair.state.motion_generator_mode = modes.generator;
                    self.pair.state.controller_mode = modes.controller;
                    let started = MoveStatus::MotionStarted;
                    self.pair.lifecycle.on_move_reply(motion, started, NOW);
                    self.settle();
                }
                Robot::Runs(_) => {
                    self.pair.state.message_id += 1;
                    self.pair.state.robot_mode = RobotMode::Move;
                    let command = self.pair.driver.on_state(&self.pair.state);
                    self.settle();
                    let record = self.pair.driver.record();
                    match command {
                        Some(it) if it.motion_generation_finished || it.torque_command_finished => {
                            self.ends(MoveStatus::Success);
                        }
                        Some(_) => {
                            (self.pair.state.q, self.pair.state.q_d) = (record.q_ref, record.q_ref);
                            self.pair.state.dq = record.dq_ref;
                        }
                        None => {}
                    }
                }
            }
        }
    }

    fn check(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            let fault = format!("{:?}: {}", self.way, what());
            self.faults.push(fault);
        }
    }

    fn is_told(&self, goal: GoalId) -> bool {
        self.pair.resolved.iter().any(|(id, _)| *id == goal)
    }

    fn look(&mut self) {
        let seen = std::mem::replace(&mut self.seen, self.pair.resolved.len());
        let newer = self.pair.resolved[seen..].to_vec();
        for (goal, result) in newer {
            let of_goal = self.pair.resolved.iter().filter(|(id, _)| *id == goal);
            let once = of_goal.count() == 1;
            self.check(once, || format!("{goal:?} is told twice"));
            let known = self.goals.contains_key(&goal);
            self.check(known, || format!("{goal:?} was not accepted: {result:?}"));
            let rests = self.pair.state.robot_mode != RobotMode::Move;
            let stopped = self.stops.contains(&goal) && result.is_ok();
            self.check(!stopped || rests, || format!("{goal:?} is told too early"));
        }
        let Some((id, target)) = self.pair.lifecycle.heading() else {
            return;
        };
        let told = self.is_told(id);
        self.check(!told, || {
            format!("{id:?} is over, and heads for {target:?}")
        });
        let accepted = self.goals.get(&id).copied();
        self.check(accepted.is_some(), || format!("{id:?} is not known"));
        let Some(accepted) = accepted.filter(|_| target != Target::Rest) else {
            return;
        };
        self.check(!accepted.over, || format!("{id:?} goes on to {target:?}"));
        let along = match &self.pair.lifecycle.next {
            Some(NewMotion::Goal { goal, path, .. }) => goal.along_path && path.is_some(),
            _ => {
                let goals = self.pair.lifecycle.goals();
                goals.is_some_and(|goals| goals.current.along_path)
            }
        };
        let kept = along || !accepted.path || accepted.redirected;
        self.check(kept, || format!("{id:?} has lost its path"));
    }

    fn end(&mut self) {
        self.take(Revives);
        self.run(400);
        for stop in self.stops.clone() {
            let told = self.is_told(stop);
            self.check(told, || format!("the stop {stop:?} is lost"));
        }
        self.take(Disconnects);
        for goal in self.goals.clone().into_keys() {
            let told = self.is_told(goal);
            self.check(told, || format!("{goal:?} is lost"));
        }
    }
}

fn conclude(faults: &[String]) {
    let first = faults[..faults.len().min(20)].join("\n");
    assert!(faults.is_empty(), "{} faults:\n{first}", faults.len());
}

#[test]
fn every_step_in_every_state_keeps_paths_and_revives_nothing() {
    let mut faults = Vec::new();
    for state in STATES {
        for first in STEPS {
            for second in STEPS {
                let mut bench = Bench::in_state(state);
                [first, second, Run]
                    .into_iter()
                    .for_each(|step| bench.take(step));
                faults.append(&mut bench.faults);
            }
        }
    }
    conclude(&faults);
}

#[test]
fn stop_in_every_state_is_told_when_the_arm_rests() {
    let mut faults = Vec::new();
    for state in STATES {
        for step in STEPS {
            for way in [[Stop, step], [step, Stop]] {
                let mut bench = Bench::in_state(state);
                way.into_iter().for_each(|step| bench.take(step));
                bench.end();
                faults.append(&mut bench.faults);
            }
        }
    }
    conclude(&faults);
}
