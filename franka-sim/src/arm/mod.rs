//! Parameters of one simulated arm: its differences from its model, and from ideal drives and
//! sensors.
//!
//! ```text
//! Family (distributions, JSON) ── sample, central ──> Arm ──> drive train, plant, sensors
//! ```
//!
//! | module | content |
//! |---|---|
//! | `friction` | [`Friction`] of the joints |
//! | `drive` | [`Drive`]: rotors, torque loop, elasticity, ripple, torque by pose |
//! | `sensors` | [`Sensors`]: offset, noise and quanta |
//! | `body` | [`Body`]: errors of links, axes and load, base tilt, end stops |
//! | `limits` | [`SystemLimits`]: joint limits of the robot's system versions |
//! | `state_geometry` | [`StateGeometry`]: the geometry from which the robot computes its poses |
//! | `family` | [`Family`]: distributions of all of these, read from JSON |
//!
//! The documentation of each field names the source of its figures.

mod body;
mod drive;
mod family;
mod friction;
mod limits;
mod sensors;
mod state_geometry;

pub use body::{Body, EndStops};
pub use drive::{Drive, Elasticity, PoseTorque, Ripple};
pub use family::{Distribution, Elastic, Family, FamilyError, Values};
pub use friction::{Bristle, Friction};
pub use limits::SystemLimits;
pub use sensors::Sensors;
pub use state_geometry::StateGeometry;

use franka_model::{Model, RobotKind};

use crate::network::Stalls;

/// The parameters of one arm. Units are SI. Vectors contain joints 1 to 7, in this order.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Joint friction.
    pub friction: Friction,
    /// Rotors, gears and torque loops.
    pub drive: Drive,
    /// Errors of the sensors.
    pub sensors: Sensors,
    /// True links, axes, load and mounting.
    pub body: Body,
    /// Joint limits that the robot enforces and serves.
    pub limits: SystemLimits,
    /// Stalls of the network interface that sends the states; `None` for an interface without
    /// stalls. [`Sim`](crate::Sim) applies them unless it has a simulated network.
    pub stalls: Option<Stalls>,
}

impl Arm {
    /// An arm that matches its model: rigid joints, a perfect torque loop and perfect sensors. Its
    /// friction is smooth, and a twentieth of the published friction, which makes the arm creep to
    /// its target. Its lengths match the vendor's description, even for a Franka Research 3.
    ///
    /// Use this arm for tests that need exact results.
    pub fn ideal(kind: RobotKind) -> Self {
        Self {
            friction: Friction::smooth(kind),
            drive: Drive::ideal(kind),
            sensors: Sensors::PERFECT,
            body: Body::exact(kind),
            limits: SystemLimits::default(),
            stalls: None,
        }
    }

    /// The central arm of [`Family::nominal`] (see [`Self::central`]): a good arm, better than the
    /// real arms for which measurements are published.
    pub fn nominal(kind: RobotKind) -> Self {
        Self::central(kind, &Family::nominal())
    }

    /// The central arm of [`Family::realistic`].
    pub fn realistic(kind: RobotKind) -> Self {
        Self::central(kind, &Family::realistic())
    }

    /// The central arm of [`Family::bad`]: worn, badly calibrated, with an undeclared load.
    pub fn bad(kind: RobotKind) -> Self {
        Self::central(kind, &Family::bad())
    }

    /// The model that the robot's controllers use: the model of the arm's kind, with the geometry
    /// of its states and the limits of its system.
    pub(crate) fn model(&self, kind: RobotKind) -> Model {
        let limits = *self.limits.joints(kind);
        let model = self.body.state_geometry.model(kind);
        model.with_joint_limits(limits)
    }

    /// The arm of this family with every parameter in the middle of its distribution.
    pub fn central(kind: RobotKind, family: &Family) -> Self {
        family.arm(kind, None)
    }

    /// One arm of the family. The same seed always selects the same arm.
    pub fn sample(kind: RobotKind, seed: u64, family: &Family) -> Self {
        family.arm(kind, Some(seed))
    }
}
