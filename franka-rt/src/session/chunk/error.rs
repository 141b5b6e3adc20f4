//! Reasons for refusing the points of a chunk.

use std::time::Duration;

/// Reason for refusing the points of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChunkError {
    /// There are no points.
    #[error("the chunk has no points, expected at least one")]
    Empty,
    /// There are more points than a chunk may have.
    #[error(
        "the chunk has too many points, expected {most} at most: send the rest as the next chunk, \
         with times from the same origin"
    )]
    TooMany {
        /// Maximum number of points, [`Chunk::POINTS_MAX`](super::Chunk::POINTS_MAX).
        most: usize,
    },
    /// A number of a point is not finite, or its magnitude is above 1e6.
    #[error("point {point} has the number {got}, expected finite numbers from -1e6 to 1e6")]
    Number {
        /// Number of the point, from 1.
        point: usize,
        /// The given number.
        got: f64,
    },
    /// The quaternion of a point does not have length one.
    #[error("the quaternion of point {point} has the length {length}, expected 1")]
    Rotation {
        /// Number of the point, from 1.
        point: usize,
        /// Length of the quaternion.
        length: f64,
    },
    /// A point is due less than a millisecond after the previous point.
    #[error(
        "point {point} is due at {time:?}, expected at least 1 ms after the previous point, which \
         is due at {before:?}"
    )]
    TooClose {
        /// Number of the point, from 1.
        point: usize,
        /// Time of the point.
        time: Duration,
        /// Time of the previous point.
        before: Duration,
    },
    /// A point is due later than [`Chunk::OFFSET_MAX`](super::Chunk::OFFSET_MAX) after the chunk's
    /// origin.
    #[error(
        "point {point} is due at {time:?}, expected at most {:?}",
        super::Chunk::OFFSET_MAX
    )]
    TooLate {
        /// Number of the point, from 1.
        point: usize,
        /// Time of the point.
        time: Duration,
    },
    /// Between two points, the end effector rotates so far that the direction of the rotation is
    /// ambiguous.
    #[error("the orientation turns by {degrees} degrees from point {} to point {point}, expected \
        less than 170 degrees", point - 1)]
    Turn {
        /// Number of the later point, from 1.
        point: usize,
        /// Angle of the rotation.
        degrees: u16,
    },
}
