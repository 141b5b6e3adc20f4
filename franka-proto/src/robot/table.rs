//! The version table. It has one row per version, with all differences between versions.
//!
//! The number of a command or a status is its position in its list. The sources are
//! libfranka-common's `research_interface/robot/service_types.h` and `rbk_types.h`, in the versions
//! of libfranka 0.9 (protocol 5) and 0.21 (protocol 10).

use super::motion::{AsynchronousPart, MoveCodec};
use super::robot_command::CommandCodec;
use super::state::{AccelerometerBlock, GeneratorModes, StateCodec};
use super::{
    LibraryStatus, ModelStatus, MotionGeneratorMode, MoveGeneratorMode, MoveStatus, RecoveryStatus,
    SetterStatus, StopStatus,
};
use crate::command::Command;
use crate::protocol::ConnectStatus;
use crate::version::Version;
use crate::wire::{self, F32, F64};

/// Properties that depend on the version.
impl Version {
    /// Returns the number of a command, or `None` if the version does not have this command.
    #[must_use]
    pub fn command_number(self, command: Command) -> Option<u32> {
        let position = self.table().commands.iter().position(|&c| c == command)?;
        u32::try_from(position).ok()
    }

    /// Returns the command with this number, or `None` if the version does not have such a command.
    #[must_use]
    pub fn command_from_number(self, number: u32) -> Option<Command> {
        let index = usize::try_from(number).ok()?;
        self.table().commands.get(index).copied()
    }

    /// Returns true if the version supports the command.
    #[must_use]
    pub fn supports(self, command: Command) -> bool {
        self.table().commands.contains(&command)
    }

    /// Returns the length in bytes of a state's datagram.
    #[must_use]
    pub fn state_size(self) -> usize {
        self.table().state_codec.size
    }

    /// Returns the length in bytes of a command's datagram.
    #[must_use]
    pub fn command_size(self) -> usize {
        self.table().command_codec.size
    }

    /// Returns the motion generator that a client must request if it commands only torques.
    ///
    /// In protocol 10, this is `MoveGeneratorMode::None`, and `torque_command_finished` ends the
    /// motion. In protocol 5, a joint velocity generator runs in parallel with the torques. Send
    /// zero velocities; `motion_generation_finished` ends the motion.
    #[must_use]
    pub fn torque_generator(self) -> MoveGeneratorMode {
        self.table().torque_generator
    }

    /// Returns true if a robot of this version can plan between sparse joint targets itself:
    /// [`MoveRequest::asynchronous`](crate::MoveRequest::asynchronous).
    #[must_use]
    pub fn has_asynchronous_motion(self) -> bool {
        self.table().asynchronous_motion
    }

    /// Returns true if states contain accelerometer values.
    #[must_use]
    pub fn has_accelerometers(self) -> bool {
        self.table().accelerometers
    }

    /// Returns true if a control loop with two functions calls the motion generator's function
    /// before the torque function. The value is true in libfranka 0.9 (protocol 5) and false in
    /// 0.21 (protocol 10); source: `control_loop.cpp`.
    #[must_use]
    pub fn generator_first(self) -> bool {
        self.table().generator_first
    }

    pub(crate) fn table(self) -> &'static Table {
        match self {
            Self::V5 => &V5,
            Self::V10 => &V10,
        }
    }
}

/// One row of the version table.
pub(crate) struct Table {
    /// Commands by number.
    pub(crate) commands: &'static [Command],
    /// Statuses by byte.
    pub(crate) connect: &'static [ConnectStatus],
    pub(crate) moves: &'static [MoveStatus],
    pub(crate) stop: &'static [StopStatus],
    pub(crate) setter: &'static [SetterStatus],
    pub(crate) recovery: &'static [RecoveryStatus],
    pub(crate) model: &'static [ModelStatus],
    pub(crate) library: &'static [LibraryStatus],
    /// Layouts of the datagrams and of `Move`.
    pub(crate) state_codec: StateCodec,
    pub(crate) command_codec: CommandCodec,
    pub(crate) move_codec: MoveCodec,
    /// Capabilities.
    pub(crate) torque_generator: MoveGeneratorMode,
    pub(crate) asynchronous_motion: bool,
    pub(crate) accelerometers: bool,
    /// Conventions of libfranka.
    pub(crate) generator_first: bool,
    /// The sources that the text about an incompatible version names: one for updates, and one for
    /// the table of system images.
    pub(crate) incompatible_advice: [&'static str; 2],
}

/// Protocol 5: Franka Emika Robot.
static V5: Table = Table {
    commands: &[
        Command::Connect,
        Command::Move,
        Command::StopMove,
        Command::GetCartesianLimit,
        Command::SetCollisionBehavior,
        Command::SetJointImpedance,
        Command::SetCartesianImpedance,
        Command::SetGuidingMode,
        Command::SetEEToK,
        Command::SetNEToEE,
        Command::SetLoad,
        Command::SetFilters,
        Command::AutomaticErrorRecovery,
        Command::LoadModelLibrary,
    ],
    connect: &ConnectStatus::ALL,
    moves: &[
        MoveStatus::Success,
        MoveStatus::MotionStarted,
        MoveStatus::Preempted,
        MoveStatus::CommandNotPossibleRejected,
        MoveStatus::StartAtSingularPoseRejected,
        MoveStatus::InvalidArgumentRejected,
        MoveStatus::ReflexAborted,
        MoveStatus::EmergencyAborted,
        MoveStatus::InputErrorAborted,
        MoveStatus::Aborted,
    ],
    stop: &[
        StopStatus::Success,
        StopStatus::CommandNotPossibleRejected,
        StopStatus::EmergencyAborted,
        StopStatus::ReflexAborted,
        StopStatus::Aborted,
    ],
    setter: &[
        SetterStatus::Success,
        SetterStatus::CommandNotPossibleRejected,
        SetterStatus::InvalidArgumentRejected,
    ],
    recovery: &[
        RecoveryStatus::Success,
        RecoveryStatus::CommandNotPossibleRejected,
        RecoveryStatus::ManualErrorRecoveryRequiredRejected,
        RecoveryStatus::ReflexAborted,
        RecoveryStatus::EmergencyAborted,
        RecoveryStatus::Aborted,
    ],
    model: &[],
    library: &[LibraryStatus::Success, LibraryStatus::Error],
    state_codec: StateCodec::of::<F64, (), GeneratorsV5>(),
    command_codec: CommandCodec::of::<()>(),
    move_codec: MoveCodec::of::<()>(),
    torque_generator: MoveGeneratorMode::JointVelocity,
    asynchronous_motion: <() as AsynchronousPart>::EXISTS,
    accelerometers: <() as AccelerometerBlock>::EXISTS,
    generator_first: true,
    incompatible_advice: [
        "https://frankaemika.github.io for Panda system updates",
        "https://frankaemika.github.io/docs/compatibility.html",
    ],
};

/// Protocol 10: Franka Research 3.
static V10: Table = Table {
    commands: &[
        Command::Connect,
        Command::Move,
        Command::StopMove,
        Command::SetCollisionBehavior,
        Command::SetJointImpedance,
        Command::SetCartesianImpedance,
        Command::SetGuidingMode,
        Command::SetEEToK,
        Command::SetNEToEE,
        Command::SetLoad,
        Command::AutomaticErrorRecovery,
        Command::GetRobotModel,
    ],
    connect: &ConnectStatus::ALL,
    moves: &[
        MoveStatus::Success,
        MoveStatus::MotionStarted,
        MoveStatus::Preempted,
        MoveStatus::PreemptedDueToActivatedSafetyFunctions,
        MoveStatus::CommandRejectedDueToActivatedSafetyFunctions,
        MoveStatus::CommandNotPossibleRejected,
        MoveStatus::StartAtSingularPoseRejected,
        MoveStatus::InvalidArgumentRejected,
        MoveStatus::ReflexAborted,
        MoveStatus::EmergencyAborted,
        MoveStatus::InputErrorAborted,
        MoveStatus::Aborted,
    ],
    stop: &[
        StopStatus::Success,
        StopStatus::CommandNotPossibleRejected,
        StopStatus::CommandRejectedDueToActivatedSafetyFunctions,
        StopStatus::EmergencyAborted,
        StopStatus::ReflexAborted,
        StopStatus::Aborted,
    ],
    setter: &[
        SetterStatus::Success,
        SetterStatus::CommandNotPossibleRejected,
        SetterStatus::InvalidArgumentRejected,
        SetterStatus::CommandRejectedDueToActivatedSafetyFunctions,
    ],
    recovery: &[
        RecoveryStatus::Success,
        RecoveryStatus::CommandNotPossibleRejected,
        RecoveryStatus::CommandRejectedDueToActivatedSafetyFunctions,
        RecoveryStatus::ManualErrorRecoveryRequiredRejected,
        RecoveryStatus::ReflexAborted,
        RecoveryStatus::EmergencyAborted,
        RecoveryStatus::Aborted,
    ],
    model: &[
        ModelStatus::Success,
        ModelStatus::CommandNotPossibleRejected,
        ModelStatus::CommandRejectedDueToActivatedSafetyFunctions,
    ],
    library: &[],
    state_codec: StateCodec::of::<F32, wire::Accelerometers, GeneratorsV10>(),
    command_codec: CommandCodec::of::<u8>(),
    move_codec: MoveCodec::of::<wire::service::AsynchronousMotion>(),
    torque_generator: MoveGeneratorMode::None,
    asynchronous_motion: <wire::service::AsynchronousMotion as AsynchronousPart>::EXISTS,
    accelerometers: <wire::Accelerometers as AccelerometerBlock>::EXISTS,
    generator_first: false,
    incompatible_advice: [
        "https://frankarobotics.github.io for system updates",
        "https://frankarobotics.github.io/docs/libfranka/docs/compatibility_with_images.html",
    ],
};

/// The motion generators in a state of protocol 5.
struct GeneratorsV5;

impl GeneratorModes for GeneratorsV5 {
    const MODES: &'static [MotionGeneratorMode] = &[
        MotionGeneratorMode::Idle,
        MotionGeneratorMode::JointPosition,
        MotionGeneratorMode::JointVelocity,
        MotionGeneratorMode::CartesianPosition,
        MotionGeneratorMode::CartesianVelocity,
    ];
}

/// The motion generators in a state of protocol 10.
struct GeneratorsV10;

impl GeneratorModes for GeneratorsV10 {
    const MODES: &'static [MotionGeneratorMode] = &[
        MotionGeneratorMode::Idle,
        MotionGeneratorMode::JointPosition,
        MotionGeneratorMode::JointVelocity,
        MotionGeneratorMode::CartesianPosition,
        MotionGeneratorMode::CartesianVelocity,
        MotionGeneratorMode::None,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

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
