//! Filter, limiter and check, which a control loop applies to a returned command before sending it.
//! Pure functions, composed by [`Shaper`](crate::control::Shaper).
//!
//! ```text
//! command -> filter (low-pass against the state) -> limiter (velocity, acceleration, jerk) -> check -> robot
//!            cutoff < 1000 Hz                       limit_rate
//! ```
//!
//! * [`limiter`]: limits commands to given bounds: torques, scalars, joints, Cartesian velocity and
//!   pose.
//! * [`filter`]: first-order low-pass filters of scalars, arrays and poses.
//! * [`Bounds`]: the bounds of the limiters of libfranka, for both robots.
//! * [`check`]: checks that a command is valid.
//!
//! The references of filters and limiters are the *last commanded* values of the robot's state.
//! Everything is arithmetic on arrays: nothing allocates, and nothing panics for any input.
//! Formulas, order of operations and the treatment of NaN follow libfranka 0.21
//! (`rate_limiting.cpp`, `lowpass_filter.cpp`, `control_loop.cpp`). libfranka 0.9 differs in bounds
//! and in the beginning of a motion. The robot enforces its own limits in addition.

mod bounds;
pub mod check;
mod error;
pub mod filter;
pub mod limiter;
pub(crate) mod rotation;

pub use bounds::{Bounds, VelocityBounds};
pub use error::{FilterFault, InvalidCommand, Signal};
pub use filter::{DEFAULT_CUTOFF_FREQUENCY, MAX_CUTOFF_FREQUENCY};

pub use franka_model::CYCLE;

/// Returns the smaller number. With a NaN it returns `x`, where [`f64::min`] returns the other
/// number.
const fn lo(x: f64, y: f64) -> f64 {
    if y < x { y } else { x }
}

/// Returns the larger number. With a NaN it returns `x`, where [`f64::max`] returns the other
/// number.
const fn hi(x: f64, y: f64) -> f64 {
    if x < y { y } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_nan_the_first_argument_wins() {
        assert!(lo(f64::NAN, 1.0).is_nan() && hi(f64::NAN, 1.0).is_nan());
        assert_eq!((lo(1.0, f64::NAN), hi(1.0, f64::NAN)), (1.0, 1.0));
        assert_eq!((lo(1.0, 2.0), hi(1.0, 2.0)), (1.0, 2.0));
    }
}
