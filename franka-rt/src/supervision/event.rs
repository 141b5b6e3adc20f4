//! What happened to a robot, and how it is.

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
    /// When, since the robot was first connected to, by this computer's clock.
    pub at: Duration,
    /// When, by the robot's clock: `message_id` of its newest state, `[ms]`. `None` without a
    /// connection. A robot that was restarted may count anew.
    pub robot_time: Option<u64>,
    /// What.
    pub kind: EventKind,
}

/// What happened to a robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// It is connected. What does not hold by default (a reflex, a pressed stop) follows in events
    /// of its own.
    Connected {
        /// Attempts that this took.
        attempts: u32,
        /// Time since the connection before was lost; `None` for the first one.
        after: Option<Duration>,
    },
    /// The operating system refused the control thread what it was asked for, and it goes on
    /// without. Follows on `Connected`.
    RealtimeRefused {
        /// What was refused.
        refusals: Arc<[SchedError]>,
    },
    /// What answers differs from the robot of the connection before, and may be another one.
    /// Follows on `Connected`. A motion that waited is refused, and a recovery takes somebody's
    /// agreement.
    Unrecognised {
        /// What differs.
        differences: Differences,
    },
    /// What this program had set at the robot before a connection was lost is not set again, and
    /// motions are refused: a setting was refused, or a state shows another one.
    NotConfigured {
        /// The command that sets it.
        command: Command,
        /// What the robot answered or shows.
        text: String,
    },
    /// The connection has ended. Motions end with it.
    Lost {
        /// Why.
        reason: CloseReason,
    },
    /// No state has come for the link timeout; the connection is still there.
    Silent {
        /// For how long.
        silence: Duration,
    },
    /// States come again, over the same connection.
    Resumed {
        /// Time since the silence was noticed.
        after: Duration,
    },
    /// The robot stopped itself, or is found to have done so.
    Reflex(Reflex),
    /// The supervisor leaves the robot in its reflex: somebody has to recover it.
    NotRecovered {
        /// Number of the reflex.
        reflex: u64,
        /// Why.
        why: NotRecovered,
    },
    /// The robot has left a reflex and takes motions again.
    Recovered {
        /// Number of the reflex.
        reflex: u64,
        /// Time from when it was noticed.
        after: Duration,
        /// True if the supervisor did it, rather than this program or a person.
        by_supervisor: bool,
    },
    /// The user stop was pressed or released, or a safety function did as much.
    UserStop {
        /// True if it holds the robot now.
        pressed: bool,
    },
    /// A hand began or ended to guide the arm.
    Guiding {
        /// True if it does now.
        active: bool,
    },
    /// The brakes were closed or opened. A robot that is not ready for another reason looks the
    /// same.
    Brakes {
        /// True if they are closed now.
        closed: bool,
    },
    /// This program has latched a stop, or released it.
    StopLatch {
        /// True if no motion is admitted now.
        latched: bool,
    },
    /// A motion, a session or a program was handed over to the connection. Goals that a session
    /// takes without a future (`set`, `chunk`, `guide`) are not told.
    MotionBegun {
        /// Its name, as in the log.
        goal: u64,
    },
    /// It has ended, or was not accepted.
    MotionEnded {
        /// Its name.
        goal: u64,
        /// How.
        outcome: Arc<Outcome>,
    },
    /// The load that the robot computes with is another one: of this program, or of Desk. What was
    /// known before a connection was lost counts.
    LoadChanged {
        /// The load now.
        load: Load,
    },
    /// There is no connection, and there will be none.
    Closed {
        /// Why.
        reason: CloseReason,
    },
}

impl fmt::Display for EventKind {
    /// One line for people.
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
                write!(f, "not recognised as the robot of before: {differences}")
            }
            Self::NotConfigured { command, text } => {
                write!(f, "\"{command}\" is not set again: {text}")
            }
            Self::Lost { reason } => write!(f, "connection lost: {reason}"),
            Self::Silent { silence } => write!(f, "no state for {silence:.1?}"),
            Self::Resumed { after } => write!(f, "states come again after {after:.1?}"),
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
                    false => "program or person",
                };
                write!(
                    f,
                    "recovered from reflex {reflex} by {by} after {after:.1?}"
                )
            }
            Self::UserStop { pressed: true } => {
                f.write_str("user stop pressed, or a safety function")
            }
            Self::UserStop { pressed: false } => f.write_str("user stop released"),
            Self::Guiding { active: true } => f.write_str("guided by hand"),
            Self::Guiding { active: false } => f.write_str("no longer guided by hand"),
            Self::Brakes { closed: true } => f.write_str("brakes closed"),
            Self::Brakes { closed: false } => f.write_str("brakes open"),
            Self::StopLatch { latched: true } => f.write_str("stop latched: no motion is admitted"),
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
    /// Its number, from 1 on. One that is found after a connection was lost has a new one.
    pub number: u64,
    /// The errors that hold the robot.
    pub errors: Errors,
    /// How it ended the motion that ran, with its last cycles; `None` if none of this program did.
    /// `franka_diagnosis` says what led to it.
    pub error: Option<Arc<ControlError>>,
    /// What differs from the robot of before a connection was lost, if that is not recognised: the
    /// recovery then takes somebody's agreement, whatever the policy.
    pub differences: Option<Differences>,
}

/// Why a supervisor leaves a robot in its reflex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NotRecovered {
    /// The policy recovers from no reflex.
    #[error("the policy recovers from no reflex")]
    Never,
    /// The policy names the errors to recover from, and there are others.
    #[error("the policy does not name all of its errors")]
    OtherError,
    /// The robot was recovered as often as the policy allows within its window.
    #[error("the policy allows no more recoveries for now")]
    TooOften,
    /// Whoever was asked did not agree.
    #[error("the recovery was not agreed to")]
    Declined,
    /// The robot demands a recovery by hand, in Desk.
    #[error("the robot has to be recovered by hand")]
    ByHand,
}

/// How a robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Health {
    /// Whether it takes motions.
    pub condition: Condition,
    /// Since when, since the robot was first connected to.
    pub since: Duration,
    /// Number of the reflex that holds it, if one does: what to agree to the recovery from.
    pub reflex: Option<u64>,
    /// Attempts to connect since the connection was lost; 0 while there is one.
    pub attempts: u32,
    /// Connections made after the first one.
    pub reconnects: u64,
    /// Recoveries by the supervisor.
    pub recoveries: u64,
    /// Time that the newest reconnect took, from the loss on.
    pub last_reconnect: Option<Duration>,
    /// Time that the newest recovery by the supervisor took, from when the reflex was noticed.
    pub last_recovery: Option<Duration>,
}

/// Whether a robot takes motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Condition {
    /// It does, or a motion runs.
    Ready,
    /// Not now.
    Unready(Unready),
    /// There is no connection, and there will be none.
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
