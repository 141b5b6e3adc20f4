//! The requests to the vacuum gripper.

use core::fmt;

use super::Version;
use crate::command::ServiceCommand;
use crate::end_effector::{Draft, EndEffector};
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::protocol::DecodeError;
use crate::protocol::payload;
use crate::protocol::sealed;
use crate::wire;

/// The commands of the vacuum gripper. The gripper replies once to each command, after the action
/// has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Opens a session.
    Connect,
    /// Picks up an object by vacuum.
    Vacuum,
    /// Drops the object.
    DropOff,
    /// Stops the current action.
    Stop,
}

/// A request with its parameters. The gripper, not this crate, checks the ranges of the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Request {
    /// Opens a session.
    Connect {
        /// Protocol version of the client.
        version: u16,
        /// UDP port of the client.
        udp_port: u16,
    },
    /// Picks up an object by vacuum.
    Vacuum(Vacuum),
    /// Drops the object.
    DropOff {
        /// Time limit `[ms]`.
        timeout: i64,
    },
    /// Stops the current action. The gripper replies to that action with the status "aborted".
    Stop,
}

/// The parameters of a vacuum grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Vacuum {
    /// Target vacuum, in units of 10 mbar.
    pub vacuum: u8,
    /// Production set-up profile of the device.
    pub profile: Profile,
    /// Time limit `[ms]`.
    pub timeout: i64,
}

/// A production set-up profile of the device. libfranka's default is [`P0`](Self::P0).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Profile {
    /// Profile 0.
    #[default]
    P0,
    /// Profile 1.
    P1,
    /// Profile 2.
    P2,
    /// Profile 3.
    P3,
}

impl Profile {
    /// Returns the profile of a wire byte.
    ///
    /// # Errors
    /// `UndefinedProfile` if the byte is above 3.
    pub fn from_byte(byte: u8) -> Result<Self, UndefinedProfile> {
        let all = [Self::P0, Self::P1, Self::P2, Self::P3];
        let profile = all.get(usize::from(byte));
        profile.copied().ok_or(UndefinedProfile(byte))
    }

    /// Returns the wire byte of this profile.
    #[must_use]
    pub fn byte(self) -> u8 {
        self as u8
    }
}

/// The error for a profile that is not defined. The text is libfranka's. As in libfranka, the
/// client then sends no request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("Vacuum Gripper: Vacuum profile not defined!")]
pub struct UndefinedProfile(pub u8);

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Connect => "Connect",
            Self::Vacuum => "Vacuum",
            Self::DropOff => "Drop Off",
            Self::Stop => "Stop",
        })
    }
}

impl ServiceCommand for Command {
    const CONNECT: Self = Self::Connect;
    const SERVICE: &'static str = "libfranka vacuum gripper";
}

impl sealed::Sealed for Version {}

impl EndEffector for Version {
    type Command = Command;
    type Request = Request;

    const NUMBER: &'static [u16; 1] = &[1];
    const COMMANDS: &'static [Command] = &[
        Command::Connect,
        Command::Vacuum,
        Command::DropOff,
        Command::Stop,
    ];
    const DEVICE: &'static str = "vacuum gripper";

    fn hello(version: u16, udp_port: u16) -> Request {
        Request::Connect { version, udp_port }
    }

    fn announced(request: &Request) -> Option<(u16, u16)> {
        match *request {
            Request::Connect { version, udp_port } => Some((version, udp_port)),
            _ => None,
        }
    }

    fn command(request: &Request) -> Command {
        match request {
            Request::Connect { .. } => Command::Connect,
            Request::Vacuum(_) => Command::Vacuum,
            Request::DropOff { .. } => Command::DropOff,
            Request::Stop => Command::Stop,
        }
    }

    fn encode(request: &Request, draft: Draft) -> Outgoing {
        match *request {
            Request::Connect { version, udp_port } => draft.handshake(version, udp_port),
            Request::Vacuum(vacuum) => draft.with(&wire::vacuum::Vacuum {
                vacuum: vacuum.vacuum,
                profile: vacuum.profile.byte(),
                timeout: vacuum.timeout.into(),
            }),
            Request::DropOff { timeout } => {
                let timeout = timeout.into();
                draft.with(&wire::vacuum::DropOff { timeout })
            }
            Request::Stop => draft.with(&()),
        }
    }

    fn decode(command: Command, message: &Message<'_>) -> Result<Request, DecodeError<Command>> {
        Ok(match command {
            Command::Connect => {
                let payload: &wire::service::ConnectRequest = payload(message)?;
                Self::hello(payload.version.get(), payload.udp_port.get())
            }
            Command::Vacuum => {
                let payload: &wire::vacuum::Vacuum = payload(message)?;
                let unknown = |UndefinedProfile(byte)| DecodeError::UnknownValue {
                    field: "profile",
                    value: byte.into(),
                };
                Request::Vacuum(Vacuum {
                    vacuum: payload.vacuum,
                    profile: Profile::from_byte(payload.profile).map_err(unknown)?,
                    timeout: payload.timeout.get(),
                })
            }
            Command::DropOff => {
                let payload: &wire::vacuum::DropOff = payload(message)?;
                let timeout = payload.timeout.get();
                Request::DropOff { timeout }
            }
            Command::Stop => Request::Stop,
        })
    }
}
