//! Policies under each kind of fault, with a robot whose states the test supplies.

mod connections;
mod motions;
mod reflexes;
mod settings;

use std::sync::Arc;

use franka_model::{Model, READY};
use franka_proto::{
    Command, ControlFailure, Errors, MoveStatus, Refusal, RobotError, RobotState, Status,
};

use super::*;
use crate::driver::{Commander, ControlLog};
use crate::lifecycle::{Differences, Outcome, Stage};
use crate::session::{Goal, OnArrival, Target};
use crate::stats::MotionStatistics;
use crate::together::StartBarrier;

const MS: fn(u64) -> Duration = Duration::from_millis;
const WINDOW: Duration = Duration::from_secs(60);
const COLLISION: RobotError = RobotError::CartesianReflex;

struct Supervised {
    supervision: Supervision,
    now: u64,
    state: RobotState,
    told: Vec<EventKind>,
    asked: Vec<Output>,
}

impl Supervised {
    /// Returns a robot that has been connected for a while, and accepts motions.
    fn ready(policy: Policy) -> Self {
        Self::connected(Some(policy))
    }

    fn connected(policy: Option<Policy>) -> Self {
        let mut this = Self {
            supervision: Supervision::new(policy),
            now: 0,
            state: RobotState {
                message_id: 1,
                robot_mode: RobotMode::Idle,
                ..RobotState::default()
            },
            told: Vec::new(),
            asked: Vec::new(),
        };
        assert!(this.connect());
        assert_eq!(this.condition(), Condition::Ready);
        this.pass(2000);
        this.told.clear();
        this
    }

    /// Sets the clock of a robot that was not restarted.
    fn goes_on(&mut self) {
        self.state.message_id = (self.state.message_id + 1).max(self.now + 1);
    }

    fn connect(&mut self) -> bool {
        self.goes_on();
        self.connect_as_it_is()
    }

    fn connect_as_it_is(&mut self) -> bool {
        let (state, now) = (self.state, MS(self.now));
        self.after(|it| it.on_connected(Some(1), &state, &[], now))
    }

    fn after<T>(&mut self, act: impl FnOnce(&mut Supervision) -> T) -> T {
        let result = act(&mut self.supervision);
        while let Some(output) = self.supervision.poll() {
            match output {
                Output::Event(event) => self.told.push(event.kind),
                other => self.asked.push(other),
            }
        }
        result
    }

    /// Lets this time pass, and handles every deadline when it is reached.
    fn pass(&mut self, milliseconds: u64) {
        let end = self.now + milliseconds;
        while let Some(due) = self.supervision.deadline().filter(|due| *due <= MS(end)) {
            self.now = self.now.max(u64::try_from(due.as_millis()).unwrap());
            if due > MS(self.now) {
                self.now += 1;
            }
            let now = MS(self.now);
            self.after(|it| it.on_time(now));
        }
        self.now = end;
    }

    fn shows(&mut self, robot_mode: RobotMode) {
        self.goes_on();
        self.state.robot_mode = robot_mode;
        let (state, now) = (self.state, MS(self.now));
        self.after(|it| it.on_state(&state, now));
    }

    fn reflex(&mut self, errors: impl IntoIterator<Item = RobotError>) {
        self.state.errors = errors.into_iter().collect();
        self.shows(RobotMode::Reflex);
    }

    fn recovers(&mut self) {
        self.state.errors = Errors::NONE;
        self.shows(RobotMode::Idle);
    }

    fn answers(&mut self, reflex: u64, answer: Result<(), RecoveryFailure>) {
        let now = MS(self.now);
        self.after(|it| it.on_recovery(reflex, answer, now));
    }

    fn lose(&mut self, reason: CloseReason) {
        let now = MS(self.now);
        self.after(|it| it.on_lost(reason, now));
    }

    fn release(&mut self) {
        let now = MS(self.now);
        self.after(|it| it.on_released(now));
    }

    fn fails(&mut self, failure: ConnectFailure) {
        let now = MS(self.now);
        self.after(|it| it.on_connect_failed(failure, now));
    }

    fn submit(&mut self, id: u64) -> Admission {
        self.submit_as(id, |motion| motion)
    }

    fn submit_as(&mut self, id: u64, change: impl FnOnce(NewMotion) -> NewMotion) -> Admission {
        let limits = Model::fr3().joint_limits();
        let target = Target::Joints(READY.into());
        let goal = Goal::new(GoalId(id), target, OnArrival::ReportAndFinish, limits);
        let (motion, now) = (change(NewMotion::to(goal)), MS(self.now));
        self.after(|it| it.submit(&motion, now))
    }

    fn condition(&self) -> Condition {
        self.supervision.health().condition
    }

    /// Returns the numbers of the reflexes that the supervision has asked to recover from.
    fn recoveries(&self) -> Vec<u64> {
        let of = |output: &Output| match output {
            Output::Recover { reflex } => Some(*reflex),
            _ => None,
        };
        self.asked.iter().filter_map(of).collect()
    }

    fn connects(&self) -> usize {
        let is = |output: &&Output| matches!(output, Output::Connect);
        self.asked.iter().filter(is).count()
    }

    /// Returns the results of the motions that waited: that they began, or why they did not.
    fn motions(&mut self) -> Vec<(u64, Option<MotionError>)> {
        let asked = std::mem::take(&mut self.asked);
        let of = |output| match output {
            Output::Begin { goal } => Some((goal.0, None)),
            Output::Refuse { goal, error } => Some((goal.0, Some(error))),
            _ => None,
        };
        asked.into_iter().filter_map(of).collect()
    }

    fn left(&self) -> Option<NotRecovered> {
        self.told.iter().find_map(|kind| match kind {
            EventKind::NotRecovered { why, .. } => Some(*why),
            _ => None,
        })
    }
}

fn collision() -> Outcome {
    let status = Status::Move(MoveStatus::ReflexAborted);
    let refusal = Refusal::new(Command::Move, status, RobotMode::Reflex).expect("a refusal");
    Err(MotionError::Control(Box::new(ControlError {
        failure: ControlFailure {
            refusal,
            reflex_reason: COLLISION.into(),
            success_rate: None,
        },
        errors: COLLISION.into(),
        stage: Stage::Running,
        log: Arc::new(ControlLog::default()),
        commander: Commander::Function,
        statistics: MotionStatistics::default(),
        model: Arc::new(Model::fr3().clone()),
    })))
}

fn refused(text: &str) -> ConnectFailure {
    ConnectFailure::Other { text: text.into() }
}

fn not_ready(why: Unready, waited: u64) -> MotionError {
    MotionError::NotReady {
        why,
        waited: MS(waited),
    }
}

fn without_chance() -> Policy {
    Policy::default().reconnect(Backoff {
        first: MS(100),
        most: MS(400),
        jitter: 0.0,
    })
}
