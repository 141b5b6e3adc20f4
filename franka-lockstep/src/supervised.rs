//! A supervised robot in one thread, in virtual time: the decisions of `franka_rt::supervision`,
//! and connections that end and begin again.
//!
//! This module replaces the tasks, sockets and futures of `franka-async`.

mod setting;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use franka_model::JointVector;
use franka_proto::{Errors, RecoveryStatus, Request, RobotError, RobotMode, RobotState};
use franka_rt::driver::LINK_TIMEOUT;
use franka_rt::lifecycle::{CloseReason, MotionError, NewMotion, Outcome};
use franka_rt::session::{Goal, GoalId, OnArrival, Target};
use franka_rt::supervision::{
    Admission, Answer, ConnectFailure, Event, Health, Output, Policy, RecoveryFailure, Reflex,
    Supervision,
};
use franka_sim::{Config, Robot};

use super::guard::CommandGuard;
use super::{DriverStack, Link, Lockstep};
use setting::Sender;

pub use setting::shows;

/// A supervised robot, which advances by one millisecond at a time.
pub struct Supervised {
    lockstep: Lockstep,
    /// Configuration with which the robot restarts.
    pub config: Config,
    supervision: Supervision,
    sender: Sender,
    /// True if the robot's computer is running.
    is_up: bool,
    connection: Connection,
    /// `message_id` of the newest state that the supervision has seen.
    seen: u64,
    /// Motions that the lifecycle currently handles.
    under_way: BTreeSet<GoalId>,
    waiting: Option<NewMotion>,
    goals: u64,
    /// Events that the supervision has reported. The test may clear them.
    pub events: Vec<Event>,
    /// Requests of the supervision. The test may clear them.
    pub requests: Vec<Asked>,
    /// Settings that the program requested, and the answers to them. The test may clear them.
    pub answers: Vec<(Request, Answer)>,
    /// Outcome of each submitted motion.
    pub outcomes: BTreeMap<GoalId, Outcome>,
}

/// A request of the supervision to the program around it.
#[derive(Debug)]
pub enum Asked {
    /// Connect to the robot.
    Connect,
    /// Recover the robot from the reflex with this number. The state contains this mode and these
    /// errors.
    Recover(u64, RobotMode, Errors),
    /// Ask a person if the robot may recover from this reflex.
    Agreement(Reflex),
    /// Begin a motion that was waiting.
    Begin(GoalId),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Connection {
    Up,
    /// The connection has ended. Its control thread may brake the arm until the given time.
    Ending {
        until: u64,
    },
    None,
    /// The client is connecting. The robot must answer before the given time.
    Connecting {
        until: u64,
    },
}

/// Time for which a control thread without a connection may brake, as in `franka-async`, `[ms]`.
const BRAKING: u64 = 3000;

/// Longest time of an attempt to connect, `[ms]`.
const CONNECTING: u64 = 50;

impl Supervised {
    /// Returns a connected robot under supervision with this policy.
    ///
    /// # Panics
    /// Panics like [`Lockstep::new`].
    pub fn new(config: Config, policy: Policy) -> Self {
        let lockstep = Lockstep::new(config.clone());
        let mut this = Self {
            supervision: Supervision::new(Some(policy)),
            lockstep,
            config,
            is_up: true,
            connection: Connection::Up,
            seen: 0,
            under_way: BTreeSet::new(),
            waiting: None,
            goals: 0,
            events: Vec::new(),
            requests: Vec::new(),
            sender: Sender::default(),
            answers: Vec::new(),
            outcomes: BTreeMap::new(),
        };
        this.connected();
        this
    }

    /// Time since the start, `[ms]`.
    pub fn now(&self) -> u64 {
        self.lockstep.now()
    }

    /// The simulated robot.
    pub fn robot(&mut self) -> &mut Robot {
        &mut self.lockstep.robot
    }

    /// True if the robot's computer is running.
    pub fn is_up(&self) -> bool {
        self.is_up
    }

    /// True if the robot's computer is running, the client is connected, and states arrive.
    pub fn is_seen(&self) -> bool {
        self.is_up && self.connection == Connection::Up && !self.lockstep.link.delayed
    }

    /// True if a connection exists, even if it is silent.
    fn is_up_or_silent(&self) -> bool {
        self.connection == Connection::Up
    }

    /// The newest state that has arrived.
    pub fn state(&self) -> &RobotState {
        &self.lockstep.client.state
    }

    /// True if the lifecycle currently handles this motion.
    pub fn is_under_way(&self, goal: GoalId) -> bool {
        self.under_way.contains(&goal)
    }

    /// The robot's health, as the supervision sees it.
    pub fn health(&self) -> Health {
        self.supervision.health()
    }

    /// Advances the whole system by one millisecond.
    pub fn tick(&mut self) {
        if self.is_up {
            self.lockstep.tick();
        } else {
            self.lockstep.silence(1);
        }
        self.look();
        self.send_settings();
        let now = self.time();
        if self.supervision.deadline().is_some_and(|due| now >= due) {
            self.supervision.on_time(now);
        }
        self.carry_out();
    }

    /// Processes changes of the connection.
    fn look(&mut self) {
        let now = self.time();
        match self.connection {
            Connection::Up => {
                let state = self.lockstep.client.state;
                let silence = Duration::from_millis(self.lockstep.now() - self.lockstep.heard);
                if state.message_id != self.seen {
                    self.seen = state.message_id;
                    self.supervision.on_state(&state, now);
                    // This call precedes the reading of the outcomes, because nothing may depend on
                    // them.
                    self.carry_out();
                } else if silence == LINK_TIMEOUT {
                    self.supervision.on_silence(silence, now);
                }
                while let Some(status) = self.lockstep.client.recoveries.pop_front() {
                    let answer = match status {
                        RecoveryStatus::Success => Ok(()),
                        RecoveryStatus::ManualErrorRecoveryRequiredRejected => {
                            Err(RecoveryFailure::ByHand)
                        }
                        _ => Err(RecoveryFailure::Other),
                    };
                    // Only one request is outstanding at a time.
                    if let Some(reflex) = self.health().reflex {
                        self.supervision.on_recovery(reflex, answer, now);
                    }
                }
                self.take_outcomes();
            }
            Connection::Ending { until } => {
                self.take_outcomes();
                if !self.lockstep.client.lifecycle.is_braking() || self.lockstep.now() >= until {
                    self.connection = Connection::None;
                    self.supervision.on_released(now);
                }
            }
            Connection::Connecting { until } => {
                let client = &self.lockstep.client;
                if client.is_connected() && client.state.message_id > 0 {
                    self.connected();
                } else if self.lockstep.now() >= until {
                    self.lockstep.robot.disconnect();
                    self.connection = Connection::None;
                    let text = String::from("no answer");
                    let failure = ConnectFailure::Other { text };
                    self.supervision.on_connect_failed(failure, now);
                }
            }
            Connection::None => {}
        }
    }

    fn connected(&mut self) {
        self.connection = Connection::Up;
        let state = self.lockstep.client.state;
        self.seen = state.message_id;
        let now = self.time();
        assert!(
            self.supervision.on_connected(None, &state, &[], now),
            "it is wanted"
        );
        self.carry_out();
    }

    fn take_outcomes(&mut self) {
        let now = self.time();
        for goal in self.under_way.clone() {
            if let Some(outcome) = self.lockstep.client.outcome(goal).cloned() {
                self.under_way.remove(&goal);
                self.supervision.on_ended(goal, &outcome, now);
                self.resolve(goal, outcome);
            }
        }
    }

    fn carry_out(&mut self) {
        while let Some(output) = self.supervision.poll() {
            match output {
                Output::Event(event) => self.events.push(event),
                Output::Connect => {
                    self.requests.push(Asked::Connect);
                    self.connect();
                }
                Output::Disconnect { reason } => self.lose(reason),
                Output::Recover { reflex } => {
                    assert!(self.under_way.is_empty(), "{:?}", self.under_way);
                    let state = self.state();
                    let asked = Asked::Recover(reflex, state.robot_mode, state.errors);
                    self.requests.push(asked);
                    self.lockstep.request(&Request::AutomaticErrorRecovery);
                }
                Output::Configure => self.configure(),
                Output::Ask(reflex) => self.requests.push(Asked::Agreement(reflex)),
                Output::Begin { goal } => {
                    self.requests.push(Asked::Begin(goal));
                    let motion = self.waiting.take().expect("it waits");
                    assert_eq!(motion.id(), goal);
                    self.begin(motion);
                }
                Output::Refuse { goal, error } => {
                    self.waiting.take_if(|motion| motion.id() == goal);
                    self.resolve(goal, Err(error));
                }
            }
        }
    }

    fn connect(&mut self) {
        assert_eq!(self.connection, Connection::None, "one at a time");
        let model = self.lockstep.model.clone();
        let mut client = DriverStack::new(&model, self.lockstep.robot.version());
        client.goals = self.goals;
        let reachable = self.is_up && !self.lockstep.link.delayed;
        if reachable && self.lockstep.robot.connect() {
            client.connect(40_000);
        }
        self.lockstep.client = client;
        self.lockstep.guard = Some(CommandGuard::new(*model.joint_limits()));
        self.lockstep.heard = self.lockstep.now();
        // A computer that is not running refuses immediately.
        let most = if self.is_up { CONNECTING } else { 1 };
        let until = self.lockstep.now() + most;
        self.connection = Connection::Connecting { until };
    }

    /// Ends the command connection.
    fn lose(&mut self, reason: CloseReason) {
        self.lockstep.robot.disconnect();
        if self.connection != Connection::Up {
            return;
        }
        let until = self.lockstep.now() + BRAKING;
        self.connection = Connection::Ending { until };
        let now = self.time();
        self.supervision.on_lost(reason.clone(), now);
        self.lockstep.client.close(reason);
        self.take_outcomes();
        self.carry_out();
    }

    /// Kills the simulator process. The robot disappears immediately, and its connections close.
    pub fn kill(&mut self) {
        self.is_up = false;
        self.lose(CloseReason::ClosedByPeer);
    }

    /// Restarts the robot's computer, with the arm in its last position.
    pub fn restart(&mut self) {
        let q: JointVector = *self.lockstep.robot.q();
        self.lockstep.robot = Robot::new(self.config.clone());
        self.lockstep.robot.place(&q);
        self.lockstep.link = Link::perfect();
        self.is_up = true;
    }

    /// Cuts the network. No data passes, and the command connection repeats its data later.
    pub fn cut(&mut self) {
        self.lockstep.link.delayed = true;
        self.lockstep.link.drop_states(u64::MAX);
        self.lockstep.link.drop_commands(u64::MAX);
    }

    /// Repairs the network. If `gave_up` is true, both ends have closed the command connection
    /// during the outage.
    pub fn mend(&mut self, gave_up: bool) {
        self.lockstep.link = Link::perfect();
        if gave_up {
            self.lose(CloseReason::Io {
                kind: std::io::ErrorKind::TimedOut,
                text: String::from("libfranka: TCP receive: Timeout"),
            });
        }
    }

    /// Raises an error of the robot, which causes a reflex.
    pub fn trip(&mut self, error: RobotError) {
        self.lockstep.robot.trip(error);
    }

    /// Makes the robot recover, as another program or a person could.
    pub fn recover(&mut self) {
        if self.connection == Connection::Up {
            self.lockstep.request(&Request::AutomaticErrorRecovery);
        }
    }

    /// Gives a person's answer to the question if the robot may recover from this reflex.
    pub fn agree(&mut self, reflex: u64, agreed: bool) -> bool {
        let now = self.time();
        let awaited = self.supervision.agree(reflex, agreed, now);
        self.carry_out();
        awaited
    }

    /// Submits a motion and returns its goal id.
    pub fn submit(&mut self, target: Target) -> GoalId {
        self.goals += 1;
        let limits = self.lockstep.model.joint_limits();
        let goal = Goal::new(
            GoalId(self.goals),
            target,
            OnArrival::ReportAndFinish,
            limits,
        );
        let (motion, now) = (NewMotion::to(goal), self.time());
        let admission = self.supervision.submit(&motion, now);
        self.carry_out();
        match admission {
            Admission::Begin => self.begin(motion),
            Admission::Wait => self.waiting = Some(motion),
            Admission::Refuse(error) => self.resolve(goal.id, Err(error)),
        }
        goal.id
    }

    /// Cancels a motion, like dropping its future.
    pub fn cancel(&mut self, goal: GoalId) {
        if self.supervision.withdraw(goal) {
            self.waiting = None;
            self.resolve(goal, Err(MotionError::Stopped));
        } else if self.under_way.contains(&goal) {
            self.lockstep.cancel(goal);
        }
    }

    fn begin(&mut self, motion: NewMotion) {
        let (goal, now) = (motion.id(), self.time());
        self.supervision.on_begun(goal, now);
        self.under_way.insert(goal);
        if self.connection == Connection::Up {
            self.check_settings();
        }
        let begun = match self.connection {
            Connection::Up => self.lockstep.client.begin(motion).map(drop),
            _ => Err(MotionError::ConnectionClosed {
                reason: CloseReason::ClosedByPeer,
            }),
        };
        if let Err(error) = begun {
            self.under_way.remove(&goal);
            let refused = Err(error);
            self.supervision.on_ended(goal, &refused, now);
            self.resolve(goal, refused);
        }
        self.carry_out();
    }

    fn resolve(&mut self, goal: GoalId, outcome: Outcome) {
        let twice = self.outcomes.insert(goal, outcome);
        assert!(twice.is_none(), "{goal:?} is resolved twice: {twice:?}");
    }

    fn time(&self) -> Duration {
        Duration::from_millis(self.lockstep.now())
    }
}
