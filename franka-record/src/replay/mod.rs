//! Replays a recorded motion as targets of an arm.
//!
//! ```text
//! samples --ReplayPlan::new--> targets 10 ms apart, checked --ReplayCourse--> chunks, one ahead of the arm
//!                                   '-- where the arm was --ReplayDeviation--> how far off it is now
//! ```
//!
//! * `plan`: the targets, and the limits that they require. `error`: the reasons for refusals.
//! * `course`: the schedule of the chunks on the robot's clock.
//! * `deviation`: the distance between the actual and the recorded motion.
//!
//! This module does not move an arm. `franka-async` moves the arm in a session with all guards.

mod course;
mod deviation;
mod error;
mod plan;

pub use course::ReplayCourse;
pub use deviation::{Distance, ReplayDeviation, Spread};
pub use error::ReplayError;
pub use plan::{ReplayOptions, ReplayPlan, ReplaySource, ReplayTargets};
