//! Control at 1 kHz by the user's own code: what it commands.
//!
//! * [`Torques`] and the four [`MotionCommand`]s: the values, in the robot's own terms.

mod command;

pub use command::{
    CartesianPose, CartesianVelocities, JointPositions, JointVelocities, MotionCommand, Torques,
};
