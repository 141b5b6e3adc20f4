//! Rate limiters: the command nearest to the given one whose derivatives keep their bounds.
//!
//! | command | function | what is bounded |
//! |---|---|---|
//! | torques | [`torques`] | rate |
//! | one velocity, seven joint velocities | [`velocity`], [`joint_velocities`] | velocity, acceleration, jerk |
//! | one position, seven joint positions | [`position`], [`joint_positions`] | velocity, acceleration, jerk |
//! | twist | [`cartesian_velocity`] | norms of the linear and of the angular part |
//! | pose | [`cartesian_pose`] | as of a twist; rotations keep 1 % more distance |
//!
//! The last values are those of the robot's state: last command, and its first and second derivative. Only the command
//! is checked. Last values that are not finite, and commands whose derivatives overflow, may give a result that is not
//! finite, as in libfranka; [`Shaper`](super::Shaper) refuses it. From last values outside their bounds the velocity
//! returns as fast as the acceleration allows, without regard to the jerk.

mod cartesian;
mod scalar;

pub use cartesian::{CartesianBounds, POSE_ROTATION_SHARE, cartesian_pose, cartesian_velocity};
pub(crate) use scalar::limit_rate;
pub use scalar::{
    AxisBounds, JointBounds, joint_positions, joint_velocities, position, torques, velocity,
    within_echo,
};
