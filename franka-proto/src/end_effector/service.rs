//! The protocol of an end effector, shared by both devices.

use core::fmt;

use zerocopy::byteorder::little_endian::U16;
use zerocopy::{Immutable, IntoBytes};

use super::{Reply, Status};
use crate::command::CommandId;
use crate::command::ServiceCommand;
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::protocol::{ConnectStatus, payload};
use crate::protocol::{DecodeError, ReplyError, RequestError};
use crate::protocol::{FieldDevice, Progress, Protocol, sealed};
use crate::wire;

/// The parts of an end effector's protocol that differ between the Hand and the vacuum gripper.
/// This trait is sealed.
pub trait EndEffector: Copy + fmt::Debug + Eq + sealed::Sealed {
    /// The commands. The number of a command is its position in [`Self::COMMANDS`].
    type Command: ServiceCommand;
    /// A request with its parameters.
    type Request: Clone + fmt::Debug + PartialEq;

    /// The version of the protocol.
    const NUMBER: &'static [u16; 1];
    /// The commands by number.
    const COMMANDS: &'static [Self::Command];
    /// The vendor's name of the device.
    const DEVICE: &'static str;

    /// Creates the request for the handshake.
    fn hello(version: u16, udp_port: u16) -> Self::Request;

    /// Returns the version and the UDP port of a handshake, or `None` for other requests.
    fn announced(request: &Self::Request) -> Option<(u16, u16)>;

    /// Returns the command of a request.
    fn command(request: &Self::Request) -> Self::Command;

    /// Writes the parameters of a request.
    fn encode(request: &Self::Request, draft: Draft) -> Outgoing;

    /// Reads the parameters of a request.
    ///
    /// # Errors
    /// Returns [`DecodeError`] if there are too few bytes, or an enumerator is not defined.
    fn decode(
        command: Self::Command,
        message: &Message<'_>,
    ) -> Result<Self::Request, DecodeError<Self::Command>>;
}

/// A message with a complete header and without a payload.
#[derive(Clone, Copy, Debug)]
pub struct Draft {
    number: u32,
    id: CommandId,
}

impl Draft {
    /// Completes the message as a handshake.
    pub(crate) fn handshake(self, version: u16, udp_port: u16) -> Outgoing {
        self.with(&wire::service::ConnectRequest {
            version: version.into(),
            udp_port: udp_port.into(),
        })
    }

    /// Completes the message with this payload.
    pub(crate) fn with<P: IntoBytes + Immutable>(self, payload: &P) -> Outgoing {
        Outgoing::with_header::<U16, P>(self.number, self.id, payload, 0)
    }
}

impl<E: EndEffector> Protocol for E {
    type Command = E::Command;
    type Request = E::Request;
    type Reply<'a> = Reply;

    fn number(self) -> u16 {
        E::NUMBER[0]
    }

    fn device(self) -> &'static str {
        E::DEVICE
    }

    fn field(_: u16) -> Option<FieldDevice> {
        None
    }

    fn spoken() -> &'static [u16] {
        E::NUMBER
    }

    /// Returns the advice of libfranka 0.21. It fits both robots, because an end effector has the
    /// same protocol on both.
    fn incompatible_advice(self) -> [&'static str; 2] {
        crate::Version::V10.incompatible_advice()
    }

    fn command_of(request: &E::Request) -> E::Command {
        E::command(request)
    }

    fn connect(self, udp_port: u16) -> E::Request {
        E::hello(self.number(), udp_port)
    }

    fn handshake(request: &E::Request) -> Option<(u16, u16)> {
        E::announced(request)
    }

    fn answer_handshake(self, status: ConnectStatus) -> Reply {
        let version = self.number();
        Reply::Connect { status, version }
    }

    fn rejection(self, message: &Message<'_>) -> Option<(E::Command, Reply)> {
        let command = command::<E>(message.header.command)?;
        Some((command, Reply::Done(Status::Fail)))
    }

    fn progress(reply: &Reply) -> Progress {
        match *reply {
            Reply::Connect { status, version } => Progress::Handshake(status, version),
            Reply::Done(_) => Progress::Ended,
        }
    }

    fn encode_request(self, request: &E::Request, id: CommandId) -> Result<Outgoing, RequestError> {
        let number = number::<E>(E::command(request));
        Ok(E::encode(request, Draft { number, id }))
    }

    fn decode_request(self, message: &Message<'_>) -> Result<E::Request, DecodeError<E::Command>> {
        let (number, version) = (message.header.command, self.number());
        let command =
            command::<E>(number).ok_or(DecodeError::UnknownCommand { number, version })?;
        E::decode(command, message)
    }

    fn encode_reply(
        self,
        command: E::Command,
        id: CommandId,
        reply: &Reply,
        _: usize,
    ) -> Result<Outgoing, ReplyError<E::Command>> {
        let number = number::<E>(command);
        let draft = Draft { number, id };
        let is_handshake = command == E::Command::CONNECT;
        match *reply {
            Reply::Connect { status, version } if is_handshake => {
                Ok(draft.with(&wire::service::ConnectResponse {
                    status: U16::new(status as u16),
                    version: version.into(),
                }))
            }
            Reply::Done(status) if !is_handshake => Ok(draft.with(&U16::new(status as u16))),
            _ => Err(ReplyError::Mismatch { id, command }),
        }
    }

    fn decode_reply<'a>(
        self,
        command: E::Command,
        message: &Message<'a>,
    ) -> Result<Reply, DecodeError<E::Command>> {
        let status = payload::<U16, _>(message)?.get();
        let unknown = DecodeError::UnknownStatus { command, status };
        if command == E::Command::CONNECT {
            let payload: &wire::service::ConnectResponse<U16> = payload(message)?;
            let statuses = ConnectStatus::ALL;
            return Ok(Reply::Connect {
                status: meaning(&statuses, status).ok_or(unknown)?,
                version: payload.version.get(),
            });
        }
        Ok(Reply::Done(meaning(&Status::ALL, status).ok_or(unknown)?))
    }
}

/// Returns the number of a command: its position in the list of all commands.
fn number<E: EndEffector>(command: E::Command) -> u32 {
    let position = E::COMMANDS.iter().position(|&known| known == command);
    position.unwrap_or_default() as u32
}

/// Returns the command with this number.
fn command<E: EndEffector>(number: u32) -> Option<E::Command> {
    let index = usize::try_from(number).ok()?;
    E::COMMANDS.get(index).copied()
}

/// Returns the status with this number.
fn meaning<T: Copy>(statuses: &[T], number: u16) -> Option<T> {
    statuses.get(usize::from(number)).copied()
}
