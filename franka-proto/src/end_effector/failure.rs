//! An action that failed or was aborted.

use core::fmt;

use crate::command::ServiceCommand;

/// An action of an end effector that failed or was aborted.
///
/// `Display` prints libfranka's text, which is the same for all commands of a device.
///
/// ```
/// use franka_proto::gripper::{Command, Status};
///
/// let failure = Status::Aborted.result(Command::Grasp).expect_err("it was stopped");
/// assert_eq!(failure.to_string(), "libfranka gripper: Command aborted!");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Failure<C> {
    /// The device could not complete the action.
    Failed {
        /// The command whose action failed.
        command: C,
    },
    /// Another command, such as a stop, ended the action.
    Aborted {
        /// The command whose action was aborted.
        command: C,
    },
}

impl<C: ServiceCommand> fmt::Display for Failure<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ending = match self {
            Self::Failed { .. } => "failed",
            Self::Aborted { .. } => "aborted",
        };
        write!(f, "{}: Command {ending}!", C::SERVICE)
    }
}

impl<C: ServiceCommand> core::error::Error for Failure<C> {}
