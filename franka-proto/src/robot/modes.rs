//! The three modes that a robot state reports.

use core::fmt;

/// The overall mode of the robot.
///
/// The bytes on the wire are 0 to 6, in this order. As in libfranka 0.21, other bytes are decoded
/// as [`RobotMode::Other`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RobotMode {
    /// Any other mode. Usually the brakes are closed, or the robot is not ready.
    #[default]
    Other,
    /// Ready for a motion.
    Idle,
    /// A motion runs.
    Move,
    /// A person guides the arm by hand.
    Guiding,
    /// A reflex stopped the robot. Only a recovery ends this mode.
    Reflex,
    /// The user stop or a safety function holds the robot.
    UserStopped,
    /// An automatic error recovery runs.
    AutomaticErrorRecovery,
}

impl RobotMode {
    /// All modes, by their bytes.
    pub const ALL: [Self; 7] = [
        Self::Other,
        Self::Idle,
        Self::Move,
        Self::Guiding,
        Self::Reflex,
        Self::UserStopped,
        Self::AutomaticErrorRecovery,
    ];

    /// Returns the mode of a wire byte, or [`RobotMode::Other`] for an undefined byte.
    #[must_use]
    pub fn from_byte(byte: u8) -> Self {
        Self::ALL
            .get(usize::from(byte))
            .copied()
            .unwrap_or(Self::Other)
    }

    /// Returns the wire byte of this mode.
    #[must_use]
    pub fn byte(self) -> u8 {
        self as u8
    }
}

impl fmt::Display for RobotMode {
    /// Prints libfranka's text, without the double quotes of its messages.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Other => "Other",
            Self::Idle => "Idle",
            Self::Move => "Move",
            Self::Guiding => "Guiding",
            Self::Reflex => "Reflex",
            Self::UserStopped => "User stopped",
            Self::AutomaticErrorRecovery => "Automatic error recovery",
        })
    }
}

/// The motion generator that a state reports.
///
/// A `Move` request uses other numbers for the same generators: see
/// [`MoveGeneratorMode`](crate::MoveGeneratorMode). The method
/// [`in_state`](crate::MoveGeneratorMode::in_state) returns the value that states report during the
/// motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MotionGeneratorMode {
    /// No motion.
    #[default]
    Idle,
    /// Joint positions `q_c`.
    JointPosition,
    /// Joint velocities `dq_c`.
    JointVelocity,
    /// End-effector poses `O_T_EE_c`.
    CartesianPosition,
    /// End-effector twists `O_dP_EE_c`.
    CartesianVelocity,
    /// A torque motion without a generator; protocol 10 only.
    None,
    /// A byte that the protocol version does not define.
    Unknown(u8),
}

impl MotionGeneratorMode {
    /// Returns true if the client must send motion commands. This is the case in any mode except
    /// `Idle` and `None`.
    ///
    /// The rule holds for both versions, because protocol 5 has no `None`, and decodes byte 5 as
    /// `Unknown`.
    #[must_use]
    pub fn is_running(self) -> bool {
        !matches!(self, Self::Idle | Self::None)
    }
}

/// The controller that a state reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ControllerMode {
    /// The robot's joint impedance controller.
    JointImpedance,
    /// The robot's Cartesian impedance controller.
    CartesianImpedance,
    /// The client's torques.
    ExternalController,
    /// Any other controller. An idle robot reports this value.
    #[default]
    Other,
    /// A byte that the protocol does not define.
    Unknown(u8),
}

impl ControllerMode {
    /// Returns true if the client must send torques. The robot's own controllers require no
    /// torques.
    #[must_use]
    pub fn is_running(self) -> bool {
        self == Self::ExternalController
    }

    /// Returns the mode of a wire byte, which is the same in both versions.
    #[must_use]
    pub fn from_byte(byte: u8) -> Self {
        match byte {
            0 => Self::JointImpedance,
            1 => Self::CartesianImpedance,
            2 => Self::ExternalController,
            3 => Self::Other,
            unknown => Self::Unknown(unknown),
        }
    }

    /// Returns the wire byte of this mode.
    #[must_use]
    pub fn byte(self) -> u8 {
        match self {
            Self::JointImpedance => 0,
            Self::CartesianImpedance => 1,
            Self::ExternalController => 2,
            Self::Other => 3,
            Self::Unknown(byte) => byte,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn every_robot_mode_keeps_its_byte_and_the_rest_read_as_other() {
        for (byte, mode) in RobotMode::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(mode.byte()), byte);
            assert_eq!(RobotMode::from_byte(mode.byte()), mode);
        }
        assert_eq!(RobotMode::from_byte(7), RobotMode::Other);
        assert_eq!(RobotMode::from_byte(255), RobotMode::Other);
    }

    #[test]
    fn controller_bytes_survive_even_when_unknown() {
        for byte in 0..=u8::MAX {
            assert_eq!(ControllerMode::from_byte(byte).byte(), byte);
        }
    }

    #[test]
    fn the_text_of_a_mode_is_the_vendors() {
        assert_eq!(RobotMode::UserStopped.to_string(), "User stopped");
        assert_eq!(
            RobotMode::AutomaticErrorRecovery.to_string(),
            "Automatic error recovery"
        );
    }
}
