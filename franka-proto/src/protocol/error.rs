//! Errors of bytes, requests, replies and peers: what was got and what was expected.

use core::fmt;

use zerocopy::{FromBytes, Immutable, KnownLayout, Unaligned};

use crate::command::{Command, CommandId, ServiceCommand};
use crate::framing::Message;
use crate::version::Version;

/// Bytes that cannot be decoded. `C` are the commands of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError<C: ServiceCommand = Command> {
    /// A datagram is shorter than its struct.
    #[error("libfranka: incorrect object size")]
    DatagramSize {
        /// Bytes there are.
        got: usize,
        /// Bytes there should be, at least.
        expected: usize,
    },
    /// A message is shorter than its header and struct.
    #[error("libfranka: Incorrect TCP message size.")]
    MessageSize {
        /// Bytes there are, with the header.
        got: usize,
        /// Bytes there should be, at least.
        expected: usize,
    },
    /// The version has no command of this number.
    #[error("protocol {version} has no command {number}")]
    UnknownCommand {
        /// The number in the header.
        number: u32,
        /// The version of the session.
        version: u16,
    },
    /// An enumerator in a request is not defined in the version.
    #[error("{field} {value} is not defined")]
    UnknownValue {
        /// The vendor's name of the field.
        field: &'static str,
        /// Its value.
        value: u32,
    },
    /// A status in a reply is not defined in the version.
    #[error("{}", Unexpected(*command))]
    UnknownStatus {
        /// The command that is answered.
        command: C,
        /// The number of the status.
        status: u16,
    },
}

impl<C: ServiceCommand> DecodeError<C> {
    pub(crate) fn datagram<T>(bytes: &[u8]) -> Self {
        Self::DatagramSize {
            got: bytes.len(),
            expected: size_of::<T>(),
        }
    }

    pub(crate) fn message<T>(message: &Message<'_>) -> Self {
        Self::MessageSize {
            got: message.size(),
            expected: message.size().saturating_sub(message.payload.len()) + size_of::<T>(),
        }
    }
}

/// The fixed struct at the start of a message's payload.
pub(crate) fn payload<'a, T: FromBytes + Immutable + KnownLayout + Unaligned, C: ServiceCommand>(
    message: &Message<'a>,
) -> Result<&'a T, DecodeError<C>> {
    let (payload, _) =
        T::ref_from_prefix(message.payload).map_err(|_| DecodeError::message::<T>(message))?;
    Ok(payload)
}

/// libfranka's text about a reply to this command with an undefined status.
struct Unexpected<C>(C);

impl<C: ServiceCommand> fmt::Display for Unexpected<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.unexpected_response(f)
    }
}

/// A datagram that cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The caller's buffer is too short.
    #[error("the buffer has {got} bytes, and the datagram needs {needed}")]
    Buffer {
        /// Bytes there are.
        got: usize,
        /// Bytes that the datagram has.
        needed: usize,
    },
    /// The version has no field or value for it.
    #[error("this protocol version cannot carry {what}")]
    Unsupported {
        /// The vendor's name of the field.
        what: &'static str,
    },
}

/// A request that the client session does not send. Nothing of it has been encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RequestError {
    /// The version has no such command, or none with these parameters.
    #[error("protocol {version} ({}) has no {what}", version.robot())]
    Unsupported {
        /// What was asked for.
        what: &'static str,
        /// The version of the session.
        version: Version,
    },
    /// The handshake is not done.
    #[error("the session is not connected")]
    NotConnected,
    /// `Connect` is sent by [`client::Session::connect`](crate::client::Session::connect).
    #[error("a handshake is not a request of a session")]
    Handshake,
    /// As many requests as the session can remember wait for their replies.
    #[error("{limit} requests wait for replies already")]
    TooManyPending {
        /// How many that are.
        limit: usize,
    },
}

/// A reply that the server session does not send. Nothing of it has been encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplyError<C: ServiceCommand = Command> {
    /// No request of this id waits for a reply.
    #[error("no request {id} waits for a reply")]
    NotPending {
        /// The id.
        id: CommandId,
    },
    /// The request is answered with another kind of reply.
    #[error("request {id} is {command}, which has another kind of reply")]
    Mismatch {
        /// The id.
        id: CommandId,
        /// What was asked for.
        command: C,
    },
    /// A `Move` has got its first answer already.
    #[error("the motion of request {id} has been reported as started")]
    AlreadyStarted {
        /// The id.
        id: CommandId,
    },
    /// The version has no such status.
    #[error("protocol {version} has no such status")]
    Unsupported {
        /// The version of the session.
        version: Version,
    },
    /// A model is sent with [`server::Session::model_header`](crate::server::Session::model_header)
    /// or [`server::Session::library_header`](crate::server::Session::library_header), which also
    /// bound its length.
    #[error("a model of {len} bytes does not fit")]
    TextLength {
        /// Length of the model in bytes.
        len: usize,
    },
}

/// A peer that violated the protocol. No caller can cause it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation<C: ServiceCommand = Command> {
    /// The status of the handshake's answer is not defined.
    #[error("libfranka: Protocol error during connection attempt")]
    ConnectStatus {
        /// The number of the status.
        status: u16,
    },
    /// The device agreed to our version and reports another one as its own.
    #[error("the device accepts protocol {announced} and reports {reported} as its own")]
    ForeignVersion {
        /// The version that the client announced.
        announced: u16,
        /// The version that the device reports.
        reported: u16,
    },
    /// The answer to a request cannot be read. The request has ended with this.
    #[error("{error}")]
    Reply {
        /// The request.
        id: CommandId,
        /// What is wrong with the answer.
        error: DecodeError<C>,
    },
    /// A motion is reported as started for the second time. It is still on.
    #[error("libfranka: Move received unexpected motion started message.")]
    SecondMotionStarted {
        /// The request.
        id: CommandId,
    },
    /// A client's message cannot be read.
    #[error("{error}")]
    Request {
        /// The id in the message.
        id: CommandId,
        /// What is wrong with it.
        error: DecodeError<C>,
    },
    /// A client's first message is not `Connect`.
    #[error("the first message is {got}, expected Connect")]
    NotConnect {
        /// What it is.
        got: C,
    },
    /// A client sends `Connect` in an open session.
    #[error("a second Connect in one session")]
    SecondConnect,
    /// A client uses the id of a request that is not answered yet.
    #[error("request {id} is not answered yet, and its id is used again")]
    RepeatedId {
        /// The id.
        id: CommandId,
    },
    /// A client has more requests open than a server remembers.
    #[error("more than {limit} requests wait for replies")]
    TooManyPending {
        /// How many a server remembers.
        limit: usize,
    },
}

impl<C: ServiceCommand> Violation<C> {
    /// The request that has ended, or in one case goes on, with this violation.
    #[must_use]
    pub fn id(&self) -> Option<CommandId> {
        match *self {
            Self::Reply { id, .. }
            | Self::SecondMotionStarted { id }
            | Self::Request { id, .. }
            | Self::RepeatedId { id } => Some(id),
            Self::ConnectStatus { .. }
            | Self::ForeignVersion { .. }
            | Self::NotConnect { .. }
            | Self::SecondConnect
            | Self::TooManyPending { .. } => None,
        }
    }

    /// True if the session cannot be used any further. A violation in a single reply leaves the
    /// others intact.
    #[must_use]
    pub fn is_fatal(&self) -> bool {
        !matches!(self, Self::Reply { .. } | Self::SecondMotionStarted { .. })
    }
}
