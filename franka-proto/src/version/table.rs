//! The table: one row per version, everything that differs between them.
//!
//! Numbers of commands and statuses are positions in the lists. Sources: libfranka-common,
//! `research_interface/robot/service_types.h` and `rbk_types.h`, as libfranka 0.9 (protocol 5) and
//! 0.21 (protocol 10) use them.

use crate::command::CommandCodec;
use crate::modes::MotionGeneratorMode;
use crate::service::{
    AsynchronousPart, Command, ConnectStatus, LibraryStatus, ModelStatus, MoveCodec,
    MoveGeneratorMode, MoveStatus, RecoveryStatus, SetterStatus, StopStatus,
};
use crate::state::{AccelerometerBlock, GeneratorModes, StateCodec};
use crate::wire::{self, F32, F64};

/// One version's row.
pub(crate) struct Table {
    pub(crate) number: u16,
    pub(crate) robot: &'static str,
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
    /// Layouts.
    pub(crate) state_codec: StateCodec,
    pub(crate) command_codec: CommandCodec,
    pub(crate) move_codec: MoveCodec,
    /// Capabilities.
    pub(crate) torque_generator: MoveGeneratorMode,
    pub(crate) asynchronous_motion: bool,
    pub(crate) accelerometers: bool,
    /// Conventions of the reference client.
    pub(crate) generator_first: bool,
    /// Where the text about an incompatible version sends the reader: for updates, and for the
    /// table of images.
    pub(crate) incompatible_advice: [&'static str; 2],
}

/// Protocol 5: Franka Emika Robot.
pub(crate) static V5: Table = Table {
    number: 5,
    robot: "Franka Emika Robot",
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
pub(crate) static V10: Table = Table {
    number: 10,
    robot: "Franka Research 3",
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
