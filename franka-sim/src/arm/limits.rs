//! Joint limits of the robot's system versions.

use franka_model::RobotKind;
use franka_model::limits::JointLimits;

/// The joint limits that a Franka Research 3 enforces and serves. They depend on the version of its
/// system software, not on its mechanics. Both values select the same limits for a Franka Emika
/// Robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SystemLimits {
    /// System versions 5.9 and later. Their hard range is an assumption: see
    /// [`JointLimits::fr3_system_5_9`].
    #[default]
    #[cfg_attr(feature = "serde", serde(rename = "5.9"))]
    From5_9,
    /// System versions before 5.9.
    #[cfg_attr(feature = "serde", serde(rename = "before-5.9"))]
    Before5_9,
}

impl SystemLimits {
    /// The limits of a robot of this kind.
    pub fn joints(self, kind: RobotKind) -> &'static JointLimits {
        match (kind, self) {
            (RobotKind::Fr3, Self::From5_9) => JointLimits::fr3_system_5_9(),
            _ => JointLimits::of(kind),
        }
    }
}
