//! The answers of an end effector.

use super::Failure;
use crate::command::ServiceCommand;
use crate::protocol::ConnectStatus;

/// The result of an end effector's action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Status {
    /// The action succeeded.
    Success,
    /// The action failed.
    Fail,
    /// The action ended without the requested result: for example, no object was grasped.
    Unsuccessful,
    /// Another command, such as a stop, ended the action.
    Aborted,
}

impl Status {
    pub(super) const ALL: [Self; 4] =
        [Self::Success, Self::Fail, Self::Unsuccessful, Self::Aborted];

    /// Returns the result of libfranka's method for this answer to `command`: true if the action
    /// had the requested result.
    ///
    /// # Errors
    /// Returns [`Failure`] if the action failed or was aborted.
    pub fn result<C: ServiceCommand>(self, command: C) -> Result<bool, Failure<C>> {
        match self {
            Self::Success => Ok(true),
            Self::Unsuccessful => Ok(false),
            Self::Fail => Err(Failure::Failed { command }),
            Self::Aborted => Err(Failure::Aborted { command }),
        }
    }
}

/// The answer of an end effector to one request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reply {
    /// Answer to `Connect`.
    Connect {
        /// Result of the version check.
        status: ConnectStatus,
        /// Protocol version of the end effector.
        version: u16,
    },
    /// Answer to every other command: the result of the action.
    Done(Status),
}
