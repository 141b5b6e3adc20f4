//! Events of a robot, and its health.

use core::fmt;
use core::time::Duration;
use std::sync::Arc;

use franka_proto::{Command, Errors, Load};

use crate::lifecycle::{CloseReason, ControlError, Differences, Outcome, Unready};
use crate::sched::SchedError;

/// An event of a robot, with its time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Event {
    /// Time since the first connection to the robot, by this computer's clock.
    pub at: Duration,
    /// Time by the robot's clock, `[ms]`: the `message_id` of its newest state. `None` without a
    /// connection. The clock of a restarted robot may start at zero again.
    pub robot_time: Option<u64>,
    /// Kind of event.
    pub kind: EventKind,
}

/// Kind of an event of a robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// The program has connected to the robot. If the robot is in an unusual condition, such as a
    /// reflex or a pressed stop, separate events report it.
    Connected {
        /// Number of attempts until the connection was made.
        attempts: u32,
        /// Time since the previous connection was lost; `None` for the first connection.
        after: Option<Duration>,
    },
    /// The operating system refused a request of the control thread, and the thread continues
    /// without it. Comes after `Connected`.
    RealtimeRefused {
        /// Refused requests.
        refusals: Arc<[SchedError]>,
    },
    /// The robot differs from the robot of the previous connection, and may be a different robot.
    /// Comes after `Connected`. A waiting motion is refused, and a recovery needs the user's
    /// approval.
    Unrecognised {
        /// Differences between the robots.
        differences: Differences,
    },
    /// A setting that this program had made before a connection was lost could not be restored.
    /// Either the robot refused the setting, or a state shows a different value. Motions are
    /// refused.
    NotConfigured {
        /// Command that makes the setting.
        command: Command,
        /// Description of the robot's answer or state.
        text: String,
    },
    /// The connection has ended. Its motions end, too.
    Lost {
        /// Reason why the connection ended.
        reason: CloseReason,
    },
    /// No state has arrived for the link timeout. The connection still exists.
    Silent {
        /// Time since the last state, including the link timeout.
        silence: Duration,
    },
    /// After a silence, states arrive again over the same connection.
    Resumed {
        /// Time since the silence was noticed, so without the link timeout.
        after: Duration,
    },
    /// The robot stopped with a reflex, or was found in a reflex.
    Reflex(Reflex),
    /// The supervisor will not recover the robot from its reflex. A person or this program must
    /// recover it.
    NotRecovered {
        /// Number of the reflex.
        reflex: u64,
        /// Reason why the supervisor does not recover the robot.
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
    /// The brakes were closed or opened.
    Brakes {
        /// True if the brakes are now closed. Also true if the robot is not ready for any other
        /// reason.
        closed: bool,
    },
    /// This program has latched a stop, or released it.
    StopLatch {
        /// True if no motion is admitted now.
        latched: bool,
    },
    /// A motion, a session or a program was passed to the connection. If a session accepts a goal
    /// without a future (`set`, `chunk`, `guide`), no event reports it.
    MotionBegun {
        /// Id of the motion, session or program, as in the log.
        goal: u64,
    },
    /// A motion, a session or a program has ended, or was not accepted.
    MotionEnded {
        /// Id of the motion, session or program.
        goal: u64,
        /// Outcome.
        outcome: Arc<Outcome>,
    },
    /// The load with which the robot computes has changed, through this program or through Desk. A
    /// change during a lost connection is also reported.
    LoadChanged {
        /// The present load.
        load: Load,
    },
    /// The connection is closed, and no other connection will follow.
    Closed {
        /// Reason why the connection is closed.
        reason: CloseReason,
    },
}

impl fmt::Display for EventKind {
    /// Prints one line.
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
                    "the robot is not as it was before the loss: {differences}"
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

/// A reflex: the robot stopped itself.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reflex {
    /// Number of the reflex, from 1. If a reflex is found after a lost connection, it gets a new
    /// number.
    pub number: u64,
    /// The errors of the robot.
    pub errors: Errors,
    /// Error of the motion that the reflex ended, with the motion's last cycles. `None` if the
    /// reflex ended no motion of this program. `franka_diagnosis` explains the cause.
    pub error: Option<Arc<ControlError>>,
    /// Differences from the robot before a lost connection, if there are any. The recovery then
    /// needs the user's approval under every policy.
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
    /// The policy limits recovery to some errors, and the reflex has other errors.
    #[error("the policy does not allow recovery from all errors of the reflex")]
    OtherError,
    /// Within its window, the robot was already recovered as often as the policy allows.
    #[error("the policy allows no more recoveries for now")]
    TooOften,
    /// The user, or the function that was asked, did not approve.
    #[error("the recovery was declined")]
    Declined,
    /// The robot requires a recovery by hand, in Desk.
    #[error("the robot must be recovered by hand, in Desk")]
    ByHand,
}

/// Health of a robot: its condition and its counters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Health {
    /// Condition of the robot, which shows if it accepts motions.
    pub condition: Condition,
    /// Time at which that condition began, counted from the first connection to the robot.
    pub since: Duration,
    /// Number of the robot's present reflex, if any. Use it to approve the recovery.
    pub reflex: Option<u64>,
    /// Number of attempts to connect since the connection was lost; 0 while the program is
    /// connected.
    pub attempts: u32,
    /// Number of connections made after the first one.
    pub reconnects: u64,
    /// Number of recoveries by the supervisor.
    pub recoveries: u64,
    /// Time from the last loss of a connection to the reconnect.
    pub last_reconnect: Option<Duration>,
    /// Duration of the last recovery by the supervisor, from the time when the reflex was noticed.
    pub last_recovery: Option<Duration>,
}

/// Condition of a robot, which shows if it accepts motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Condition {
    /// The robot accepts motions, or it runs a motion.
    Ready,
    /// The robot accepts no motions now, for this reason.
    Unready(Unready),
    /// The connection is closed, and no other connection will follow.
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
