//! The robot's answers, independent of the version. The version table contains their bytes.

/// Answer to `Move`. If the motion starts, the first answer is [`MoveStatus::MotionStarted`], and a
/// second answer follows when the motion ends. Otherwise, the first answer is another status, and
/// no second answer follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MoveStatus {
    /// The motion ended as the client requested.
    Success,
    /// The motion starts. Another answer follows when it ends.
    MotionStarted,
    /// A stop ended the motion.
    Preempted,
    /// A safety function ended the motion; protocol 10 only.
    PreemptedDueToActivatedSafetyFunctions,
    /// A safety function forbids the motion; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
    /// The robot's mode does not allow a motion.
    CommandNotPossibleRejected,
    /// A Cartesian motion cannot start at a singular pose.
    StartAtSingularPoseRejected,
    /// A deviation or mode is out of range.
    InvalidArgumentRejected,
    /// A reflex ended the motion. The state's `reflex_reason` contains the cause.
    ReflexAborted,
    /// The user stop ended the motion.
    EmergencyAborted,
    /// A command was invalid.
    InputErrorAborted,
    /// Another event ended the motion.
    Aborted,
}

/// Answer to `StopMove`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StopStatus {
    /// The arm stops.
    Success,
    /// The robot's mode does not allow a stop.
    CommandNotPossibleRejected,
    /// A safety function forbids the stop; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
    /// The user stop ended the motion first.
    EmergencyAborted,
    /// A reflex ended the motion first.
    ReflexAborted,
    /// Another event ended the motion first.
    Aborted,
}

/// Answer to every setter, and to `GetCartesianLimit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SetterStatus {
    /// The robot now uses the new value.
    Success,
    /// The robot's mode does not allow the change.
    CommandNotPossibleRejected,
    /// The value is out of range.
    InvalidArgumentRejected,
    /// A safety function forbids the change; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
}

/// Answer to `AutomaticErrorRecovery`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RecoveryStatus {
    /// The errors are cleared.
    Success,
    /// The robot's mode does not allow a recovery.
    CommandNotPossibleRejected,
    /// A safety function forbids the recovery; protocol 10 only.
    CommandRejectedDueToActivatedSafetyFunctions,
    /// A person must move the arm first.
    ManualErrorRecoveryRequiredRejected,
    /// A reflex ended the recovery.
    ReflexAborted,
    /// The user stop ended the recovery.
    EmergencyAborted,
    /// Another event ended the recovery.
    Aborted,
}

/// Answer to `GetRobotModel`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ModelStatus {
    /// The description follows.
    Success,
    /// The robot's mode does not allow the request.
    CommandNotPossibleRejected,
    /// A safety function forbids the request.
    CommandRejectedDueToActivatedSafetyFunctions,
}

/// Answer to `LoadModelLibrary`; protocol 5 only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LibraryStatus {
    /// The library follows.
    Success,
    /// No library exists for this architecture and system.
    Error,
}

/// The status of any command except `Connect`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Status {
    /// Status of `Move`.
    Move(MoveStatus),
    /// Status of `StopMove`.
    StopMove(StopStatus),
    /// Status of a setter.
    Setter(SetterStatus),
    /// Status of `AutomaticErrorRecovery`.
    Recovery(RecoveryStatus),
    /// Status of `GetRobotModel`.
    Model(ModelStatus),
    /// Status of `LoadModelLibrary`.
    Library(LibraryStatus),
}

impl Status {
    /// Returns true if the command succeeded, or if its motion started.
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
