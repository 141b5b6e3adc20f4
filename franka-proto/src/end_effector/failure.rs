//! An action that did not come to its end.

use core::fmt;

use crate::command::ServiceCommand;

/// An action of an end effector that failed or was ended.
///
/// `Display` is libfranka's text, the same for all commands of a device.
///
/// ```
/// use franka_proto::gripper::{Command, Status};
///
/// let failure = Status::Aborted.result(Command::Grasp).expect_err("it was stopped");
/// assert_eq!(failure.to_string(), "libfranka gripper: Command aborted!");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Failure<C> {
    /// The device could not do it.
    Failed {
        /// What was asked for.
        command: C,
    },
    /// Something ended the action, such as a stop.
    Aborted {
        /// What was asked for.
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
