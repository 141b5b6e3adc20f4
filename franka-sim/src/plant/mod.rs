//! The physics under the robot's controllers.
//!
//! A [`Plant`] turns joint torques into motion. Nothing in it knows of the protocol, of desired
//! values or of the model that the controllers believe in: it may carry a load that nobody declared.

mod friction;
mod rigid;
mod stops;

pub use friction::Friction;
pub use rigid::{RigidArm, RigidParameters};
pub use stops::EndStops;

use franka_model::{JointVector, Load};

/// An arm of seven joints that torques move.
///
/// The robot calls [`step`](Self::step) several times per millisecond, each time with the torques
/// that its controllers compute from the newest positions and velocities.
pub trait Plant: Send {
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

    /// Advances by `dt` seconds under the motors' torques and under torques from outside
    /// (positive: they push the joint towards positive angles), `[N·m]`.
    fn step(&mut self, motor: &JointVector, external: &JointVector, dt: f64);

    /// Puts the arm at rest at `q`, `[rad]`.
    fn place(&mut self, q: &JointVector);

    /// Replaces what the flange really carries.
    fn attach(&mut self, load: Load);
}
