//! The common parts of all services: the trait between sessions and protocols, the errors, and the
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
/// The sessions of both sides are generic over this trait. It is sealed:
/// [`Version`](crate::Version), [`gripper::Version`](crate::gripper::Version) and
/// [`vacuum::Version`](crate::vacuum::Version) are its only implementors.
pub trait Protocol: Copy + fmt::Debug + Eq + sealed::Sealed {
    /// The commands.
    type Command: ServiceCommand;
    /// A request with its parameters.
    type Request: Clone + fmt::Debug + PartialEq;
    /// An answer to a request.
    type Reply<'a>: Copy + fmt::Debug + PartialEq;

    /// The number that the handshake carries.
    fn number(self) -> u16;

    /// The name of the device that speaks this protocol, for messages.
    fn device(self) -> &'static str;

    /// The device in the field that speaks the version `number`, if one is known.
    fn field(number: u16) -> Option<FieldDevice>;

    /// The versions of this protocol that this crate speaks, ascending.
    fn spoken() -> &'static [u16];

    /// The sources that libfranka's text about an incompatible version names: for updates, and for
    /// the table of system images.
    fn incompatible_advice(self) -> [&'static str; 2];

    /// The command of a request.
    fn command_of(request: &Self::Request) -> Self::Command;

    /// The handshake of a client that expects states on `udp_port`.
    fn connect(self, udp_port: u16) -> Self::Request;

    /// The version and the UDP port that a request announces, if it is the handshake.
    fn handshake(request: &Self::Request) -> Option<(u16, u16)>;

    /// The answer to a handshake.
    fn answer_handshake(self, status: ConnectStatus) -> Self::Reply<'static>;

    /// The answer of a device to a request with an undefined enumerator; `None` for an unknown
    /// command.
    fn rejection(self, message: &Message<'_>) -> Option<(Self::Command, Self::Reply<'static>)>;

    /// The effect of a reply on its request.
    fn progress(reply: &Self::Reply<'_>) -> Progress;

    /// The message of a request.
    ///
    /// # Errors
    /// [`RequestError::Unsupported`] if the protocol has no such command.
    fn encode_request(
        self,
        request: &Self::Request,
        id: CommandId,
    ) -> Result<Outgoing, RequestError>;

    /// The request in a message of a client.
    ///
    /// # Errors
    /// [`DecodeError`] if the message holds no valid request.
    fn decode_request(
        self,
        message: &Message<'_>,
    ) -> Result<Self::Request, DecodeError<Self::Command>>;

    /// Returns the message of a reply to `command`. The header's size includes `extra` bytes that
    /// the caller sends afterwards.
    ///
    /// # Errors
    /// [`ReplyError`] if the reply does not suit the command or the protocol.
    fn encode_reply(
        self,
        command: Self::Command,
        id: CommandId,
        reply: &Self::Reply<'_>,
        extra: usize,
    ) -> Result<Outgoing, ReplyError<Self::Command>>;

    /// The reply to `command` in a message of a device.
    ///
    /// # Errors
    /// [`DecodeError`] if the message holds no valid reply to `command`.
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
    /// The robot speaks another version.
    IncompatibleLibraryVersion,
}

impl ConnectStatus {
    /// All statuses in wire order, the same in all versions of all protocols.
    pub(crate) const ALL: [Self; 2] = [Self::Success, Self::IncompatibleLibraryVersion];
}

/// The effect of a reply on its request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The handshake has ended; the device reports this version as its own.
    Handshake(ConnectStatus, u16),
    /// The first of two answers.
    Started,
    /// The last answer.
    Ended,
}

/// A device in the field that speaks some version of a protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FieldDevice {
    /// The vendor's name of the device.
    pub name: &'static str,
    /// The system images with this version, such as `4.2.1 or later`.
    pub system: &'static str,
    /// The system to install for compatibility with this crate; `None` if the system is compatible.
    pub update: Option<&'static str>,
}

pub(crate) mod sealed {
    pub trait Sealed {}
}
