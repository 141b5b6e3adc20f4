//! Supervision of a robot between its motions. It handles lost connections and reconnects, reflexes
//! and recoveries, and the motions that callers request during them.
//!
//! ```text
//!   First --> Up ----lost----> Ending --given back--> Connecting --connected--> Up
//!             |                                        |      ^
//!             |                                   failed      | time
//!                                                      v      |
//!                            Closed <--given up, another robot-- Pausing
//!
//!   Up:  ready --reflex--> told, once its motion has ended --> left | agreement awaited | due
//!          ^                                                            agreed -->      |
//!          +------- the robot shows that it takes motions <-- answered <-- requested <--+
//! ```
//!
//! The supervision decides when to connect and when to recover. **It moves nothing**: it only lets
//! motions begin for which a caller waits. It refuses the waiting motion after a reflex, a lost
//! connection or a user stop, and if a hand guides the arm or the brakes are closed.
//!
//! Inputs are the `on_*` methods (from the connection and the clock), and [`Supervision::submit`],
//! `withdraw`, `stop`, `agree` and `close` (from callers). [`Supervision::poll`] returns the
//! effects. The supervision has no clock, socket or task: `now` is an argument. It is the time
//! since any fixed moment, and never decreases.

mod attempts;
mod connection;
mod event;
mod identity;
mod policy;
mod reflex;
mod reports;
mod settings;
#[cfg(test)]
mod tests;
mod waiting;

use core::time::Duration;
use std::collections::{BTreeSet, VecDeque};

use franka_proto::{Load, Request, RobotMode};

use crate::lifecycle::{CloseReason, ControlError, MotionError, NewMotion, Unready};
use crate::session::GoalId;

use attempts::{Attempts, Pauses};
use connection::{Configuration, Connection, Loss};
use identity::Identity;
use reflex::Step;
use settings::Settings;
use waiting::Waiting;

pub use connection::Seen;
pub use event::{Condition, Event, EventKind, Health, NotRecovered, Reflex};
pub use policy::{Backoff, Policy};
pub use reflex::RecoveryFailure;
pub use reports::ConnectFailure;
pub use settings::{Answer, SettingId};
pub use waiting::Admission;

/// An effect that the caller of [`Supervision::poll`] must carry out. Effects must be carried out
/// in the order in which they are returned.
#[derive(Debug)]
pub enum Output {
    /// Send this event to the listeners.
    Event(Event),
    /// Connect to the robot. Then call [`Supervision::on_connected`] or
    /// [`Supervision::on_connect_failed`] with the result.
    Connect,
    /// Close the connection for this reason. Then call [`Supervision::on_lost`].
    Disconnect {
        /// Reason to close the connection.
        reason: CloseReason,
    },
    /// Recover the robot (`AutomaticErrorRecovery`). Then call [`Supervision::on_recovery`] with
    /// this number and the result.
    Recover {
        /// Number of the reflex.
        reflex: u64,
    },
    /// Send this program's settings again: call [`Supervision::next_setting`], one at a time, until
    /// it returns `None`. Not needed if the connection has ended.
    Configure,
    /// Ask the user to approve the recovery from this reflex. Pass an answer to
    /// [`Supervision::agree`].
    Ask(Reflex),
    /// Begin the waiting motion.
    Begin {
        /// Id of the motion.
        goal: GoalId,
    },
    /// Refuse the waiting motion.
    Refuse {
        /// Id of the motion.
        goal: GoalId,
        /// Error to return to the caller of the motion.
        error: MotionError,
    },
}

/// The state machine. See the module's documentation.
#[derive(Debug)]
pub struct Supervision {
    /// The policy; `None` for a robot that is only watched.
    policy: Option<Policy>,
    connection: Connection,
    /// `message_id` of the newest state.
    robot_time: Option<u64>,
    /// The load in the last state.
    load: Option<Load>,
    /// Data of the robot when its last state arrived, to recognise it later.
    identity: Option<Identity>,
    reflexes: u64,
    recoveries: Attempts,
    pauses: Pauses,
    /// Error of the last motion, if a reflex ended it and no state has shown that reflex yet.
    unshown: Option<Box<ControlError>>,
    motions: BTreeSet<GoalId>,
    waiting: Option<Waiting>,
    settings: Settings,
    connections: u64,
    /// True if a stop is latched. The latch remains when the connection changes.
    stop_latched: bool,
    health: Health,
    outputs: VecDeque<Output>,
}

impl Supervision {
    /// Creates the supervision of a robot before the first connection to it. Without a policy, the
    /// supervision only watches: it neither reconnects nor recovers, and lets every motion begin.
    pub fn new(policy: Option<Policy>) -> Self {
        let pauses = policy.map(|policy| policy.pauses).unwrap_or_default();
        let seed = policy.and_then(|policy| policy.seed).unwrap_or_default();
        Self {
            policy,
            connection: Connection::First,
            robot_time: None,
            load: None,
            identity: None,
            reflexes: 0,
            recoveries: Attempts::default(),
            pauses: Pauses::new(pauses, seed),
            unshown: None,
            motions: BTreeSet::new(),
            waiting: None,
            settings: Settings::default(),
            connections: 0,
            stop_latched: false,
            health: Health {
                condition: Condition::Unready(Unready::Disconnected),
                since: Duration::ZERO,
                reflex: None,
                attempts: 0,
                reconnects: 0,
                recoveries: 0,
                last_reconnect: None,
                last_recovery: None,
            },
            outputs: VecDeque::new(),
        }
    }

    /// Returns the health of the robot.
    pub fn health(&self) -> Health {
        self.health
    }

    /// True if there is a connection, or if an earlier connection still holds resources.
    pub fn has_connection(&self) -> bool {
        matches!(self.connection, Connection::Up(_) | Connection::Ending(_))
    }

    /// Returns the next effect to carry out.
    pub fn poll(&mut self) -> Option<Output> {
        self.outputs.pop_front()
    }

    /// Decides on a motion that a caller requests.
    pub fn submit(&mut self, motion: &NewMotion, now: Duration) -> Admission {
        if let Err(error) = self.check_latch() {
            return Admission::Refuse(error);
        }
        let why = match self.connection.unready() {
            Some(_) if motion.is_within_a_session() => return Admission::Begin,
            Some(why) if why.is_passing() => why,
            // The present obstacle may be gone before the robot receives the motion.
            Some(why) if !self.connection.is_configured() => {
                let waited = Duration::ZERO;
                return Admission::Refuse(MotionError::NotReady { why, waited });
            }
            _ => return Admission::Begin,
        };
        let Some(policy) = &self.policy else {
            return Admission::Begin;
        };
        let most = policy.motions_wait;
        let (admission, before) = Waiting::admit(&mut self.waiting, motion, (why, most), now);
        if let Some(goal) = before {
            let error = MotionError::Superseded;
            self.outputs.push_back(Output::Refuse { goal, error });
        }
        admission
    }

    /// Cancels the waiting motion if it has this id. Returns true if it was cancelled.
    pub fn withdraw(&mut self, goal: GoalId) -> bool {
        self.waiting.take_if(|it| it.goal == goal).is_some()
    }

    /// Cancels the waiting motion, because a stop was requested.
    pub fn stop(&mut self) {
        self.refuse(|_| MotionError::Stopped);
    }

    /// Cancels the waiting motion, and admits no motion until [`Self::release_stop`]. The latch
    /// applies to this connection and to later connections.
    pub fn latch_stop(&mut self, now: Duration) {
        self.stop();
        self.set_latch(true, now);
    }

    /// Admits motions again. Returns true if a stop was latched.
    pub fn release_stop(&mut self, now: Duration) -> bool {
        self.set_latch(false, now)
    }

    /// True if a stop is latched.
    pub fn is_stop_latched(&self) -> bool {
        self.stop_latched
    }

    /// Checks that no stop is latched. The check applies to every goal of a motion or a session.
    ///
    /// # Errors
    /// Returns [`MotionError::NotReady`] if a stop is latched.
    pub fn check_latch(&self) -> Result<(), MotionError> {
        match self.connection {
            // A closed connection reports its own end.
            Connection::Closed => Ok(()),
            _ if self.stop_latched => Err(MotionError::NotReady {
                why: Unready::StopLatched,
                waited: Duration::ZERO,
            }),
            _ => Ok(()),
        }
    }

    fn set_latch(&mut self, latched: bool, now: Duration) -> bool {
        let before = core::mem::replace(&mut self.stop_latched, latched);
        if before != latched {
            self.tell(EventKind::StopLatch { latched }, now);
        }
        self.go_on(now);
        before
    }

    /// Records a setting that this program is about to send over the newest connection. Settings
    /// must be recorded in the order in which they are sent. The setting will be sent on every
    /// later connection, unless the robot refuses it. Pass the answer to [`Self::on_set`].
    pub fn declare(&mut self, request: Request) -> SettingId {
        self.settings.declare(request, self.connections)
    }

    /// Processes the answer to a setting that the program sent.
    pub fn on_set(&mut self, id: SettingId, answer: &Answer, now: Duration) {
        self.settings.on_answer(id, answer, self.connections);
        if self.policy.is_some()
            && let Connection::Up(up) = &mut self.connection
        {
            let is_refused = matches!(answer, Answer::Refused { .. });
            up.configuration = match up.configuration {
                // The setting is being sent again, or will be sent again.
                before @ (Configuration::Requested { .. } | Configuration::Due) => before,
                _ if self.settings.all_hold() => Configuration::Done,
                Configuration::Done if self.settings.any_open() => Configuration::Due,
                Configuration::Failed(_) if !is_refused => {
                    self.settings.retry();
                    Configuration::Due
                }
                before => before,
            };
        }
        self.go_on(now);
    }

    /// Returns the next setting to send after [`Output::Configure`]. Pass its answer to
    /// [`Self::on_set_again`].
    pub fn next_setting(&mut self, now: Duration) -> Option<(SettingId, Request)> {
        let Connection::Up(up) = &mut self.connection else {
            return None;
        };
        let Configuration::Requested { is_idle_anew } = up.configuration else {
            return None;
        };
        if let Some(next) = self.settings.next() {
            return Some(next);
        }
        if self.settings.any_sent() {
            up.configuration = Configuration::Due;
            return None;
        }
        let failures = self.settings.failures();
        let failures: Vec<_> = failures.map(|(it, text)| (it, text.clone())).collect();
        up.configuration = match failures.first() {
            None => Configuration::Done,
            Some(_) if is_idle_anew => {
                self.settings.retry();
                Configuration::Due
            }
            Some(&(command, _)) => Configuration::Failed(command),
        };
        if let Configuration::Failed(_) = up.configuration {
            for (command, text) in failures {
                self.tell(EventKind::NotConfigured { command, text }, now);
            }
        }
        self.go_on(now);
        None
    }

    /// Processes the answer to a setting that [`Self::next_setting`] returned.
    pub fn on_set_again(&mut self, id: SettingId, answer: Answer) {
        if let Connection::Up(up) = &self.connection
            && matches!(up.configuration, Configuration::Requested { .. })
        {
            self.settings.on_answer_again(id, answer);
        }
    }

    /// Approves or rejects the recovery from the reflex with this number. Returns true if an answer
    /// was awaited.
    pub fn agree(&mut self, reflex: u64, agreed: bool, now: Duration) -> bool {
        let Connection::Up(up) = &mut self.connection else {
            return false;
        };
        let case = up.reflex.as_mut().filter(|case| case.number == reflex);
        let awaited = case.is_some_and(|case| case.agree(agreed, now));
        if awaited && agreed {
            up.differences = None;
        }
        self.go_on(now);
        awaited
    }

    /// Ends the supervision, because this program or its runtime closes the connection. No further
    /// effects are requested.
    pub fn close(&mut self, reason: CloseReason, now: Duration) {
        if matches!(self.connection, Connection::Closed) {
            return;
        }
        self.connection = Connection::Closed;
        let error = MotionError::ConnectionClosed {
            reason: reason.clone(),
        };
        self.refuse(|_| error);
        self.tell(EventKind::Closed { reason }, now);
        self.go_on(now);
    }

    /// Returns the time at which [`Self::on_time`] must be called if no other input arrives before.
    pub fn deadline(&self) -> Option<Duration> {
        let of_connection = match &self.connection {
            Connection::Up(up) => match &up.silent {
                Some(silent) => silent.deadline(self.policy.as_ref()),
                None if self.motions.is_empty() => up.deadline_of_reflex(),
                None => None,
            },
            Connection::Pausing { at, .. } => Some(*at),
            Connection::First
            | Connection::Ending(_)
            | Connection::Connecting(_)
            | Connection::Closed => None,
        };
        let of_motion = self.waiting.map(|waiting| waiting.until);
        [of_connection, of_motion].into_iter().flatten().min()
    }

    /// Takes the steps that are due at `now`.
    pub fn on_time(&mut self, now: Duration) {
        match &mut self.connection {
            Connection::Pausing { loss, at } if now >= *at => {
                let loss = loss.clone();
                self.connect(loss);
            }
            Connection::Up(up) => {
                if let Some(silent) = &mut up.silent
                    && silent
                        .deadline(self.policy.as_ref())
                        .is_some_and(|at| now >= at)
                {
                    silent.is_given_up = true;
                    let silence = now - silent.since;
                    let reason = CloseReason::Silent { silence };
                    self.outputs.push_back(Output::Disconnect { reason });
                }
            }
            _ => {}
        }
        self.go_on(now);
    }

    fn connect(&mut self, loss: Loss) {
        self.connection = Connection::Connecting(loss);
        self.outputs.push_back(Output::Connect);
    }

    fn tell(&mut self, kind: EventKind, now: Duration) {
        self.outputs.push_back(Output::Event(Event {
            at: now,
            robot_time: self.robot_time,
            kind,
        }));
    }

    fn refuse(&mut self, error: impl FnOnce(&Waiting) -> MotionError) {
        if let Some(waiting) = self.waiting.take() {
            let (goal, error) = (waiting.goal, error(&waiting));
            self.outputs.push_back(Output::Refuse { goal, error });
        }
    }

    /// Refuses the waiting motion, because another fault has occurred.
    fn turn_away(&mut self, now: Duration) {
        if let Some(why) = self.connection.unready() {
            self.refuse(|waiting| waiting.refusal(why, now));
        }
    }

    /// Takes the steps that have become possible, and updates the health.
    fn go_on(&mut self, now: Duration) {
        while let Some(step) = self.next_step(now) {
            self.take(step, now);
        }
        self.end_reflex(now);
        if let Connection::Up(up) = &mut self.connection
            && up.configuration == Configuration::Due
            && !self.settings.any_sent()
            && up.reflex.is_none()
            && up.seen.is_some_and(|seen| seen.mode == RobotMode::Idle)
        {
            up.configuration = Configuration::Requested {
                is_idle_anew: false,
            };
            self.outputs.push_back(Output::Configure);
        }
        if let Some(waiting) = self.waiting {
            match self.connection.unready() {
                None => {
                    self.waiting = None;
                    let goal = waiting.goal;
                    self.outputs.push_back(Output::Begin { goal });
                }
                Some(why) if !why.is_passing() || now >= waiting.until => self.turn_away(now),
                Some(_) => {}
            }
        }
        let condition = match (&self.connection, self.connection.unready()) {
            (Connection::Closed, _) => Condition::Closed,
            (_, None) if self.stop_latched => Condition::Unready(Unready::StopLatched),
            (_, None) => Condition::Ready,
            (_, Some(why)) => Condition::Unready(why),
        };
        if condition != self.health.condition {
            (self.health.condition, self.health.since) = (condition, now);
        }
        self.health.attempts = self.connection.loss().map_or(0, |loss| loss.failed);
        self.health.reflex = self.connection.reflex().map(|case| case.number);
    }

    fn next_step(&mut self, now: Duration) -> Option<Step> {
        let Connection::Up(up) = &mut self.connection else {
            return None;
        };
        let (mode, case) = (up.seen?.mode, up.reflex.as_mut()?);
        let recovery = self.policy.and_then(|policy| policy.recovery);
        let attempts = (&mut self.recoveries, &mut self.pauses);
        case.step((mode, !self.motions.is_empty()), recovery, attempts, now)
    }

    fn take(&mut self, step: Step, now: Duration) {
        let Some(reflex) = self.connection.reflex().map(|case| case.number) else {
            return;
        };
        match step {
            Step::Tell(reflex) => self.tell(EventKind::Reflex(reflex), now),
            Step::Leave(why) => self.tell(EventKind::NotRecovered { reflex, why }, now),
            Step::Ask(reflex) => self.outputs.push_back(Output::Ask(reflex)),
            Step::Recover => self.outputs.push_back(Output::Recover { reflex }),
        }
    }

    fn end_reflex(&mut self, now: Duration) {
        let Connection::Up(up) = &mut self.connection else {
            return;
        };
        let mode = up.seen.map(|seen| seen.mode);
        let is_over = matches!(mode, Some(RobotMode::Idle | RobotMode::Move));
        let Some(case) = up.reflex.take_if(|case| is_over && case.is_told()) else {
            return;
        };
        let after = now - case.since;
        let by_supervisor = case.is_by_supervisor();
        if by_supervisor {
            self.health.recoveries += 1;
            self.health.last_recovery = Some(after);
        }
        let recovered = EventKind::Recovered {
            reflex: case.number,
            after,
            by_supervisor,
        };
        self.tell(recovered, now);
    }
}
