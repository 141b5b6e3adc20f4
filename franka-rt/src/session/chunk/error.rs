//! Why points are not a chunk.

/// Why a chunk cannot be made of these points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ChunkError {
    /// There are no points.
    #[error("a chunk needs at least one point")]
    Empty,
    /// There are more points than a chunk may have.
    #[error("more than {most} points")]
    TooMany {
        /// The most that a chunk may have, [`Chunk::POINTS_MAX`](super::Chunk::POINTS_MAX).
        most: usize,
    },
    /// A number of a point is not finite, or larger than 1e6, or its quaternion is not of length
    /// one.
    #[error("point {point} holds a non-finite or far too large number, or an invalid rotation")]
    NotFinite {
        /// The point, from 0.
        point: usize,
    },
    /// A point comes less than a millisecond after the one before it, or before it.
    #[error("point {point} comes less than 1 ms after the one before it")]
    TooClose {
        /// The point, from 0.
        point: usize,
    },
    /// A point lies later than [`Chunk::OFFSET_MAX`](super::Chunk::OFFSET_MAX) after the chunk's
    /// origin.
    #[error("point {point} lies too far in the future")]
    TooLate {
        /// The point, from 0.
        point: usize,
    },
    /// Between two points the end effector turns so far that its direction is in doubt.
    #[error("{degrees} degrees from point {} to point {point}: expected less than 170", point - 1)]
    Turn {
        /// The later point, from 0.
        point: usize,
        /// The angle.
        degrees: u16,
    },
}
