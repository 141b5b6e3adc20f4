//! How an end effector answers.

use super::Failure;
use crate::command::ServiceCommand;
use crate::protocol::ConnectStatus;

/// How the action of an end effector ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Status {
    /// It did what was asked.
    Success,
    /// It failed.
    Fail,
    /// It ended without the result that was asked for: nothing was grasped, say.
    Unsuccessful,
    /// Something ended it, such as a stop.
    Aborted,
}

impl Status {
    pub(super) const ALL: [Self; 4] =
        [Self::Success, Self::Fail, Self::Unsuccessful, Self::Aborted];

    /// What libfranka's methods return for this answer to `command`: whether the action had the
    /// result that was asked for.
    ///
    /// # Errors
    /// [`Failure`] if it failed or was ended.
    pub fn result<C: ServiceCommand>(self, command: C) -> Result<bool, Failure<C>> {
        match self {
            Self::Success => Ok(true),
            Self::Unsuccessful => Ok(false),
            Self::Fail => Err(Failure::Failed { command }),
            Self::Aborted => Err(Failure::Aborted { command }),
        }
    }
}

/// What an end effector answers to one request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reply {
    /// To `Connect`.
    Connect {
        /// Whether the version suits.
        status: ConnectStatus,
        /// Protocol version of the end effector.
        version: u16,
    },
    /// To everything else: how the action ended.
    Done(Status),
}
