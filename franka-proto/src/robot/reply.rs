//! The replies of the robot.

use super::{
    LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus, Status, StopStatus,
    VirtualWall,
};
use crate::command::{Command, CommandId};
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::protocol::{ConnectStatus, payload};
use crate::protocol::{DecodeError, ReplyError};
use crate::version::Version;
use crate::wire;

/// The robot's answer to one request.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reply<'a> {
    /// Answer to `Connect`.
    Connect {
        /// Result of the version check.
        status: ConnectStatus,
        /// Protocol version of the robot.
        version: u16,
    },
    /// Answer to `Move`. A `Move` has two answers, unless the first is a refusal.
    Move(MoveStatus),
    /// Answer to `StopMove`.
    StopMove(StopStatus),
    /// Answer to a setter.
    Setter(SetterStatus),
    /// Answer to `AutomaticErrorRecovery`.
    Recovery(RecoveryStatus),
    /// Answer to `GetRobotModel`.
    Model {
        /// Result of the request.
        status: ModelStatus,
        /// The URDF text, usually in UTF-8. It is empty after a refusal.
        text: &'a [u8],
    },
    /// Answer to `GetCartesianLimit`.
    CartesianLimit {
        /// Result of the request.
        status: SetterStatus,
        /// The wall. It is undefined after a refusal.
        wall: VirtualWall,
    },
    /// Answer to `LoadModelLibrary`.
    ModelLibrary {
        /// Result of the request.
        status: LibraryStatus,
        /// The file of the shared library. It is empty after a refusal.
        library: &'a [u8],
    },
}

impl<'a> Reply<'a> {
    /// Returns the status, or `None` for `Connect`. A refused `Connect` has a separate error:
    /// [`IncompatibleVersion`](crate::IncompatibleVersion).
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        match *self {
            Self::Connect { .. } => None,
            Self::Move(status) => Some(Status::Move(status)),
            Self::StopMove(status) => Some(Status::StopMove(status)),
            Self::Setter(status) => Some(Status::Setter(status)),
            Self::Recovery(status) => Some(Status::Recovery(status)),
            Self::Model { status, .. } => Some(Status::Model(status)),
            Self::CartesianLimit { status, .. } => Some(Status::Setter(status)),
            Self::ModelLibrary { status, .. } => Some(Status::Library(status)),
        }
    }

    /// Returns a robot's answer to a request with an undefined enumerator, or `None` for commands
    /// without enumerators.
    pub(crate) fn to_unknown_value(command: Command) -> Option<(Command, Reply<'static>)> {
        let reply = match command {
            Command::Move => Reply::Move(MoveStatus::InvalidArgumentRejected),
            Command::LoadModelLibrary => Reply::ModelLibrary {
                status: LibraryStatus::Error,
                library: &[],
            },
            _ => return None,
        };
        Some((command, reply))
    }

    /// Returns true if this kind of reply answers `command`.
    #[must_use]
    pub fn suits(&self, command: Command) -> bool {
        match self {
            Self::Connect { .. } => command == Command::Connect,
            Self::Move(_) => command == Command::Move,
            Self::StopMove(_) => command == Command::StopMove,
            Self::Recovery(_) => command == Command::AutomaticErrorRecovery,
            Self::Model { .. } => command == Command::GetRobotModel,
            Self::CartesianLimit { .. } => command == Command::GetCartesianLimit,
            Self::ModelLibrary { .. } => command == Command::LoadModelLibrary,
            Self::Setter(_) => matches!(
                command,
                Command::SetCollisionBehavior
                    | Command::SetJointImpedance
                    | Command::SetCartesianImpedance
                    | Command::SetGuidingMode
                    | Command::SetEEToK
                    | Command::SetNEToEE
                    | Command::SetLoad
                    | Command::SetFilters
            ),
        }
    }

    /// Returns the message that carries this reply to the request `id` for `command`. The header's
    /// size includes `extra` bytes of a model that follow the message. The model in `self` must be
    /// empty, because it would not fit.
    pub(crate) fn encode(
        &self,
        version: Version,
        command: Command,
        id: CommandId,
        extra: usize,
    ) -> Result<Outgoing, ReplyError> {
        if let Self::Model { text: tail, .. } | Self::ModelLibrary { library: tail, .. } = *self
            && !tail.is_empty()
        {
            return Err(ReplyError::TextLength { len: tail.len() });
        }
        let number = version
            .command_number(command)
            .filter(|_| self.suits(command));
        let number = number.ok_or(ReplyError::Mismatch { id, command })?;
        let table = version.table();
        let status = match *self {
            Self::Connect { status, .. } => byte(table.connect, status),
            Self::Move(status) => byte(table.moves, status),
            Self::StopMove(status) => byte(table.stop, status),
            Self::Setter(status) => byte(table.setter, status),
            Self::Recovery(status) => byte(table.recovery, status),
            Self::Model { status, .. } => byte(table.model, status),
            Self::CartesianLimit { status, .. } => byte(table.setter, status),
            Self::ModelLibrary { status, .. } => byte(table.library, status),
        };
        let status = status.ok_or(ReplyError::Unsupported { version })?;
        Ok(match *self {
            Self::Connect { version, .. } => {
                let payload = wire::service::ConnectResponse {
                    status,
                    version: version.into(),
                };
                Outgoing::new(number, id, &payload, 0)
            }
            Self::CartesianLimit { wall, .. } => {
                Outgoing::new(number, id, &wall.to_wire(status), 0)
            }
            _ => Outgoing::new(number, id, &status, extra),
        })
    }

    /// Decodes the reply to `command` from a message of the robot. Bytes after a reply of fixed
    /// length are ignored.
    ///
    /// # Errors
    /// Returns [`DecodeError::MessageSize`] if the payload is too short, and
    /// [`DecodeError::UnknownStatus`] if the version does not define the status byte.
    pub fn decode(
        version: Version,
        command: Command,
        message: &Message<'a>,
    ) -> Result<Self, DecodeError> {
        let table = version.table();
        let &status = payload::<u8, _>(message)?;
        let unknown = DecodeError::UnknownStatus {
            command,
            status: status.into(),
        };
        Ok(match command {
            Command::Connect => {
                let payload: &wire::service::ConnectResponse<u8> = payload(message)?;
                Self::Connect {
                    status: meaning(table.connect, status).ok_or(unknown)?,
                    version: payload.version.get(),
                }
            }
            Command::Move => Self::Move(meaning(table.moves, status).ok_or(unknown)?),
            Command::StopMove => Self::StopMove(meaning(table.stop, status).ok_or(unknown)?),
            Command::AutomaticErrorRecovery => {
                Self::Recovery(meaning(table.recovery, status).ok_or(unknown)?)
            }
            Command::GetRobotModel => Self::Model {
                status: meaning(table.model, status).ok_or(unknown)?,
                text: &message.payload[1..],
            },
            Command::GetCartesianLimit => Self::CartesianLimit {
                status: meaning(table.setter, status).ok_or(unknown)?,
                wall: VirtualWall::from_wire(payload(message)?),
            },
            Command::LoadModelLibrary => Self::ModelLibrary {
                status: meaning(table.library, status).ok_or(unknown)?,
                library: &message.payload[1..],
            },
            Command::SetCollisionBehavior
            | Command::SetJointImpedance
            | Command::SetCartesianImpedance
            | Command::SetGuidingMode
            | Command::SetEEToK
            | Command::SetNEToEE
            | Command::SetLoad
            | Command::SetFilters => Self::Setter(meaning(table.setter, status).ok_or(unknown)?),
        })
    }
}

/// Returns the byte of a status, which is its position among the version's statuses.
fn byte<T: PartialEq>(statuses: &[T], status: T) -> Option<u8> {
    let position = statuses.iter().position(|known| *known == status)?;
    u8::try_from(position).ok()
}

/// Returns the status of a byte.
fn meaning<T: Copy>(statuses: &[T], byte: u8) -> Option<T> {
    statuses.get(usize::from(byte)).copied()
}
