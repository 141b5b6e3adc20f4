//! Errors of replays.

use core::time::Duration;

use franka_model::RobotKind;
use franka_rt::session::{ChunkError, GoalError};

use super::plan::ReplayOptions;

/// Longest gap between two cycles that a replay bridges, `[ms]`.
pub(super) const GAP_MAX: u64 = 50;

/// Reason why a recording cannot be replayed. The replay has not moved the arm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The recording comes from a different kind of robot.
    #[error("the recorded robot is {got:?}, expected {expected:?}")]
    Kind {
        /// Kind of the recorded robot.
        got: RobotKind,
        /// Kind of the robot on which the replay should run.
        expected: RobotKind,
    },
    /// The requested speed is out of bounds.
    #[error(
        "the speed factor is {got}, expected {} to 1",
        ReplayOptions::SPEED_MIN
    )]
    Speed {
        /// The given speed.
        got: f64,
    },
    /// The recording has fewer than two cycles.
    #[error("the recording has {got} cycles, expected 2 or more")]
    Short {
        /// Number of cycles.
        got: usize,
    },
    /// Cycles are missing or not in order.
    #[error(
        "the recording has a gap from {from} to {to} ms of the robot's clock, expected gaps of \
         {GAP_MAX} ms at most"
    )]
    Gap {
        /// `message_id` of the cycle before the gap.
        from: u64,
        /// `message_id` of the cycle after the gap.
        to: u64,
    },
    /// A position is not a finite number.
    #[error("a joint position is not a finite number at {time} ms of the robot's clock")]
    NotFinite {
        /// `message_id` of the cycle.
        time: u64,
    },
    /// The client did not command the joints in a part of the recording.
    #[error(
        "the recording has no commanded position at {time} ms of the robot's clock: record \
         a motion of an engaged arm, or replay the measured positions (source `measured`)"
    )]
    Uncontrolled {
        /// `message_id` of the cycle.
        time: u64,
    },
    /// A joint would exceed the velocity that a replay may use.
    #[error(
        "joint {joint} would move at {got:.3} rad/s, expected {most:.3} rad/s at most: replay at \
         speed {speed:.2} or less"
    )]
    Fast {
        /// Number of the joint, counted from 1.
        joint: usize,
        /// Largest velocity of the joint in the replay, `[rad/s]`.
        got: f64,
        /// Largest velocity that a replay may use, `[rad/s]`.
        most: f64,
        /// A speed factor at which the replay is possible.
        speed: f64,
    },
    /// A target is outside the limits, or the arm cannot reach it.
    #[error("{after:.3?} after the start of the replay: {error}")]
    Target {
        /// Time of the target, counted from the beginning of the replay.
        after: Duration,
        /// Reason why the target is refused.
        error: GoalError,
    },
    /// Some targets do not form a motion.
    #[error("{after:.3?} after the start of the replay: {error}")]
    Chunk {
        /// Time in the replay.
        after: Duration,
        /// Reason why the chunk is refused.
        error: ChunkError,
    },
}
