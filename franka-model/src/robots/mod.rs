//! The constants of the robots, and everything that differs between them.

mod fer;
mod fr3;

use crate::kind::RobotKind;
use crate::limits::{CartesianLimits, JointLimits};
use crate::model::Model;

/// What differs between the kinds; the [geometry](crate::geometry) does not.
struct Description {
    /// The vendor's model, for clients.
    client: &'static Model,
    /// A model that a physical arm could have, for simulation.
    physically_consistent: &'static Model,
    cartesian: CartesianLimits,
}

/// The description of a kind: the one place that tells the kinds apart.
const fn of(kind: RobotKind) -> &'static Description {
    match kind {
        RobotKind::Fr3 => &fr3::FR3,
        RobotKind::Fer => &fer::FER,
    }
}

/// The static models.
impl Model {
    /// The Franka Research 3.
    pub const fn fr3() -> &'static Self {
        Self::of(RobotKind::Fr3)
    }

    /// The Franka Emika Robot (Panda), as its own model library computes it.
    ///
    /// That library is not exact mechanics: some of the [`links`](Self::links) that meet it have
    /// negative moments, and a load joins link 7 without the lever of link 7's own mass, which is
    /// 3.0e-3 kg·m² of the mass matrix under 1.23 kg. For physics take
    /// [`physically_consistent`](Self::physically_consistent).
    pub const fn fer() -> &'static Self {
        Self::of(RobotKind::Fer)
    }

    /// The model that the vendor's client has of a kind: what a controller computes with, so that
    /// its torques are those that libfranka's would be.
    pub const fn of(kind: RobotKind) -> &'static Self {
        of(kind).client
    }

    /// A model of a kind with physically consistent inertial parameters: what a simulation moves.
    ///
    /// For the Franka Research 3 it is [`of`](Self::of). For the FER it is another set of bodies,
    /// which loads join as mechanics has it. Without a load and upright the two differ by less than
    /// 0.1 N·m at moderate speed; in a tilted base joint 1 differs by up to 0.08 N·m per m/s² of
    /// horizontal gravity.
    pub const fn physically_consistent(kind: RobotKind) -> &'static Self {
        of(kind).physically_consistent
    }

    /// The limits of its end effector and elbow.
    pub fn cartesian_limits(&self) -> &'static CartesianLimits {
        CartesianLimits::of(self.kind)
    }
}

impl JointLimits {
    /// The limits of a kind of robot. Those of the Franka Research 3 are the narrower ones, of
    /// systems before 5.9; a robot serves its own.
    pub const fn of(kind: RobotKind) -> &'static Self {
        &of(kind).client.joints
    }

    /// The limits of a Franka Research 3 with a system from 5.9 on: wider ranges, and less speed
    /// near their ends.
    ///
    /// The hard range is an assumption: no source publishes it.
    pub const fn fr3_system_5_9() -> &'static Self {
        &fr3::JOINTS_5_9
    }
}

impl CartesianLimits {
    /// The limits of a kind of robot.
    pub const fn of(kind: RobotKind) -> &'static Self {
        &of(kind).cartesian
    }
}
