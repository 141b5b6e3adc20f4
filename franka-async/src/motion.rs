//! Motions under way: their futures, handles and progress; motions of several robots that begin
//! together. The module `cancel` describes what happens if such a future is dropped.

pub use crate::cancel::Canceller;
pub use crate::follow::Follow;
pub use crate::move_to::{MotionHandle, Moving};
pub use crate::progress::{Progress, Reference};
pub use franka_rt::lifecycle::Outcome;
pub use franka_rt::session::{Blocked, Preview};
pub use franka_rt::together::{StartBarrier, StartTicket};
