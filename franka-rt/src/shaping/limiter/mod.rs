//! Rate limiters: move the last command as near to the given command as the bounds on derivatives
//! allow.
//!
//! | command | function | bounded quantity |
//! |---|---|---|
//! | torques | [`torques`] | rate |
//! | one velocity, seven joint velocities | [`velocity`], [`joint_velocities`] | velocity, acceleration, jerk |
//! | one position, seven joint positions | [`position`], [`joint_positions`] | velocity, acceleration, jerk |
//! | twist | [`cartesian_velocity`] | norms of the linear and of the angular part |
//! | pose | [`cartesian_pose`] | as for a twist; rotations keep 1 % more distance |
//!
//! The last values come from the robot's state: last command, and its first and second derivative.
//! Only the command is checked. Non-finite last values, and commands whose derivatives overflow,
//! may give a non-finite result, as in libfranka. [`Shaper`](crate::control::Shaper) refuses such a
//! result.
//!
//! # What they do not keep
//!
//! These are the limiters of libfranka 0.21, value for value, with its weaknesses:
//!
//! * The jerk yields to the velocity. The jerk may exceed its bound if a vector turns at the bound
//!   of its velocity, and if a joint meets the envelope of its position.
//! * Above its upper bound a velocity returns at the bound of the acceleration. Below the lower
//!   bound it returns by half of the excess per cycle, at any acceleration.
//! * Joints 5 and 7 of the FR3 have envelopes for a deceleration of 17 rad/s^2. The limiter brakes
//!   with 10. At full speed towards the upper end of their range, these joints pass that end.
//!
//! The robot judges every command by its own limits. Commands that stay away from the bounds cause
//! none of these cases.

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
