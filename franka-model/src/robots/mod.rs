//! The constants of the robots, and all differences between them.

mod fer;
mod fr3;

use crate::kind::RobotKind;
use crate::limits::{CartesianLimits, JointLimits};
use crate::model::Model;

/// The differences between the kinds; the [geometry](crate::geometry) is the same.
struct Description {
    /// The vendor's model, for clients.
    client: &'static Model,
    /// A physically possible model, for simulation.
    physically_consistent: &'static Model,
    cartesian: CartesianLimits,
}

/// Returns the description of a kind: the only place that distinguishes the kinds.
const fn of(kind: RobotKind) -> &'static Description {
    match kind {
        RobotKind::Fr3 => &fr3::FR3,
        RobotKind::Fer => &fer::FER,
    }
}

/// The static models.
impl Model {
    /// Returns the model of the Franka Research 3.
    pub const fn fr3() -> &'static Self {
        Self::of(RobotKind::Fr3)
    }

    /// Returns the model of the Franka Emika Robot (Panda) that matches its own model library.
    ///
    /// That library is not exact mechanics. Some of the [`links`](Self::links) that match it have
    /// negative moments. A load joins link 7 without the lever of link 7's own mass, which is
    /// 3.0e-3 kg·m² of the mass matrix under 1.23 kg. For physics use
    /// [`physically_consistent`](Self::physically_consistent).
    pub const fn fer() -> &'static Self {
        Self::of(RobotKind::Fer)
    }

    /// Returns the vendor's client model of a kind, for controllers: their torques then equal
    /// libfranka's.
    pub const fn of(kind: RobotKind) -> &'static Self {
        of(kind).client
    }

    /// Returns a model of a kind with physically consistent inertial parameters, for simulation.
    ///
    /// For the Franka Research 3 it is the same as [`of`](Self::of). For the FER it is another set
    /// of bodies, with physically correct loads. Without a load and upright, the two differ by less
    /// than 0.1 N·m at moderate speed. In a tilted base, joint 1 differs by up to 0.08 N·m per m/s²
    /// of horizontal gravity.
    pub const fn physically_consistent(kind: RobotKind) -> &'static Self {
        of(kind).physically_consistent
    }

    /// Returns the limits of its end effector and elbow.
    pub fn cartesian_limits(&self) -> &'static CartesianLimits {
        CartesianLimits::of(self.kind)
    }
}

impl JointLimits {
    /// Returns the limits of a kind of robot. For the Franka Research 3 these are the narrower
    /// limits of systems before 5.9; each robot provides its own.
    pub const fn of(kind: RobotKind) -> &'static Self {
        &of(kind).client.joints
    }

    /// Returns the limits of a Franka Research 3 with system 5.9 or later: wider ranges, and lower
    /// speeds near their ends.
    ///
    /// The hard range is an assumption: no source publishes it.
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
