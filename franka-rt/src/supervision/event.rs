//! Events of a robot, and its health.

use core::fmt;
use core::time::Duration;
use std::sync::Arc;

use franka_proto::{Command, Errors, Load};

use crate::lifecycle::{CloseReason, ControlError, Differences, Outcome, Unready};
use crate::sched::SchedError;

/// Something that happened to a robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Event {
    /// Time since the first connection to the robot, by this computer's clock.
    pub at: Duration,
    /// Time by the robot's clock: `message_id` of its newest state, `[ms]`. `None` without a
    /// connection. A restarted robot may begin to count anew.
    pub robot_time: Option<u64>,
    /// Kind of event.
    pub kind: EventKind,
}

/// Event of a robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// The robot is connected. Unusual conditions (a reflex, a pressed stop) follow in separate
    /// events.
    Connected {
        /// Number of attempts that connecting took.
        attempts: u32,
        /// Time since the previous connection was lost; `None` for the first connection.
        after: Option<Duration>,
    },
    /// The operating system refused a request of the control thread, which continues without it.
    /// Follows on `Connected`.
    RealtimeRefused {
        /// Refused requests.
        refusals: Arc<[SchedError]>,
    },
    /// The robot differs from the robot of the previous connection, and may be another one. Follows
    /// on `Connected`. A waiting motion is refused, and a recovery needs the user's approval.
    Unrecognised {
        /// Differences.
        differences: Differences,
    },
    /// A setting that this program had made before a connection was lost does not hold again. The
    /// robot refused it, or a state shows another value. Motions are refused.
    NotConfigured {
        /// The command of that setting.
        command: Command,
        /// Answer or state of the robot.
        text: String,
    },
    /// The connection has ended. Motions end with it.
    Lost {
        /// Reason.
        reason: CloseReason,
    },
    /// No state has come for the link timeout; the connection is still there.
    Silent {
        /// Length of the silence so far.
        silence: Duration,
    },
    /// States come again, over the same connection, after a silence.
    Resumed {
        /// Time since the silence was noticed.
        after: Duration,
    },
    /// The robot stopped itself, or was found in a reflex.
    Reflex(Reflex),
    /// The supervisor does not recover the robot from its reflex: a person or this program must do
    /// so.
    NotRecovered {
        /// Number of the reflex.
        reflex: u64,
        /// Reason.
        why: NotRecovered,
    },
    /// The robot has left a reflex and accepts motions again.
    Recovered {
        /// Number of the reflex.
        reflex: u64,
        /// Time since the reflex was noticed.
        after: Duration,
        /// True if the supervisor recovered the robot; false if this program or a person did.
        by_supervisor: bool,
    },
    /// The user stop was pressed or released, or a safety function had the same effect.
    UserStop {
        /// True if the stop holds the robot now.
        pressed: bool,
    },
    /// A hand began or stopped guiding the arm.
    Guiding {
        /// True if a hand guides the arm now.
        active: bool,
    },
    /// The brakes were closed or opened. A robot that is not ready for another reason reports the
    /// same.
    Brakes {
        /// True if the brakes are closed now.
        closed: bool,
    },
    /// This program has latched a stop, or released it.
    StopLatch {
        /// True if no motion is admitted now.
        latched: bool,
    },
    /// A motion, a session or a program was passed to the connection. Goals that a session accepts
    /// without a future (`set`, `chunk`, `guide`) are not reported.
    MotionBegun {
        /// Name of the motion, session or program, as in the log.
        goal: u64,
    },
    /// A motion, a session or a program has ended, or was not accepted.
    MotionEnded {
        /// Name of the motion, session or program.
        goal: u64,
        /// Outcome.
        outcome: Arc<Outcome>,
    },
    /// The load that the robot computes with has changed, through this program or Desk. A change
    /// while the connection was lost is reported, too.
    LoadChanged {
        /// The present load.
        load: Load,
    },
    /// The connection is closed, and no further one will come.
    Closed {
        /// Reason.
        reason: CloseReason,
    },
}

impl fmt::Display for EventKind {
    /// Prints one line for people.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Connected { attempts, after } => {
                write!(f, "connected at attempt {attempts}")?;
                let Some(after) = after else { return Ok(()) };
                write!(f, ", {after:.1?} after the loss")
            }
            Self::RealtimeRefused { refusals } => {
                f.write_str("without real-time scheduling")?;
                let mut refusals = refusals.iter();
                refusals.try_for_each(|refusal| write!(f, "; {refusal}"))
            }
            Self::Unrecognised { differences } => {
                write!(
                    f,
                    "the robot differs from the robot before the loss: {differences}"
                )
            }
            Self::NotConfigured { command, text } => {
                write!(f, "\"{command}\" could not be restored: {text}")
            }
            Self::Lost { reason } => write!(f, "connection lost: {reason}"),
            Self::Silent { silence } => write!(f, "no state for {silence:.1?}"),
            Self::Resumed { after } => write!(f, "states arrive again after {after:.1?}"),
            Self::Reflex(Reflex { number, errors, .. }) => write!(f, "reflex {number}: {errors}"),
            Self::NotRecovered { reflex, why } => {
                write!(f, "not recovered from reflex {reflex}: {why}")
            }
            Self::Recovered {
                reflex,
                after,
                by_supervisor,
            } => {
                let by = match by_supervisor {
                    true => "the supervisor",
                    false => "the program or a person",
                };
                write!(
                    f,
                    "recovered from reflex {reflex} by {by} after {after:.1?}"
                )
            }
            Self::UserStop { pressed: true } => {
                f.write_str("user stop pressed, or a safety function active")
            }
            Self::UserStop { pressed: false } => f.write_str("user stop released"),
            Self::Guiding { active: true } => f.write_str("guided by hand"),
            Self::Guiding { active: false } => f.write_str("no longer guided by hand"),
            Self::Brakes { closed: true } => f.write_str("brakes closed"),
            Self::Brakes { closed: false } => f.write_str("brakes open"),
            Self::StopLatch { latched: true } => f.write_str("stop latched: motions are refused"),
            Self::StopLatch { latched: false } => f.write_str("stop released"),
            Self::MotionBegun { goal } => write!(f, "motion {goal} begun"),
            Self::MotionEnded { goal, outcome } => match &**outcome {
                Ok(_) => write!(f, "motion {goal} ended"),
                Err(error) => write!(f, "motion {goal} ended: {error}"),
            },
            Self::LoadChanged { load } => write!(f, "the load is now {} kg", load.m_load),
            Self::Closed { reason } => write!(f, "closed: {reason}"),
        }
    }
}

/// The robot stopped itself.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reflex {
    /// Number of the reflex, from 1 on. A reflex that is found after a lost connection has a new
    /// number.
    pub number: u64,
    /// The errors of the robot.
    pub errors: Errors,
    /// Error of the motion that the reflex ended, with its last cycles. `None` if the reflex ended
    /// no motion of this program. `franka_diagnosis` explains the cause.
    pub error: Option<Arc<ControlError>>,
    /// Differences from the robot before a connection was lost, if the robot is not recognised. The
    /// recovery then needs the user's approval, under any policy.
    pub differences: Option<Differences>,
}

/// Reason why a supervisor does not recover a robot from its reflex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NotRecovered {
    /// The policy allows no recovery.
    #[error("the policy does not recover from reflexes")]
    Never,
    /// The policy names the errors to recover from, and the reflex has other errors.
    #[error("the policy does not allow recovery from all errors of the reflex")]
    OtherError,
    /// The robot was recovered as often as the policy allows within its window.
    #[error("the policy allows no more recoveries for now")]
    TooOften,
    /// The person or function that was asked did not agree.
    #[error("the recovery was declined")]
    Declined,
    /// The robot demands a recovery by hand, in Desk.
    #[error("the robot must be recovered by hand, in Desk")]
    ByHand,
}

/// Health of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Health {
    /// Condition of the robot: whether it accepts motions.
    pub condition: Condition,
    /// Start of that condition, counted from the first connection to the robot.
    pub since: Duration,
    /// Number of the robot's reflex, if it is in one. Use it to agree to the recovery.
    pub reflex: Option<u64>,
    /// Number of attempts to connect since the connection was lost; 0 while there is a connection.
    pub attempts: u32,
    /// Number of connections made after the first one.
    pub reconnects: u64,
    /// Number of recoveries by the supervisor.
    pub recoveries: u64,
    /// Time that the newest reconnect took, counted from the loss.
    pub last_reconnect: Option<Duration>,
    /// Time that the newest recovery by the supervisor took, counted from when the reflex was
    /// noticed.
    pub last_recovery: Option<Duration>,
}

/// Condition of a robot: whether it accepts motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Condition {
    /// The robot accepts motions, or a motion runs.
    Ready,
    /// The robot accepts no motions now, for this reason.
    Unready(Unready),
    /// The connection is closed, and no further one will come.
    Closed,
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ready => f.write_str("ready"),
            Self::Unready(why) => why.fmt(f),
            Self::Closed => f.write_str("closed"),
        }
    }
}
