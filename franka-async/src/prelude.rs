//! Imports the names for a first program:
//!
//! ```
//! use franka_async::prelude::*;
//! ```
//!
//! `Error` and the conditions of [`condition`](crate::condition) are not in the prelude, because
//! their names are common words.

#[doc(no_inline)]
pub use crate::connection::Builder;
#[doc(no_inline)]
pub use crate::diagnosis::Diagnose;
#[doc(no_inline)]
pub use crate::goal::OnTimeout;
#[doc(no_inline)]
pub use crate::state::{RobotMode, RobotState};
#[doc(no_inline)]
pub use crate::{
    Arm, Engage, Motion, MotionError, MotionReport, Offset, Pose, READY, Realtime, Robot,
};
