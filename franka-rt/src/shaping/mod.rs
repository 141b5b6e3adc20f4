//! Filter, limiter and check, which a control loop applies to a command before it sends the
//! command. These are pure functions; [`Shaper`](crate::control::Shaper) combines them.
//!
//! ```text
//! command -> filter (low-pass against the state) -> limiter (velocity, acceleration, jerk) -> check -> robot
//!            cutoff < 1000 Hz                       limit_rate
//! ```
//!
//! * [`limiter`]: limits torques, scalars, joint motions, twists and poses to given bounds.
//! * [`filter`]: first-order low-pass filters for scalars, arrays and poses.
//! * [`Bounds`]: bounds of libfranka's limiters, for both robots.
//! * [`check`]: checks that a command is valid.
//!
//! Filters and limiters compare a command with the *last commanded* values in the robot's state.
//! All functions compute on arrays: nothing allocates, and nothing panics for any input. Formulas,
//! order of operations and the treatment of NaN follow libfranka 0.21 (`rate_limiting.cpp`,
//! `lowpass_filter.cpp`, `control_loop.cpp`). libfranka 0.9 uses other bounds, and treats the
//! beginning of a motion differently. The robot also enforces its own limits.

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

/// Returns the smaller number. If either is NaN it returns `x`, whereas [`f64::min`] returns the
/// number that is not NaN.
const fn lo(x: f64, y: f64) -> f64 {
    if y < x { y } else { x }
}

/// Returns the larger number. If either is NaN it returns `x`, whereas [`f64::max`] returns the
/// number that is not NaN.
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
