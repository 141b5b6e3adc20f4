//! Errors of received bytes, requests and replies, and violations of the protocol by the other
//! side.

use core::fmt;

use zerocopy::{FromBytes, Immutable, KnownLayout, Unaligned};

use crate::command::{Command, CommandId, ServiceCommand};
use crate::framing::Message;
use crate::version::Version;

/// Bytes that cannot be decoded. `C` is the type of the device's commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError<C: ServiceCommand = Command> {
    /// A datagram is shorter than its struct.
    #[error("libfranka: incorrect object size")]
    DatagramSize {
        /// Number of bytes received.
        got: usize,
        /// Smallest number of bytes expected.
        expected: usize,
    },
    /// A message is shorter than its header and struct.
    #[error("libfranka: Incorrect TCP message size.")]
    MessageSize {
        /// Number of bytes received, including the header.
        got: usize,
        /// Smallest number of bytes expected.
        expected: usize,
    },
    /// The version has no command with this number.
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
        /// The value of the field.
        value: u32,
    },
    /// A status in a reply is not defined in the version.
    #[error("{}", Unexpected(*command))]
    UnknownStatus {
        /// The command to which the reply belongs.
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

/// Returns the fixed struct at the start of a message's payload.
pub(crate) fn payload<'a, T: FromBytes + Immutable + KnownLayout + Unaligned, C: ServiceCommand>(
    message: &Message<'a>,
) -> Result<&'a T, DecodeError<C>> {
    let (payload, _) =
        T::ref_from_prefix(message.payload).map_err(|_| DecodeError::message::<T>(message))?;
    Ok(payload)
}

/// Prints libfranka's text about a reply to this command with an undefined status.
struct Unexpected<C>(C);

impl<C: ServiceCommand> fmt::Display for Unexpected<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.unexpected_response(f)
    }
}

/// A datagram could not be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The caller's buffer is too short.
    #[error("the buffer has {got} bytes, expected {needed} or more for the datagram")]
    Buffer {
        /// Length of the buffer in bytes.
        got: usize,
        /// Length of the datagram in bytes.
        needed: usize,
    },
    /// The version does not have this field or value.
    #[error("this protocol version cannot carry {what}")]
    Unsupported {
        /// The vendor's name of the field.
        what: &'static str,
    },
}

/// Reason why the client session cannot send a request. No part of the request has been encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RequestError {
    /// The version does not have this command, or does not support these parameters.
    #[error("protocol {version} ({}) has no {what}", version.robot())]
    Unsupported {
        /// The requested command or parameter.
        what: &'static str,
        /// The version of the session.
        version: Version,
    },
    /// The handshake has not succeeded yet.
    #[error("the session is not connected")]
    NotConnected,
    /// The request is a `Connect`. Send it with
    /// [`client::Session::connect`](crate::client::Session::connect).
    #[error("got a handshake, expected a request of an open session")]
    Handshake,
    /// The largest number of requests already wait for replies.
    #[error(
        "{limit} requests already wait for replies, and no more are allowed: await a \
        reply first"
    )]
    TooManyPending {
        /// Largest number of waiting requests.
        limit: usize,
    },
}

/// Reason why the server session cannot send a reply. No part of the reply has been encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplyError<C: ServiceCommand = Command> {
    /// No request with this id waits for a reply.
    #[error("no request {id} waits for a reply")]
    NotPending {
        /// The id of the reply.
        id: CommandId,
    },
    /// The request requires another kind of reply.
    #[error("the reply does not fit request {id}: {command} has another kind of reply")]
    Mismatch {
        /// The id of the reply.
        id: CommandId,
        /// The command of the request.
        command: C,
    },
    /// A `Move` has already received its first answer.
    #[error("the motion of request {id} is already reported as started")]
    AlreadyStarted {
        /// The id of the reply.
        id: CommandId,
    },
    /// The version has no such status.
    #[error("protocol {version} has no such status")]
    Unsupported {
        /// The version of the session.
        version: Version,
    },
    /// The message would be too long for a model. Send models with
    /// [`server::Session::model_header`](crate::server::Session::model_header) or
    /// [`server::Session::library_header`](crate::server::Session::library_header), which also
    /// limit the length.
    #[error("the model has {len} bytes, which does not fit into a reply")]
    TextLength {
        /// Length of the model in bytes.
        len: usize,
    },
}

/// The other side of the connection violated the protocol. The caller of this crate cannot cause
/// this error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation<C: ServiceCommand = Command> {
    /// The status of the handshake's answer is not defined.
    #[error("libfranka: Protocol error during connection attempt")]
    ConnectStatus {
        /// The number of the status.
        status: u16,
    },
    /// The device accepted the client's version, but reports another version as its own.
    #[error("the device accepted protocol {announced}, but reports protocol {reported} as its own")]
    ForeignVersion {
        /// The version that the client announced.
        announced: u16,
        /// The version that the device reports.
        reported: u16,
    },
    /// The answer to a request cannot be decoded. The request ends.
    #[error("{error}")]
    Reply {
        /// The id of the request.
        id: CommandId,
        /// The decoding error.
        error: DecodeError<C>,
    },
    /// The device reported for a second time that a motion has started. The motion still runs.
    #[error("libfranka: Move received unexpected motion started message.")]
    SecondMotionStarted {
        /// The id of the request.
        id: CommandId,
    },
    /// A client's message cannot be decoded.
    #[error("{error}")]
    Request {
        /// The id in the message.
        id: CommandId,
        /// The decoding error.
        error: DecodeError<C>,
    },
    /// A client's first message is not `Connect`.
    #[error("the first message is {got}, expected Connect")]
    NotConnect {
        /// The command received.
        got: C,
    },
    /// A client sent `Connect` in an open session.
    #[error("got a second Connect, expected one for each session")]
    SecondConnect,
    /// A client used the id of a request that has not been answered yet.
    #[error(
        "got the request id {id} twice, expected a new id while the first request waits for \
        its reply"
    )]
    RepeatedId {
        /// The repeated id.
        id: CommandId,
    },
    /// A client has more open requests than a server can track.
    #[error("the client sent more than {limit} requests without awaiting replies")]
    TooManyPending {
        /// Largest number of open requests.
        limit: usize,
    },
}

impl<C: ServiceCommand> Violation<C> {
    /// Returns the id of the request to which this violation belongs, if any. The request has
    /// ended, except after [`Violation::SecondMotionStarted`].
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

    /// Returns true if the session is no longer usable. A violation in a single reply does not
    /// affect other requests.
    #[must_use]
    pub fn is_fatal(&self) -> bool {
        !matches!(self, Self::Reply { .. } | Self::SecondMotionStarted { .. })
    }
}
