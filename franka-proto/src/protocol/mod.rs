//! Common parts of all services: the trait between sessions and protocols, the errors, and the
//! handshake.

mod error;
mod incompatible;

pub(crate) use error::payload;
pub use error::{DecodeError, EncodeError, ReplyError, RequestError, Violation};
pub use incompatible::{Explanation, IncompatibleVersion};

use core::fmt;

use crate::command::{CommandId, ServiceCommand};
use crate::framing::Message;
use crate::outgoing::Outgoing;

/// A protocol of a TCP service: a version of the robot's protocol, or the protocol of the Hand or
/// of the vacuum gripper.
///
/// The sessions of both sides are generic over this trait. The trait is sealed:
/// [`Version`](crate::Version), [`gripper::Version`](crate::gripper::Version) and
/// [`vacuum::Version`](crate::vacuum::Version) are its only implementors.
pub trait Protocol: Copy + fmt::Debug + Eq + sealed::Sealed {
    /// The commands.
    type Command: ServiceCommand;
    /// A request with its parameters.
    type Request: Clone + fmt::Debug + PartialEq;
    /// An answer to a request.
    type Reply<'a>: Copy + fmt::Debug + PartialEq;

    /// Returns the version number for the handshake.
    fn number(self) -> u16;

    /// Returns the name of the device with this protocol, for messages.
    fn device(self) -> &'static str;

    /// Returns the real device with the version `number`, if one is known.
    fn field(number: u16) -> Option<FieldDevice>;

    /// Returns the versions of this protocol that this crate supports, in ascending order.
    fn spoken() -> &'static [u16];

    /// Returns the two sources that libfranka's text about an incompatible version names: one for
    /// updates, and one for the table of system images.
    fn incompatible_advice(self) -> [&'static str; 2];

    /// Returns the command of a request.
    fn command_of(request: &Self::Request) -> Self::Command;

    /// Returns the handshake of a client that expects states on `udp_port`.
    fn connect(self, udp_port: u16) -> Self::Request;

    /// Returns the version and the UDP port in a handshake, or `None` for other requests.
    fn handshake(request: &Self::Request) -> Option<(u16, u16)>;

    /// Returns the answer to a handshake.
    fn answer_handshake(self, status: ConnectStatus) -> Self::Reply<'static>;

    /// Returns the answer of a device to a request with an undefined enumerator, or `None` for an
    /// unknown command.
    fn rejection(self, message: &Message<'_>) -> Option<(Self::Command, Self::Reply<'static>)>;

    /// Returns the effect of a reply on its request.
    fn progress(reply: &Self::Reply<'_>) -> Progress;

    /// Encodes a request as a message.
    ///
    /// # Errors
    /// Returns [`RequestError::Unsupported`] if the protocol has no such command.
    fn encode_request(
        self,
        request: &Self::Request,
        id: CommandId,
    ) -> Result<Outgoing, RequestError>;

    /// Decodes the request in a client's message.
    ///
    /// # Errors
    /// Returns [`DecodeError`] if the message contains no valid request.
    fn decode_request(
        self,
        message: &Message<'_>,
    ) -> Result<Self::Request, DecodeError<Self::Command>>;

    /// Encodes a reply to `command` as a message. The header's size includes `extra` bytes that the
    /// caller sends afterwards.
    ///
    /// # Errors
    /// Returns [`ReplyError`] if the reply does not suit the command or the protocol.
    fn encode_reply(
        self,
        command: Self::Command,
        id: CommandId,
        reply: &Self::Reply<'_>,
        extra: usize,
    ) -> Result<Outgoing, ReplyError<Self::Command>>;

    /// Decodes the reply to `command` in a device's message.
    ///
    /// # Errors
    /// Returns [`DecodeError`] if the message contains no valid reply to `command`.
    fn decode_reply<'a>(
        self,
        command: Self::Command,
        message: &Message<'a>,
    ) -> Result<Self::Reply<'a>, DecodeError<Self::Command>>;
}

/// Answer to `Connect`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ConnectStatus {
    /// The session is open.
    Success,
    /// The robot uses another version.
    IncompatibleLibraryVersion,
}

impl ConnectStatus {
    /// All statuses in the order of the protocol, which is the same in all versions of all
    /// protocols.
    pub(crate) const ALL: [Self; 2] = [Self::Success, Self::IncompatibleLibraryVersion];
}

/// The effect of a reply on its request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The handshake has ended. The second value is the version that the device reports as its own.
    Handshake(ConnectStatus, u16),
    /// The request has received the first of its two answers.
    Started,
    /// The request has received its last answer.
    Ended,
}

/// A real device with a certain version of a protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FieldDevice {
    /// The vendor's name of the device.
    pub name: &'static str,
    /// System images with this version, such as `4.2.1 or later`.
    pub system: &'static str,
    /// System that the user must install for compatibility with this crate. It is `None` if the
    /// current system is compatible.
    pub update: Option<&'static str>,
}

pub(crate) mod sealed {
    pub trait Sealed {}
}
