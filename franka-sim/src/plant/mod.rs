//! The physics under the robot's controllers.
//!
//! A [`Plant`] turns joint torques into motion. Nothing in it knows of the protocol, of desired
//! values or of the model that the controllers believe in: it may carry a load that is not
//! declared.
//!
//! [`RigidArm`] is the arm alone, by the equations of `franka-model`. `MujocoArm` (feature
//! `mujoco`) has surroundings that it touches, and fingers. Away from contact they move alike.

#[cfg(test)]
mod energy;
mod fingers;
mod friction;
#[cfg(feature = "mujoco")]
mod mujoco;
mod parameters;
mod rigid;
mod stops;

pub use fingers::FingerDrive;
pub use friction::Friction;
#[cfg(feature = "mujoco")]
pub use mujoco::{MujocoArm, Scene, SceneError};
pub use parameters::ArmParameters;
pub use rigid::RigidArm;
pub use stops::EndStops;

use std::any::Any;
use std::fmt::Debug;

use franka_model::{JointVector, Load};

/// An arm of seven joints that torques move.
///
/// The robot calls [`step`](Self::step) several times per millisecond, each time with the torques
/// that its controllers compute from the newest positions and velocities.
///
/// The plant of a robot can be downcast through [`Any`]: see
/// [`Robot::plant`](crate::Robot::plant).
pub trait Plant: Any + Debug + Send {
    /// Joint positions, `[rad]`.
    fn q(&self) -> &JointVector;

    /// Joint velocities, `[rad/s]`.
    fn dq(&self) -> &JointVector;

    /// Torques between motors and links over the last step, as the joint sensors read them,
    /// gravity included, `[N·m]`.
    fn sensed_torque(&self) -> &JointVector;

    /// Rotor inertia felt at the joints, `[kg·m²]`: what controllers have to accelerate on top of
    /// the links.
    fn armature(&self) -> &JointVector;

    /// Advances by `dt` seconds under the motors' torques and under torques from outside (positive:
    /// they push the joint towards positive angles), `[N·m]`. What touches the arm in the plant
    /// itself comes on top.
    fn step(&mut self, motor: &JointVector, external: &JointVector, dt: f64);

    /// Puts the arm at rest at `q`, `[rad]`.
    fn place(&mut self, q: &JointVector);

    /// Replaces what the flange really carries.
    fn attach(&mut self, load: Load);

    /// Drives the fingers on the flange from the next step on, and returns how far they are apart,
    /// `[m]`; `None` if the plant has no fingers.
    fn drive_fingers(&mut self, _drive: &FingerDrive) -> Option<f64> {
        None
    }
}
