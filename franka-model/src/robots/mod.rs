//! The constants of the robots, and all differences between them.

mod fer;
mod fr3;

use crate::kind::RobotKind;
use crate::limits::{CartesianLimits, JointLimits};
use crate::model::Model;

/// Constants that differ between the kinds of robot. The [geometry](crate::geometry) is the same.
struct Description {
    /// The vendor's model, for clients.
    client: &'static Model,
    /// A physically possible model, for simulation.
    physically_consistent: &'static Model,
    cartesian: CartesianLimits,
}

/// Returns the description of a kind. No other function distinguishes the kinds.
const fn of(kind: RobotKind) -> &'static Description {
    match kind {
        RobotKind::Fr3 => &fr3::FR3,
        RobotKind::Fer => &fer::FER,
    }
}

/// The static models.
impl Model {
    /// Returns the model of the Franka Research 3 with the vendor's numbers.
    pub const fn fr3() -> &'static Self {
        Self::of(RobotKind::Fr3)
    }

    /// Returns the model of the Franka Emika Robot (Panda) that matches the robot's own model
    /// library.
    ///
    /// That library is not physically exact. Some of the [`links`](Self::links) that match it have
    /// negative moments. When the library adds a load to link 7, it ignores the distance of link
    /// 7's own mass from the common centre of mass. This omits 3.0e-3 kg·m² of the mass matrix with
    /// a load of 1.23 kg. For simulation, use
    /// [`physically_consistent`](Self::physically_consistent).
    pub const fn fer() -> &'static Self {
        Self::of(RobotKind::Fer)
    }

    /// Returns the vendor's model of a kind, for controllers. Torques from this model equal the
    /// torques of libfranka.
    pub const fn of(kind: RobotKind) -> &'static Self {
        of(kind).client
    }

    /// Returns a model of a kind with physically consistent inertial parameters, for simulation.
    ///
    /// For the Franka Research 3 this is the same model as [`of`](Self::of). For the FER it is
    /// another set of bodies, with physically correct loads. On an upright FER without a load, the
    /// two models differ by less than 0.1 N·m at moderate speed. If the base is tilted, the torques
    /// of joint 1 differ by up to 0.08 N·m per m/s² of horizontal gravity.
    pub const fn physically_consistent(kind: RobotKind) -> &'static Self {
        of(kind).physically_consistent
    }

    /// Returns the limits of the end effector and the elbow.
    pub fn cartesian_limits(&self) -> &'static CartesianLimits {
        CartesianLimits::of(self.kind)
    }
}

impl JointLimits {
    /// Returns the limits of a kind of robot. For the Franka Research 3 these are the narrower
    /// limits of systems before 5.9. A connected robot provides its own limits.
    pub const fn of(kind: RobotKind) -> &'static Self {
        &of(kind).client.joints
    }

    /// Returns the limits of a Franka Research 3 with system 5.9 or later: wider ranges, and lower
    /// speeds near the ends of the ranges.
    ///
    /// The hard range is an assumption, because no source publishes it.
    pub const fn fr3_system_5_9() -> &'static Self {
        &fr3::JOINTS_5_9
    }
}

impl CartesianLimits {
    /// Returns the limits of a kind of robot.
    pub const fn of(kind: RobotKind) -> &'static Self {
        &of(kind).cartesian
    }
}
