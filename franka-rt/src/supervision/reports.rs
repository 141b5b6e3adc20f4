//! Reports from the connection.

use core::time::Duration;
use std::sync::Arc;

use franka_proto::{Errors, RobotMode, RobotState};

use super::Supervision;
use super::connection::{Configuration, Connection, Loss, Seen, Silent, Up};
use super::event::EventKind;
use super::identity::Identity;
use super::reflex::{RecoveryFailure, ReflexCase};
use crate::lifecycle::{CloseReason, MotionError, Outcome, Unready};
use crate::sched::SchedError;
use crate::session::GoalId;

/// Reason why an attempt to connect failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ConnectFailure {
    /// The robot that answers is not the robot of the previous connection.
    AnotherRobot {
        /// Description of how the robots differ.
        text: String,
    },
    /// Another reason, which may be temporary.
    Other {
        /// Text of the error.
        text: String,
    },
}

impl Supervision {
    /// Records that a connection was made, with its first state and the refused requests of the
    /// control thread. `description` is a hash of the robot's description or model library, if it
    /// sent one. Returns false if no connection is needed any more; the caller must then close it.
    pub fn on_connected(
        &mut self,
        description: Option<u64>,
        state: &RobotState,
        refusals: &[SchedError],
        now: Duration,
    ) -> bool {
        let (attempts, after) = match &self.connection {
            Connection::First => (1, None),
            Connection::Connecting(loss) => (loss.failed + 1, Some(now - loss.since)),
            Connection::Up(_)
            | Connection::Ending(_)
            | Connection::Pausing { .. }
            | Connection::Closed => return false,
        };
        let identity = Identity::of(description, state, now);
        let before = self.identity.as_ref();
        let differences = before.map(|before| before.differences(&identity));
        let differences = differences.filter(|differences| !differences.is_empty());
        self.identity = Some(identity);
        let mut up = Up::new(attempts, differences, now);
        self.settings.on_connected();
        self.connections += 1;
        if !self.settings.is_empty() {
            up.configuration = Configuration::Due;
        }
        self.connection = Connection::Up(up);
        self.robot_time = Some(state.message_id);
        self.health.reconnects += u64::from(after.is_some());
        self.health.last_reconnect = after.or(self.health.last_reconnect);
        self.tell(EventKind::Connected { attempts, after }, now);
        if !refusals.is_empty() {
            let refusals = Arc::from(refusals);
            self.tell(EventKind::RealtimeRefused { refusals }, now);
        }
        if let Some(differences) = differences {
            self.tell(EventKind::Unrecognised { differences }, now);
            self.refuse(|waiting| waiting.refusal(Unready::Unrecognised(differences), now));
        }
        self.show(state, now);
        true
    }

    /// Processes a state of the robot. A state that is not newer than the newest state is ignored.
    /// States with the same condition as the state before may be left out: see [`Seen`].
    pub fn on_state(&mut self, state: &RobotState, now: Duration) {
        if self.robot_time < Some(state.message_id) {
            self.show(state, now);
        }
    }

    fn show(&mut self, state: &RobotState, now: Duration) {
        let Connection::Up(up) = &mut self.connection else {
            return;
        };
        self.robot_time = Some(state.message_id);
        if let Some(identity) = &mut self.identity {
            identity.update(state, now);
        }
        let seen = Seen::of(state);
        let is_first = up.seen.replace(seen).is_none();
        let told = core::mem::replace(&mut up.told, seen.mode);
        let is_anew = told != seen.mode || up.silent.is_some();
        if is_anew && seen.mode == RobotMode::Idle && up.configuration.retry() {
            self.settings.retry();
        }
        if let Some(silent) = up.silent.take() {
            let after = now - silent.since;
            self.tell(EventKind::Resumed { after }, now);
        }
        if told != seen.mode {
            let ended = event_of(told, false);
            let begun = event_of(seen.mode, true);
            for kind in [ended, begun].into_iter().flatten() {
                self.tell(kind, now);
            }
        }
        if self
            .load
            .replace(seen.load)
            .is_some_and(|load| load != seen.load)
        {
            self.tell(EventKind::LoadChanged { load: seen.load }, now);
        }
        if seen.mode == RobotMode::Reflex {
            let is_new = self.on_reflex(seen.errors, now);
            // Something has stopped the robot again, possibly with the same errors.
            let is_again = told == RobotMode::AutomaticErrorRecovery;
            if (is_new || is_again) && !is_first {
                self.turn_away(now);
            }
        }
        self.go_on(now);
    }

    /// Records that the robot is in a reflex with these errors. Returns true if the errors are new.
    fn on_reflex(&mut self, errors: Errors, now: Duration) -> bool {
        let Connection::Up(up) = &mut self.connection else {
            return false;
        };
        let is_known = |case: &ReflexCase| case.errors.union(errors) == case.errors;
        if up.reflex.as_ref().is_some_and(is_known) {
            return false;
        }
        let (policy, recoveries) = (self.policy.as_ref(), &mut self.recoveries);
        let (number, differences) = (self.reflexes + 1, up.differences);
        let mut case = ReflexCase::new(number, errors, differences, policy, recoveries, now);
        match up.reflex.take() {
            Some(before) if !before.is_told() => case.continue_from(before),
            _ => self.reflexes += 1,
        }
        if let Some(error) = self.unshown.take() {
            case.explain(*error);
        }
        up.reflex = Some(case);
        true
    }

    /// Records that the robot has sent no state for `silence`.
    pub fn on_silence(&mut self, silence: Duration, now: Duration) {
        let Connection::Up(up) = &mut self.connection else {
            return;
        };
        if up.silent.is_some() {
            return;
        }
        if let Some(identity) = &mut self.identity {
            identity.silent_for(silence, now);
        }
        up.seen = None;
        up.silent = Some(Silent {
            since: now,
            is_given_up: false,
        });
        self.tell(EventKind::Silent { silence }, now);
        self.turn_away(now);
        self.go_on(now);
    }

    /// Records that the connection has ended. Its resources may be in use until
    /// [`Self::on_released`].
    pub fn on_lost(&mut self, reason: CloseReason, now: Duration) {
        let Connection::Up(up) = &self.connection else {
            return;
        };
        let was_silent = up.silent.is_some();
        let is_final = reason.is_ours() || self.policy.is_none_or(|policy| !policy.reconnects);
        let loss = Loss {
            since: up.silent.as_ref().map_or(now, |silent| silent.since),
            reason: reason.clone(),
            is_final,
            failed: match now < up.since + LASTING {
                true => up.attempts,
                false => 0,
            },
        };
        self.connection = Connection::Ending(loss);
        self.robot_time = None;
        if is_final {
            let reason = reason.clone();
            self.refuse(|_| MotionError::ConnectionClosed { reason });
        } else if !was_silent {
            self.turn_away(now);
        }
        if !reason.is_ours() {
            self.tell(EventKind::Lost { reason }, now);
        }
        self.go_on(now);
    }

    /// Records that all resources of the lost connection are released: its control thread has
    /// ended, and its socket is closed.
    pub fn on_released(&mut self, now: Duration) {
        if let Connection::Ending(loss) = &self.connection {
            let loss = loss.clone();
            match loss.failed {
                _ if loss.is_final => self.close(loss.reason, now),
                0 => self.connect(loss),
                failed => {
                    let at = now.saturating_add(self.pauses.after(failed));
                    self.connection = Connection::Pausing { loss, at };
                }
            }
        }
        self.go_on(now);
    }

    /// Records that an attempt to connect has failed.
    pub fn on_connect_failed(&mut self, failure: ConnectFailure, now: Duration) {
        let Connection::Connecting(loss) = &self.connection else {
            return;
        };
        let mut loss = loss.clone();
        loss.failed += 1;
        let after = now - loss.since;
        let give_up_after = self.policy.and_then(|policy| policy.give_up_after);
        match failure {
            ConnectFailure::AnotherRobot { text } => {
                self.close(CloseReason::AnotherRobot { text }, now);
            }
            ConnectFailure::Other { text } if give_up_after.is_some_and(|most| after >= most) => {
                let attempts = loss.failed;
                let reason = CloseReason::GivenUp {
                    attempts,
                    after,
                    text,
                };
                self.close(reason, now);
            }
            ConnectFailure::Other { .. } => {
                let at = now.saturating_add(self.pauses.after(loss.failed));
                self.connection = Connection::Pausing { loss, at };
            }
        }
        self.go_on(now);
    }

    /// Processes the answer to a request to recover from the reflex with this number.
    pub fn on_recovery(&mut self, reflex: u64, answer: Result<(), RecoveryFailure>, now: Duration) {
        if let Connection::Up(up) = &mut self.connection
            && let Some(case) = &mut up.reflex
            && case.number == reflex
        {
            case.on_answer(answer, &mut self.pauses, now);
        }
        self.go_on(now);
    }

    /// Records that a motion, a session or a program is about to be passed to the connection. Until
    /// [`Self::on_ended`] reports its end, the robot is not recovered.
    pub fn on_begun(&mut self, goal: GoalId, now: Duration) {
        self.motions.insert(goal);
        self.unshown = None;
        // A caller that requests a motion accepts the robot in its present condition.
        if let Connection::Up(up) = &mut self.connection {
            up.differences = None;
        }
        self.tell(EventKind::MotionBegun { goal: goal.0 }, now);
    }

    /// Records the outcome of a motion. Motions that were not reported as begun are ignored.
    pub fn on_ended(&mut self, goal: GoalId, outcome: &Outcome, now: Duration) {
        if !self.motions.remove(&goal) {
            return;
        }
        if let Err(MotionError::Control(error)) = outcome
            && error.is_reflex()
        {
            match self.connection.reflex_mut() {
                Some(case) if !case.is_told() => case.explain((**error).clone()),
                Some(_) => {}
                None => self.unshown = Some(error.clone()),
            }
        }
        let outcome = Arc::new(outcome.clone());
        let goal = goal.0;
        self.tell(EventKind::MotionEnded { goal, outcome }, now);
        self.go_on(now);
    }
}

/// Returns the event for a mode that has begun or ended. Returns `None` for reflexes and motions.
fn event_of(mode: RobotMode, begun: bool) -> Option<EventKind> {
    Some(match mode {
        RobotMode::UserStopped => EventKind::UserStop { pressed: begun },
        RobotMode::Guiding => EventKind::Guiding { active: begun },
        RobotMode::Other => EventKind::Brakes { closed: begun },
        RobotMode::Idle
        | RobotMode::Move
        | RobotMode::Reflex
        | RobotMode::AutomaticErrorRecovery => return None,
    })
}

/// Shortest duration of a connection that does not count as a failed attempt. If a robot drops each
/// connection early, the next attempt is made after a pause.
const LASTING: Duration = Duration::from_secs(1);
