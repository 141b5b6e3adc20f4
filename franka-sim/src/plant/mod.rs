//! The physics under the robot's controllers.
//!
//! A [`DriveTrain`] turns commanded torques into torques on the links, and a [`Plant`] turns
//! torques on the links into motion. Both are independent of the protocol, of desired values and of
//! the controllers' model. The plant's load may differ from the declared load.
//!
//! [`RigidArm`] simulates the arm alone, with the equations of `franka-model`. `MujocoArm` (feature
//! `mujoco`) adds fingers, and surroundings that the arm can touch. Without contact, both plants
//! move in the same way.

mod drive;
#[cfg(test)]
mod energy;
mod external;
mod fingers;
#[cfg(feature = "mujoco")]
mod mujoco;
mod rigid;

pub use drive::{DriveTrain, LinkTorque};
pub use external::External;
pub use fingers::FingerDrive;
#[cfg(feature = "mujoco")]
pub use mujoco::{Mount, MujocoArm, Scene, SceneError, SharedArm, shared_world};
pub use rigid::RigidArm;

use std::any::Any;
use std::fmt::Debug;

use franka_model::{JointVector, Load, RobotKind};

use crate::arm::Arm;

/// Steps of the plant, and of the innermost control loops, per millisecond.
pub(crate) const STEPS: u32 = 4;

/// The links of an arm of seven joints, and their surroundings.
///
/// The robot calls [`step`](Self::step) several times per millisecond, through a [`DriveTrain`].
/// For each step, the robot's controllers compute torques from the newest positions and velocities.
///
/// The plant of a robot can be downcast through [`Any`]: see
/// [`Robot::plant`](crate::Robot::plant).
pub trait Plant: Any + Debug + Send {
    /// Joint positions, `[rad]`.
    fn q(&self) -> &JointVector;

    /// Joint velocities, `[rad/s]`.
    fn dq(&self) -> &JointVector;

    /// Sets links, axes, gravity and end stops to the values of `arm`.
    fn fit(&mut self, kind: RobotKind, arm: &Arm);

    /// Advances by `dt` seconds under the torques of the drives and the external torques. The plant
    /// adds the contact forces of objects around the arm.
    fn step(&mut self, drive: &LinkTorque, external: &External, dt: f64);

    /// Puts the arm at rest at `q`, `[rad]`. Returns the torques that hold the arm there against
    /// gravity, `[N·m]`.
    fn place(&mut self, q: &JointVector) -> JointVector;

    /// Replaces the true load of the flange.
    fn attach(&mut self, load: Load);

    /// Sets the command of the fingers on the flange for the next steps. Returns the distance
    /// between the fingers, `[m]`, or `None` if the plant has no fingers.
    fn drive_fingers(&mut self, _drive: &FingerDrive) -> Option<f64> {
        None
    }
}
