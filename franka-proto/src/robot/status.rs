//! How the robot answers, whatever the version. The bytes are in the version table.

/// Answer to `Move`: [`MoveStatus::MotionStarted`] first, then one of the others when the motion
/// ends; or one of the others at once if it does not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MoveStatus {
    /// The motion ended as the client asked.
    Success,
    /// The motion starts; another answer follows at its end.
    MotionStarted,
    /// A stop ended the motion.
    Preempted,
    /// A safety function ended the motion; protocol 10 only.
    PreemptedDueToActivatedSafetyFunctions,
    /// A safety function forbids the motion; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
    /// The robot's mode does not allow it.
    CommandNotPossibleRejected,
    /// A Cartesian motion cannot start where the arm is singular.
    StartAtSingularPoseRejected,
    /// A deviation or mode is out of range.
    InvalidArgumentRejected,
    /// A reflex ended the motion; the state's `reflex_reason` says why.
    ReflexAborted,
    /// The user stop ended the motion.
    EmergencyAborted,
    /// A command could not be used.
    InputErrorAborted,
    /// Something else ended the motion.
    Aborted,
}

/// Answer to `StopMove`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StopStatus {
    /// The arm stops.
    Success,
    /// The robot's mode does not allow it.
    CommandNotPossibleRejected,
    /// A safety function forbids it; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
    /// The user stop came first.
    EmergencyAborted,
    /// A reflex came first.
    ReflexAborted,
    /// Something else came first.
    Aborted,
}

/// Answer to every setter, and to `GetCartesianLimit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SetterStatus {
    /// The value holds from now on.
    Success,
    /// The robot's mode does not allow it.
    CommandNotPossibleRejected,
    /// The value is out of range.
    InvalidArgumentRejected,
    /// A safety function forbids it; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
}

/// Answer to `AutomaticErrorRecovery`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RecoveryStatus {
    /// The errors are cleared.
    Success,
    /// The robot's mode does not allow it.
    CommandNotPossibleRejected,
    /// A safety function forbids it; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
    /// A person has to move the arm first.
    ManualErrorRecoveryRequiredRejected,
    /// A reflex ended the recovery.
    ReflexAborted,
    /// The user stop ended the recovery.
    EmergencyAborted,
    /// Something else ended the recovery.
    Aborted,
}

/// Answer to `GetRobotModel`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ModelStatus {
    /// The description follows.
    Success,
    /// The robot's mode does not allow it.
    CommandNotPossibleRejected,
    /// A safety function forbids it.
    CommandRejectedDueToActivatedSafetyFunctions,
}

/// Answer to `LoadModelLibrary`; protocol 5 only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LibraryStatus {
    /// The library follows.
    Success,
    /// There is no library for this architecture and system.
    Error,
}

/// The status of any command but `Connect`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Status {
    /// Of `Move`.
    Move(MoveStatus),
    /// Of `StopMove`.
    StopMove(StopStatus),
    /// Of a setter.
    Setter(SetterStatus),
    /// Of `AutomaticErrorRecovery`.
    Recovery(RecoveryStatus),
    /// Of `GetRobotModel`.
    Model(ModelStatus),
    /// Of `LoadModelLibrary`.
    Library(LibraryStatus),
}

impl Status {
    /// Whether the command did, or began to do, what it was asked for.
    #[must_use]
    pub fn is_success(self) -> bool {
        matches!(
            self,
            Self::Move(MoveStatus::Success | MoveStatus::MotionStarted)
                | Self::StopMove(StopStatus::Success)
                | Self::Setter(SetterStatus::Success)
                | Self::Recovery(RecoveryStatus::Success)
                | Self::Model(ModelStatus::Success)
                | Self::Library(LibraryStatus::Success)
        )
    }
}
