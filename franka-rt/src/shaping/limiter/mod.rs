//! Rate limiters. Each one moves the last command towards the given command, within the bounds
//! on the derivatives.
//!
//! | command | function | bounded quantity |
//! |---|---|---|
//! | torques | [`torques`] | rate |
//! | one velocity, seven joint velocities | [`velocity`], [`joint_velocities`] | velocity, acceleration, jerk |
//! | one position, seven joint positions | [`position`], [`joint_positions`] | velocity, acceleration, jerk |
//! | twist | [`cartesian_velocity`] | norms of the linear and of the angular part |
//! | pose | [`cartesian_pose`] | as for a twist; rotations keep 1 % more distance |
//!
//! The last values come from the robot's state: the last command, and its first and second
//! derivative. Only the command is checked. If a last value is not finite, or if the derivatives of
//! the command overflow, the result may not be finite, as in libfranka.
//! [`Shaper`](crate::control::Shaper) refuses such a result.
//!
//! # What they do not keep
//!
//! These are the limiters of libfranka 0.21, value for value, so they share its weaknesses:
//!
//! * The velocity bound takes precedence over the jerk bound. The jerk may exceed its bound if a
//!   vector turns at the velocity bound, or if a joint meets its velocity envelope.
//! * A velocity above its upper bound returns at the acceleration bound. A velocity below its lower
//!   bound returns by half of the excess per cycle, at any acceleration.
//! * The velocity envelopes of joints 5 and 7 of the FR3 assume a deceleration of 17 rad/s^2. The
//!   limiter brakes with 10 rad/s^2. If these joints move at full speed towards the upper end of
//!   their range, they pass that end.
//!
//! The robot checks every command against its own limits. None of these cases occurs while commands
//! stay away from the bounds.

mod cartesian;
mod scalar;
#[cfg(test)]
mod tests;

pub(crate) use cartesian::limit_rigid;
pub use cartesian::{CartesianBounds, POSE_ROTATION_SHARE, cartesian_pose, cartesian_velocity};
pub(crate) use scalar::limit_rate;
pub use scalar::{
    AxisBounds, JointBounds, joint_positions, joint_velocities, position, torques, velocity,
    within_echo,
};
