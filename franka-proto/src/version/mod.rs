//! Protocol versions: what differs between them is asked for here and nowhere else.

mod incompatible;
mod protocol;
mod table;

use core::fmt;

pub use incompatible::{Explanation, IncompatibleVersion};
pub(crate) use table::Table;

use crate::service::{Command, MoveGeneratorMode};

/// A version of the robot's protocol (FCI) that this crate speaks.
///
/// `Display` is the number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Version {
    /// Franka Emika Robot (Panda), system image 4.2.1 and later.
    V5,
    /// Franka Research 3, system image 5.9.0 and later.
    V10,
}

impl Version {
    /// All versions, ascending.
    pub const ALL: [Self; 2] = [Self::V5, Self::V10];

    /// TCP port of the robot in all versions.
    pub const TCP_PORT: u16 = 1337;

    /// The number that the handshake carries.
    #[must_use]
    pub fn number(self) -> u16 {
        self.table().number
    }

    /// The version with this number, if this crate speaks it.
    #[must_use]
    pub fn from_number(number: u16) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|version| version.number() == number)
    }

    /// The vendor's name of the robot that speaks this version.
    #[must_use]
    pub fn robot(self) -> &'static str {
        self.table().robot
    }

    /// The number of a command; `None` if the version does not have it.
    #[must_use]
    pub fn command_number(self, command: Command) -> Option<u32> {
        let position = self.table().commands.iter().position(|&c| c == command)?;
        u32::try_from(position).ok()
    }

    /// The command of a number; `None` if the version does not have it.
    #[must_use]
    pub fn command_from_number(self, number: u32) -> Option<Command> {
        let index = usize::try_from(number).ok()?;
        self.table().commands.get(index).copied()
    }

    /// Whether the version has a command.
    #[must_use]
    pub fn supports(self, command: Command) -> bool {
        self.table().commands.contains(&command)
    }

    /// Length of a state's datagram in bytes.
    #[must_use]
    pub fn state_size(self) -> usize {
        self.table().state_codec.size
    }

    /// Length of a command's datagram in bytes.
    #[must_use]
    pub fn command_size(self) -> usize {
        self.table().command_codec.size
    }

    /// The motion generator to ask for when the client commands torques alone.
    ///
    /// Protocol 10 has [`MoveGeneratorMode::None`], and the motion ends with
    /// `torque_command_finished`. In protocol 5 a joint velocity generator runs beside the torques:
    /// it gets zeros, and its `motion_generation_finished` ends the motion.
    #[must_use]
    pub fn torque_generator(self) -> MoveGeneratorMode {
        self.table().torque_generator
    }

    /// Whether a robot can plan between sparse joint targets:
    /// [`MoveRequest::asynchronous`](crate::MoveRequest::asynchronous).
    #[must_use]
    pub fn has_asynchronous_motion(self) -> bool {
        self.table().asynchronous_motion
    }

    /// Whether states carry accelerometers.
    #[must_use]
    pub fn has_accelerometers(self) -> bool {
        self.table().accelerometers
    }

    /// Whether a control loop with two functions calls the one for the motion generator before the
    /// one for the torques. As in `control_loop.cpp` of libfranka 0.9 (protocol 5: it does) and
    /// 0.21 (protocol 10: it does not).
    #[must_use]
    pub fn generator_first(self) -> bool {
        self.table().generator_first
    }

    pub(crate) fn table(self) -> &'static Table {
        match self {
            Self::V5 => &table::V5,
            Self::V10 => &table::V10,
        }
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.number(), f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_found_by_their_number_alone() {
        for version in Version::ALL {
            assert_eq!(Version::from_number(version.number()), Some(version));
        }
        for number in [0, 3, 4, 6, 7, 8, 9, 11] {
            assert_eq!(Version::from_number(number), None);
        }
    }

    #[test]
    fn commands_have_the_numbers_of_the_headers() {
        let number = |version: Version, command| version.command_number(command);
        for (command, v5, v10) in [
            (Command::Connect, Some(0), Some(0)),
            (Command::Move, Some(1), Some(1)),
            (Command::StopMove, Some(2), Some(2)),
            (Command::GetCartesianLimit, Some(3), None),
            (Command::SetCollisionBehavior, Some(4), Some(3)),
            (Command::SetJointImpedance, Some(5), Some(4)),
            (Command::SetCartesianImpedance, Some(6), Some(5)),
            (Command::SetGuidingMode, Some(7), Some(6)),
            (Command::SetEEToK, Some(8), Some(7)),
            (Command::SetNEToEE, Some(9), Some(8)),
            (Command::SetLoad, Some(10), Some(9)),
            (Command::SetFilters, Some(11), None),
            (Command::AutomaticErrorRecovery, Some(12), Some(10)),
            (Command::GetRobotModel, None, Some(11)),
            (Command::LoadModelLibrary, Some(13), None),
        ] {
            assert_eq!(number(Version::V5, command), v5, "{command}");
            assert_eq!(number(Version::V10, command), v10, "{command}");
        }
        for version in Version::ALL {
            for command in Command::ALL {
                let number = version.command_number(command);
                let back = number.and_then(|number| version.command_from_number(number));
                assert_eq!(back, version.supports(command).then_some(command));
            }
            assert_eq!(version.command_from_number(14), None);
            assert_eq!(version.command_from_number(u32::MAX), None);
        }
    }
}
