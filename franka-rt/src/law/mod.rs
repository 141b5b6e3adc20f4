//! Control laws: joint torques from a reference and a state.
//!
//! ```text
//! Gains -> Fade -> Tuning --+-> wrench at the end effector: hybrid or operational -> J' --+
//! reference, q, dq ---------+-> springs and dampers of the joints -> null space ---------+-> Interaction -> shaping
//! ```
//!
//! [`Gains`] are what a goal asks for. A tuning is the same in numbers, where a choice is a weight,
//! so that the way from one to the next is continuous. [`hybrid`] and [`operational`] are the two
//! laws; they differ in the wrench at the end effector and in where the springs of the joints act.
//! [`shaping`] makes of the torques what the robot accepts: clamped, low-passed, slow enough.

mod gains;
pub mod hybrid;
pub(crate) mod interaction;
pub mod operational;
pub mod shaping;
pub(crate) mod task_space;
pub(crate) mod tuning;

pub use gains::{GainError, Gains, Law};
