//! Chunks: points with times, as a policy predicts them, and a reference that follows these points.
//!
//! ```text
//! Chunk -> ChunkWriter -> ring -> ChunkReader -> player -> servo -> reference
//!          (outside the thread)   |              where the chunk is at the robot's time, blended with what was before
//!                                 |                         follows that within the limits of the budget
//!          <- ring of what is done with, to be freed outside
//! ```
//!
//! * `value`, `error`: the chunk, and the check of its contents; `derivatives`, `curve`, `quintic`,
//!   `curve_state`: the motion through its points, computed outside the thread.
//! * `ring`: transfer to the thread and back.
//! * `player`: the desired state at a time of the robot, and the transition to a new chunk. Lost
//!   states need no special treatment: the time jumps, and the servo closes the distance.
//! * `path`, `pace`: places without times. They are timed and checked outside the thread, and then
//!   followed as a chunk whose time can wait.
//! * `servo`: a reference that follows the desired state within the limits. `course`: player and
//!   servo together, for joints and for poses.

mod course;
mod curve;
mod curve_state;
mod derivatives;
mod error;
mod pace;
mod path;
mod player;
mod quintic;
mod ring;
mod servo;
#[cfg(test)]
mod tests;
mod value;

pub(super) use course::{ChunkCourse, ChunkStart};
pub use error::ChunkError;
pub use path::{Blocked, PathError, Preview, Waypoint};
pub use ring::{ChunkReader, ChunkWriter, Fate, Full, Returned, chunk_ring};
pub use value::Chunk;
