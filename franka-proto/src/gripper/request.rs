//! The requests to the Hand.

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

/// The commands of the Hand. The Hand replies once to each command, after the action has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Opens a session.
    Connect,
    /// Opens and closes the fingers to find their range.
    Homing,
    /// Closes or opens the fingers to grasp an object.
    Grasp,
    /// Moves the fingers to a width.
    Move,
    /// Stops the fingers.
    Stop,
}

/// A request with its parameters. The Hand, not this crate, checks the ranges of the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Request {
    /// Opens a session.
    Connect {
        /// Protocol version of the client.
        version: u16,
        /// UDP port of the client.
        udp_port: u16,
    },
    /// Opens and closes the fingers to find their range. The Hand requires homing after a change of
    /// fingers.
    Homing,
    /// Grasps an object.
    Grasp(Grasp),
    /// Moves the fingers.
    Move(Move),
    /// Stops the fingers. The Hand replies to the current action with the status "aborted".
    Stop,
}

/// The parameters of a grasp. An object counts as grasped if the final distance `d` of the fingers
/// satisfies `width - epsilon_inner < d < width + epsilon_outer`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Grasp {
    /// Width of the object `[m]`.
    pub width: f64,
    /// Tolerance below the width of the object `[m]`.
    pub epsilon_inner: f64,
    /// Tolerance above the width of the object `[m]`.
    pub epsilon_outer: f64,
    /// Speed of the fingers `[m/s]`.
    pub speed: f64,
    /// Force of the grasp `[N]`.
    pub force: f64,
}

impl Grasp {
    /// libfranka's default for both tolerances `[m]`.
    pub const EPSILON: f64 = 0.005;

    /// Creates a grasp with libfranka's tolerances: width `[m]`, speed `[m/s]`, force `[N]`.
    #[must_use]
    pub fn new(width: f64, speed: f64, force: f64) -> Self {
        Self {
            width,
            epsilon_inner: Self::EPSILON,
            epsilon_outer: Self::EPSILON,
            speed,
            force,
        }
    }
}

/// The parameters of a finger motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Move {
    /// Target distance of the fingers `[m]`.
    pub width: f64,
    /// Speed of the fingers `[m/s]`.
    pub speed: f64,
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Connect => "Connect",
            Self::Homing => "Homing",
            Self::Grasp => "Grasp",
            Self::Move => "Move",
            Self::Stop => "Stop",
        })
    }
}

impl ServiceCommand for Command {
    const CONNECT: Self = Self::Connect;
    const SERVICE: &'static str = "libfranka gripper";
}

impl sealed::Sealed for Version {}

impl EndEffector for Version {
    type Command = Command;
    type Request = Request;

    const NUMBER: &'static [u16; 1] = &[3];
    const COMMANDS: &'static [Command] = &[
        Command::Connect,
        Command::Homing,
        Command::Grasp,
        Command::Move,
        Command::Stop,
    ];
    const DEVICE: &'static str = "Franka Hand";

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
            Request::Homing => Command::Homing,
            Request::Grasp(_) => Command::Grasp,
            Request::Move(_) => Command::Move,
            Request::Stop => Command::Stop,
        }
    }

    fn encode(request: &Request, draft: Draft) -> Outgoing {
        match *request {
            Request::Connect { version, udp_port } => draft.handshake(version, udp_port),
            Request::Homing | Request::Stop => draft.with(&()),
            Request::Grasp(grasp) => draft.with(&wire::gripper::Grasp {
                width: grasp.width.into(),
                epsilon: wire::gripper::GraspEpsilon {
                    inner: grasp.epsilon_inner.into(),
                    outer: grasp.epsilon_outer.into(),
                },
                speed: grasp.speed.into(),
                force: grasp.force.into(),
            }),
            Request::Move(motion) => draft.with(&wire::gripper::Move {
                width: motion.width.into(),
                speed: motion.speed.into(),
            }),
        }
    }

    fn decode(command: Command, message: &Message<'_>) -> Result<Request, DecodeError<Command>> {
        Ok(match command {
            Command::Connect => {
                let payload: &wire::service::ConnectRequest = payload(message)?;
                Self::hello(payload.version.get(), payload.udp_port.get())
            }
            Command::Homing => Request::Homing,
            Command::Grasp => {
                let payload: &wire::gripper::Grasp = payload(message)?;
                Request::Grasp(Grasp {
                    width: payload.width.get(),
                    epsilon_inner: payload.epsilon.inner.get(),
                    epsilon_outer: payload.epsilon.outer.get(),
                    speed: payload.speed.get(),
                    force: payload.force.get(),
                })
            }
            Command::Move => {
                let payload: &wire::gripper::Move = payload(message)?;
                Request::Move(Move {
                    width: payload.width.get(),
                    speed: payload.speed.get(),
                })
            }
            Command::Stop => Request::Stop,
        })
    }
}
