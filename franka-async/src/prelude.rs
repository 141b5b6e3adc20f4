//! What a first program needs, by one import:
//!
//! ```
//! use franka_async::prelude::*;
//! ```
//!
//! `Error` and the conditions of [`condition`](crate::condition) are not in it, for their names are
//! common words.

pub use crate::connection::Builder;
pub use crate::diagnosis::Diagnose;
pub use crate::goal::OnTimeout;
pub use crate::state::{RobotMode, RobotState};
pub use crate::supervision::Policy;
pub use crate::{
    Arm, Engage, Motion, MotionError, MotionReport, Offset, Pose, READY, Realtime, Robot,
};
