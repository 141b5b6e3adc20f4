//! Explains why the robot ended a motion: the exceeded limit, the events before that, and the
//! remedy.
//!
//! ```no_run
//! # use franka_async::{MotionError, Robot};
//! use franka_async::diagnosis::Diagnose;
//!
//! # async fn run(robot: Robot) {
//! if let Err(error) = robot.move_joints([0.0; 7]).await
//!     && let Some(diagnosis) = error.diagnose()
//! {
//!     println!("{diagnosis}");
//! }
//! # }
//! ```

pub use franka_diagnosis::{
    Advice, Axis, Bound, Case, Cause, Commander, Diagnose, Diagnosis, Finding, Origin, Quantity,
    Subject,
};
