//! The physics under the robot's controllers.
//!
//! A [`DriveTrain`] turns commanded torques into torques on the links, and a [`Plant`] turns
//! torques on the links into motion. Both are independent of the protocol, of desired values and of
//! the controllers' model. The plant may carry an undeclared load.
//!
//! [`RigidArm`] is the arm alone, by the equations of `franka-model`. `MujocoArm` (feature
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
/// Each step gets the torques that its controllers compute from the newest positions and
/// velocities.
///
/// The plant of a robot can be downcast through [`Any`]: see
/// [`Robot::plant`](crate::Robot::plant).
pub trait Plant: Any + Debug + Send {
    /// Joint positions, `[rad]`.
    fn q(&self) -> &JointVector;

    /// Joint velocities, `[rad/s]`.
    fn dq(&self) -> &JointVector;

    /// Copies links, axes, gravity and end stops from `arm`.
    fn fit(&mut self, kind: RobotKind, arm: &Arm);

    /// Advances by `dt` seconds under the torques of the drives and external torques. The plant
    /// adds contact with its own objects.
    fn step(&mut self, drive: &LinkTorque, external: &External, dt: f64);

    /// Puts the arm at rest at `q`, `[rad]`. Returns the torques that hold the arm there against
    /// gravity, `[N·m]`.
    fn place(&mut self, q: &JointVector) -> JointVector;

    /// Replaces the true load of the flange.
    fn attach(&mut self, load: Load);

    /// Drives the fingers on the flange from the next step on, and returns the distance between
    /// them, `[m]`; `None` if the plant has no fingers.
    fn drive_fingers(&mut self, _drive: &FingerDrive) -> Option<f64> {
        None
    }
}
