//! A command that the robot refused or aborted.

use core::fmt;

use super::{
    LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, Reply, SetterStatus, Status, StopStatus,
};
use crate::command::Command;
use crate::command::NO_LIBRARY;
use crate::robot::RobotMode;

/// A command that the robot refused or aborted.
///
/// `Display` prints libfranka's text byte for byte, including its mistakes (libfranka 0.21,
/// `robot_impl.h`). For example, if a safety function refuses a stop or a recovery, the text names
/// `Move`, and for setters it ends with a space.
///
/// ```
/// use franka_proto::{Command, Refusal, RobotMode, SetterStatus, Status};
///
/// let status = Status::Setter(SetterStatus::CommandNotPossibleRejected);
/// let refusal = Refusal::new(Command::SetLoad, status, RobotMode::Move).expect("not a success");
/// assert_eq!(
///     refusal.to_string(),
///     r#"libfranka: Set Load command rejected: command not possible in the current mode ("Move")!"#,
/// );
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Refusal {
    command: Command,
    status: Status,
    mode: RobotMode,
}

impl Refusal {
    /// Returns the refusal for `status` as an answer to `command`, or `None` if `status` is not a
    /// refusal.
    ///
    /// `mode` is the robot's mode, usually from the newest state.
    #[must_use]
    pub fn new(command: Command, status: Status, mode: RobotMode) -> Option<Self> {
        (!status.is_success()).then_some(Self {
            command,
            status,
            mode,
        })
    }

    /// Returns the refusal in a reply to `command`, or `None` if the reply is a success or answers
    /// `Connect`.
    #[must_use]
    pub fn from_reply(command: Command, reply: &Reply<'_>, mode: RobotMode) -> Option<Self> {
        Self::new(command, reply.status()?, mode)
    }

    /// Returns the refused command.
    #[must_use]
    pub fn command(&self) -> Command {
        self.command
    }

    /// Returns the robot's answer. The answer is never a success.
    #[must_use]
    pub fn status(&self) -> Status {
        self.status
    }

    /// Returns the robot's mode when it refused the command.
    #[must_use]
    pub fn mode(&self) -> RobotMode {
        self.mode
    }

    /// Returns the name of the refusal's row in the book's chapter on errors, `errors.md`.
    #[must_use]
    pub fn entry(&self) -> &'static str {
        match self.status {
            Status::Move(MoveStatus::Preempted) => "refused-preempted",
            Status::Move(MoveStatus::PreemptedDueToActivatedSafetyFunctions) => {
                "refused-preempted-safety"
            }
            Status::Move(MoveStatus::CommandRejectedDueToActivatedSafetyFunctions)
            | Status::StopMove(StopStatus::CommandRejectedDueToActivatedSafetyFunctions)
            | Status::Setter(SetterStatus::CommandRejectedDueToActivatedSafetyFunctions)
            | Status::Recovery(RecoveryStatus::CommandRejectedDueToActivatedSafetyFunctions)
            | Status::Model(ModelStatus::CommandRejectedDueToActivatedSafetyFunctions) => {
                "refused-safety-function"
            }
            Status::Move(MoveStatus::StartAtSingularPoseRejected) => "refused-singular",
            Status::Move(MoveStatus::InvalidArgumentRejected) => "refused-path-deviation",
            Status::Setter(SetterStatus::InvalidArgumentRejected) => "refused-invalid-argument",
            Status::Recovery(RecoveryStatus::ManualErrorRecoveryRequiredRejected) => {
                "refused-manual-recovery"
            }
            Status::Move(MoveStatus::ReflexAborted)
            | Status::StopMove(StopStatus::ReflexAborted)
            | Status::Recovery(RecoveryStatus::ReflexAborted) => "refused-reflex",
            Status::Move(MoveStatus::EmergencyAborted)
            | Status::StopMove(StopStatus::EmergencyAborted)
            | Status::Recovery(RecoveryStatus::EmergencyAborted) => "refused-user-stop",
            Status::Move(MoveStatus::InputErrorAborted) => "refused-input",
            Status::Library(LibraryStatus::Error) => "refused-library",
            Status::Move(MoveStatus::CommandNotPossibleRejected)
            | Status::StopMove(StopStatus::CommandNotPossibleRejected | StopStatus::Aborted)
            | Status::Setter(SetterStatus::CommandNotPossibleRejected)
            | Status::Recovery(RecoveryStatus::CommandNotPossibleRejected)
            | Status::Model(ModelStatus::CommandNotPossibleRejected) => "refused-not-possible",
            Status::Move(MoveStatus::Aborted | MoveStatus::Success | MoveStatus::MotionStarted)
            | Status::StopMove(StopStatus::Success)
            | Status::Setter(SetterStatus::Success)
            | Status::Recovery(RecoveryStatus::Aborted | RecoveryStatus::Success)
            | Status::Model(ModelStatus::Success)
            | Status::Library(LibraryStatus::Success) => "refused-aborted",
        }
    }

    fn reason(&self) -> Reason {
        match self.status {
            Status::Move(status) => match status {
                MoveStatus::Success | MoveStatus::MotionStarted => Reason::Text(""),
                MoveStatus::Preempted => Reason::Text(" command preempted!"),
                MoveStatus::PreemptedDueToActivatedSafetyFunctions => Reason::Text(
                    " command preempted due to activated safety function! \
                     Please disable all safety functions.",
                ),
                MoveStatus::CommandRejectedDueToActivatedSafetyFunctions => Reason::Text(SAFETY),
                MoveStatus::CommandNotPossibleRejected => Reason::NotPossible,
                MoveStatus::StartAtSingularPoseRejected => {
                    Reason::Text(" command rejected: cannot start at singular pose!")
                }
                MoveStatus::InvalidArgumentRejected => {
                    Reason::Text(" command rejected: maximum path deviation out of range!")
                }
                MoveStatus::ReflexAborted => Reason::Text(REFLEX),
                MoveStatus::EmergencyAborted => Reason::Text(USER_STOP),
                MoveStatus::InputErrorAborted => {
                    Reason::Text(" command aborted: invalid input provided!")
                }
                MoveStatus::Aborted => Reason::Text(ABORTED),
            },
            Status::StopMove(status) => match status {
                StopStatus::Success => Reason::Text(""),
                StopStatus::CommandNotPossibleRejected | StopStatus::Aborted => Reason::NotPossible,
                StopStatus::CommandRejectedDueToActivatedSafetyFunctions => Reason::MoveSafety,
                StopStatus::EmergencyAborted => Reason::Text(USER_STOP),
                StopStatus::ReflexAborted => Reason::Text(REFLEX),
            },
            Status::Setter(status) => match status {
                SetterStatus::Success => Reason::Text(""),
                SetterStatus::CommandNotPossibleRejected => Reason::NotPossible,
                SetterStatus::InvalidArgumentRejected => {
                    Reason::Text(" command rejected: invalid argument!")
                }
                SetterStatus::CommandRejectedDueToActivatedSafetyFunctions => Reason::Text(
                    " command rejected due to activated safety function! \
                     Please disable all safety functions. ",
                ),
            },
            Status::Recovery(status) => match status {
                RecoveryStatus::Success => Reason::Text(""),
                RecoveryStatus::CommandNotPossibleRejected => Reason::NotPossible,
                RecoveryStatus::CommandRejectedDueToActivatedSafetyFunctions => Reason::MoveSafety,
                RecoveryStatus::ManualErrorRecoveryRequiredRejected => {
                    Reason::Text(" command rejected: manual error recovery required!")
                }
                RecoveryStatus::ReflexAborted => Reason::Text(REFLEX),
                RecoveryStatus::EmergencyAborted => Reason::Text(USER_STOP),
                RecoveryStatus::Aborted => Reason::Text(ABORTED),
            },
            Status::Model(status) => match status {
                ModelStatus::Success => Reason::Text(""),
                ModelStatus::CommandNotPossibleRejected => Reason::NotPossible,
                ModelStatus::CommandRejectedDueToActivatedSafetyFunctions => Reason::Text(SAFETY),
            },
            Status::Library(status) => match status {
                LibraryStatus::Success => Reason::Text(""),
                LibraryStatus::Error => Reason::Library,
            },
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (command, mode) = (self.command, self.mode);
        match self.reason() {
            Reason::Text(text) => write!(f, "libfranka: {command}{text}"),
            Reason::MoveSafety => write!(f, "libfranka: {}{SAFETY}", Command::Move),
            Reason::Library => write!(f, "libfranka: {NO_LIBRARY}"),
            Reason::NotPossible => {
                write!(
                    f,
                    "libfranka: {command} command rejected: \
                     command not possible in the current mode (\"{mode}\")!"
                )?;
                if mode == RobotMode::Other {
                    f.write_str(" Did you open the brakes?")?;
                }
                Ok(())
            }
        }
    }
}

impl core::error::Error for Refusal {}

/// Part of the text after the command's name.
enum Reason {
    Text(&'static str),
    NotPossible,
    /// The text about a safety function. It names `Move`, regardless of the command.
    MoveSafety,
    /// The text about the model library. It names no command.
    Library,
}

const SAFETY: &str = " command rejected due to activated safety function! \
                      Please disable all safety functions.";
const REFLEX: &str = " command aborted: motion aborted by reflex!";
const USER_STOP: &str = " command aborted: User Stop pressed!";
const ABORTED: &str = " command aborted!";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_success_is_no_refusal() {
        for status in [
            Status::Move(MoveStatus::Success),
            Status::Move(MoveStatus::MotionStarted),
            Status::StopMove(StopStatus::Success),
            Status::Setter(SetterStatus::Success),
            Status::Recovery(RecoveryStatus::Success),
            Status::Model(ModelStatus::Success),
            Status::Library(LibraryStatus::Success),
        ] {
            assert_eq!(Refusal::new(Command::Move, status, RobotMode::Idle), None);
        }
    }
}
