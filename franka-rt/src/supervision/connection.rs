//! State of the connection to a robot.

use core::time::Duration;

use franka_proto::{Command, Errors, Load, RobotMode, RobotState};

use super::policy::Policy;
use super::reflex::ReflexCase;
use crate::lifecycle::{CloseReason, Differences, Unready};

#[derive(Debug)]
pub(super) enum Connection {
    /// The program is connecting for the first time.
    First,
    /// The program is connected.
    Up(Up),
    /// The connection is lost, but its resources are not released yet.
    Ending(Loss),
    /// The next attempt to connect is made at `at`.
    Pausing { loss: Loss, at: Duration },
    /// An attempt to connect is under way.
    Connecting(Loss),
    /// The connection has ended, and no other connection will follow.
    Closed,
}

#[derive(Debug)]
pub(super) struct Up {
    /// Time at which the connection was made.
    pub(super) since: Duration,
    /// Number of attempts until the connection was made.
    pub(super) attempts: u32,
    /// Data about the silence, while the robot sends no states.
    pub(super) silent: Option<Silent>,
    /// Condition in the last state. `None` before the first state on this connection, or after a
    /// silence.
    pub(super) seen: Option<Seen>,
    /// The mode that was reported last. Before the first report, it is the mode of an idle robot.
    pub(super) told: RobotMode,
    pub(super) reflex: Option<ReflexCase>,
    /// Differences from the robot of the previous connection. `None` once the user has agreed to a
    /// recovery, or a motion was requested.
    pub(super) differences: Option<Differences>,
    pub(super) configuration: Configuration,
}

/// Progress of sending this program's settings again on a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Configuration {
    /// The robot has all settings, or the program has made no settings.
    Done,
    /// The settings must be sent again once the robot is idle.
    Due,
    /// The settings are being sent. If the robot has become idle again meanwhile, a setting that
    /// fails is tried again at once.
    Requested { is_idle_anew: bool },
    /// The robot has refused this setting. The setting is tried again when the robot becomes idle
    /// again.
    Failed(Command),
}

impl Configuration {
    /// Requests another attempt for the failed settings, because the robot has become idle again.
    /// Returns true if there are any.
    pub(super) fn retry(&mut self) -> bool {
        match self {
            Self::Requested { is_idle_anew } => *is_idle_anew = true,
            Self::Failed(_) => {
                *self = Self::Due;
                return true;
            }
            Self::Done | Self::Due => {}
        }
        false
    }

    fn unready(self) -> Option<Unready> {
        match self {
            Self::Done => None,
            Self::Due | Self::Requested { .. } => Some(Unready::Configuring),
            Self::Failed(command) => Some(Unready::NotConfigured(command)),
        }
    }
}

/// A robot that sends no states.
#[derive(Debug)]
pub(super) struct Silent {
    pub(super) since: Duration,
    /// True if the connection is about to be closed because of this silence.
    pub(super) is_given_up: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Loss {
    pub(super) since: Duration,
    pub(super) reason: CloseReason,
    /// True if no other connection will follow.
    pub(super) is_final: bool,
    /// Number of attempts since the loss that failed, or whose connection did not last.
    pub(super) failed: u32,
}

/// Condition of the robot as a whole, taken from a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    pub(super) mode: RobotMode,
    pub(super) errors: Errors,
    pub(super) load: Load,
}

impl Seen {
    /// Returns the condition in `state`. If several states have the same condition, it is enough to
    /// pass one of them to [`Supervision::on_state`](super::Supervision::on_state), unless there
    /// was a silence between them.
    pub fn of(state: &RobotState) -> Self {
        Self {
            mode: state.robot_mode,
            errors: state.errors,
            load: Load {
                m_load: state.m_load,
                F_x_Cload: state.F_x_Cload,
                I_load: state.I_load,
            },
        }
    }
}

impl Silent {
    /// Returns the time at which the connection will be given up, if any.
    pub(super) fn deadline(&self, policy: Option<&Policy>) -> Option<Duration> {
        let policy = policy.filter(|policy| policy.reconnects && !self.is_given_up)?;
        Some(self.since.saturating_add(policy.silence))
    }
}

impl Up {
    /// Returns a connection that has just been made, before its first state.
    pub(super) fn new(attempts: u32, differences: Option<Differences>, now: Duration) -> Self {
        Self {
            since: now,
            attempts,
            silent: None,
            seen: None,
            told: RobotMode::Idle,
            reflex: None,
            differences,
            configuration: Configuration::Done,
        }
    }

    /// Returns the time of the next step of a reflex, if that step waits only for time to pass.
    pub(super) fn deadline_of_reflex(&self) -> Option<Duration> {
        self.reflex.as_ref()?.deadline(self.seen?.mode)
    }

    /// Returns the reason why the robot accepts no motions; `None` if it accepts motions.
    pub(super) fn unready(&self) -> Option<Unready> {
        if self.silent.is_some() {
            return Some(Unready::Silent);
        }
        let mode = self.seen.map_or(RobotMode::Other, |seen| seen.mode);
        match (mode, &self.reflex) {
            (RobotMode::Idle | RobotMode::Move, None) => self.configuration.unready(),
            (RobotMode::UserStopped, _) => Some(Unready::UserStopped),
            (RobotMode::Guiding, _) => Some(Unready::Guided),
            (RobotMode::Other, _) => Some(Unready::Braked),
            (_, Some(reflex)) if mode != RobotMode::AutomaticErrorRecovery => {
                Some(match (reflex.unready(), self.differences) {
                    (Unready::AgreementAwaited, Some(what)) => Unready::Unrecognised(what),
                    (why, _) => why,
                })
            }
            _ => Some(Unready::Recovering),
        }
    }
}

impl Connection {
    /// Returns the reason why the robot accepts no motions; `None` if it accepts motions, or if the
    /// connection is closed. A closed connection reports its own end.
    pub(super) fn unready(&self) -> Option<Unready> {
        match self {
            Self::Up(up) => up.unready(),
            Self::First | Self::Ending(_) | Self::Pausing { .. } | Self::Connecting(_) => {
                Some(Unready::Disconnected)
            }
            Self::Closed => None,
        }
    }

    /// True if there is a connection and the robot has this program's settings, or if there is no
    /// connection.
    pub(super) fn is_configured(&self) -> bool {
        match self {
            Self::Up(up) => up.configuration == Configuration::Done,
            _ => true,
        }
    }

    pub(super) fn reflex(&self) -> Option<&ReflexCase> {
        match self {
            Self::Up(up) => up.reflex.as_ref(),
            _ => None,
        }
    }

    pub(super) fn reflex_mut(&mut self) -> Option<&mut ReflexCase> {
        match self {
            Self::Up(up) => up.reflex.as_mut(),
            _ => None,
        }
    }

    /// Returns data about the lost connection while a new connection is awaited.
    pub(super) fn loss(&self) -> Option<&Loss> {
        match self {
            Self::Ending(loss) | Self::Pausing { loss, .. } | Self::Connecting(loss) => Some(loss),
            Self::First | Self::Up(_) | Self::Closed => None,
        }
    }
}
