//! Why a recording is not replayed.

use core::time::Duration;

use franka_model::RobotKind;
use franka_rt::session::{ChunkError, GoalError};

use super::plan::ReplayOptions;

/// The longest time without a cycle that is bridged, `[ms]`.
pub(super) const GAP_MAX: u64 = 50;

/// Why a recording is not replayed. Nothing has moved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The recording is of another kind of robot.
    #[error("the recording is of {got:?}, expected {expected:?}")]
    Kind {
        /// The robot that was recorded.
        got: RobotKind,
        /// The robot that is to move.
        expected: RobotKind,
    },
    /// The speed is out of bounds.
    #[error("speed {got}, expected {} to 1", ReplayOptions::SPEED_MIN)]
    Speed {
        /// The speed given.
        got: f64,
    },
    /// There are not two cycles to move between.
    #[error("{got} cycles, expected 2 or more")]
    Short {
        /// How many there are.
        got: usize,
    },
    /// Cycles are missing, or do not follow each other.
    #[error(
        "cycle {to} ms follows {from} ms of the robot's clock, expected at most {GAP_MAX} ms between them"
    )]
    Gap {
        /// `message_id` of the cycle before.
        from: u64,
        /// `message_id` of the one after it.
        to: u64,
    },
    /// A position is not a finite number.
    #[error("a joint position is not a finite number at {time} ms of the robot's clock")]
    NotFinite {
        /// `message_id` of the cycle.
        time: u64,
    },
    /// Nothing controlled the joints.
    #[error(
        "no commanded position at {time} ms (robot clock): engage the arm for the whole \
         motion, or follow measured positions (the source `measured`)"
    )]
    Uncontrolled {
        /// `message_id` of the cycle.
        time: u64,
    },
    /// A joint would be faster than it may.
    #[error(
        "joint {joint} at {got:.3} rad/s, expected {most:.3} at most: replay at speed {speed:.2} or less"
    )]
    Fast {
        /// The joint, from 1.
        joint: usize,
        /// Its greatest velocity, `[rad/s]`.
        got: f64,
        /// What a replay may need, `[rad/s]`.
        most: f64,
        /// The speed that would do.
        speed: f64,
    },
    /// A target is out of bounds or out of reach.
    #[error("{after:.3?} after the begin: {error}")]
    Target {
        /// The time in the replay.
        after: Duration,
        /// The error.
        error: GoalError,
    },
    /// Targets do not make a motion.
    #[error("{after:.3?} after the begin: {error}")]
    Chunk {
        /// The time in the replay.
        after: Duration,
        /// The error.
        error: ChunkError,
    },
}
