//! Control laws: joint torques from a reference and a state.
//!
//! [`hybrid`] turns a joint reference into spring and damper torques in task and joint space, [`shaping`] makes of them
//! what the robot accepts: clamped, low-passed, slow enough.

mod gains;
pub mod hybrid;
pub mod shaping;

pub use gains::{GainError, Gains};
