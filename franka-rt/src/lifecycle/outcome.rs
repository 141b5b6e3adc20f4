//! How a motion turned out, for whoever awaited it.

use core::time::Duration;

use franka_proto::{ControlFailure, Errors, Refusal, Violation};

use crate::driver::MotionStatistics;
use crate::session::{GoalError, PoseError};

/// A motion that came to its end as asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionReport {
    /// From the first state that the goal answered to the arrival, in the robot's time.
    pub duration: Duration,
    /// Distance of the measured end effector from its target; `None` for a motion that was only to come to rest.
    pub final_error: Option<PoseError>,
    /// States that never arrived, or were skipped for a newer one, while the motion ran.
    pub lost_states: u64,
    /// Lowest success rate that the robot reported while the motion ran, in `[0, 1]`.
    pub success_rate_min: f64,
    /// Mean of it.
    pub success_rate_avg: f64,
    /// Longest time from the receipt of a state to the departure of its command.
    pub worst_turnaround: Duration,
}

impl MotionReport {
    pub(super) fn new(
        statistics: &MotionStatistics,
        duration_ms: u64,
        final_error: Option<PoseError>,
    ) -> Self {
        Self {
            duration: Duration::from_millis(duration_ms),
            final_error,
            lost_states: statistics.lost_states,
            success_rate_min: statistics.success_rate_min,
            success_rate_avg: statistics.success_rate_avg(),
            worst_turnaround: statistics.worst_turnaround,
        }
    }
}

/// Why a motion ended short of its goal. Grouped by who can act on it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// Caller: the goal was not accepted; the robot was not asked.
    #[error(transparent)]
    Goal(#[from] GoalError),
    /// Caller: a newer goal took over.
    #[error("superseded by a newer goal")]
    Superseded,
    /// Caller: a stop was asked for; the arm was braked and rests.
    #[error("stopped on request")]
    Stopped,
    /// Robot: it refused to start the motion.
    #[error("{0}")]
    Rejected(Refusal),
    /// Robot: it stopped itself. Clear the cause, then recover.
    #[error("{0}")]
    Reflex(Reflex),
    /// Robot: it ended the motion for another reason: a user stop, another client's stop, a safety function.
    #[error("{refusal}")]
    Aborted {
        /// What the robot answered.
        refusal: Refusal,
        /// Errors that hold, as far as the last state told.
        errors: Errors,
    },
    /// Robot or surroundings: the reference reached the target and the arm did not follow. It rests where it is.
    #[error(
        "the arm came to rest {:.1} mm and {:.1} mrad from the target: something holds it, or its load differs from \
         the one declared",
        .0.translation * 1e3, .0.rotation * 1e3
    )]
    Short(PoseError),
    /// Link: the robot fell silent.
    #[error("libfranka: UDP receive: Timeout (no robot state for {} ms)", .silence.as_millis())]
    LinkLost {
        /// The silence when it was given up.
        silence: Duration,
    },
    /// Link: the command connection is gone.
    #[error("{reason}")]
    ConnectionClosed {
        /// What ended it, in the words of the reference client where it has any.
        reason: String,
    },
    /// Peer: a reply of its cannot be read.
    #[error(transparent)]
    Violation(#[from] Violation),
    /// Peer: it left the protocol. Please report it.
    #[error("{what}")]
    Protocol {
        /// What it did.
        what: &'static str,
    },
}

impl MotionError {
    /// Whether the robot accepts a new motion afterwards without anybody's doing.
    ///
    /// After a reflex the robot has to be recovered first; after a lost link or connection, reconnected to.
    pub fn is_ready_for_more(&self) -> bool {
        matches!(
            self,
            Self::Goal(_) | Self::Superseded | Self::Stopped | Self::Short(_)
        )
    }
}

/// The robot stopped itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflex {
    /// What the robot answered, what stopped it (`reflex_reason` of the state that ended the motion) and the success
    /// rate before it.
    pub failure: ControlFailure,
    /// Whether the finishing command was already out: the robot refused to finish a moving command.
    pub while_finishing: bool,
}

impl core::fmt::Display for Reflex {
    /// The text that libfranka prints for the same event.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if self.while_finishing {
            // libfranka 0.21, `robot_impl.cpp`: this text takes the place of the refusal's.
            write!(
                f,
                "Motion finished commanded, but the robot is still moving! {}",
                self.failure.reflex_reason
            )?;
            return self
                .failure
                .success_rate
                .map_or(Ok(()), |rate| write!(f, "{rate}"));
        }
        write!(f, "{}", self.failure)
    }
}

impl std::error::Error for Reflex {}
