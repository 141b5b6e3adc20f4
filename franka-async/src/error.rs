//! What can go wrong, grouped by who can act on it. Texts are those of the reference client where it has one.

use std::io;
use std::time::Duration;

use franka_proto::framing::FrameError;
use franka_proto::gripper::Failure;
use franka_proto::{
    Command, IncompatibleVersion, Protocol, Refusal, RequestError, ServiceCommand, Version,
    Violation,
};
use franka_rt::sched::SchedError;
use franka_rt::thread::{LinkFault, StartError};

pub use franka_rt::lifecycle::MotionError;
pub use franka_rt::session::GoalError;

/// Why there is no connection: to a robot, unless `P` says otherwise. Nothing is left behind; connecting again is always
/// possible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConnectError<P: Protocol = Version> {
    /// Host: it does not grant what real-time control needs, see [`Builder::realtime`](crate::Builder::realtime).
    #[error(transparent)]
    Realtime(#[from] SchedError),
    /// Host: no thread, socket or descriptor.
    #[error("the connection cannot be set up: {0}")]
    System(#[from] io::Error),
    /// Robot: nobody listens there. FCI is off, or it is another machine.
    #[error(
        "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk."
    )]
    Refused,
    /// Link: no answer.
    #[error("libfranka: Connection timeout. Please check your network connection or settings.")]
    Timeout,
    /// Link: any other failure to connect.
    #[error("libfranka: Connection error: {reason}")]
    Network {
        /// The class of the failure.
        reason: String,
    },
    /// Peer: it speaks another protocol version.
    #[error(transparent)]
    IncompatibleVersion(#[from] IncompatibleVersion<P>),
    /// Link: the connection ended during the handshake, or a datagram could not be read.
    #[error("{reason}")]
    Link {
        /// What ended it.
        reason: String,
    },
    /// Peer: it left the protocol.
    #[error(transparent)]
    Violation(#[from] Violation<P::Command>),
    /// Peer: its stream cannot be cut into messages.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// Link: the handshake was not answered in time.
    #[error("libfranka: TCP receive: Timeout")]
    HandshakeTimeout,
    /// Link: the handshake succeeded and no state came. A firewall in the way of UDP is the usual cause.
    #[error("libfranka: UDP receive: Timeout")]
    NoState,
}

impl From<StartError> for ConnectError {
    fn from(error: StartError) -> Self {
        match error {
            StartError::Scheduling(error) => Self::Realtime(error),
            StartError::System(error) => Self::System(error),
            // The enum is open; whatever else keeps the thread from starting is the host's doing.
            other => Self::System(io::Error::other(other)),
        }
    }
}

impl From<LinkFault> for ConnectError {
    fn from(fault: LinkFault) -> Self {
        Self::Link {
            reason: fault.to_string(),
        }
    }
}

/// Why a command other than a motion was not carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// Robot: it refused, or gave up.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// Caller: the protocol version has no such command. Nothing was sent.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// Robot or link: no answer in time. The robot may carry the command out all the same.
    #[error("no answer to {command} within {} ms", .deadline.as_millis())]
    Timeout {
        /// What was asked for.
        command: Command,
        /// How long the answer was awaited.
        deadline: Duration,
    },
    /// Peer: its answer cannot be read.
    #[error(transparent)]
    Violation(#[from] Violation),
    /// Link: the connection is gone.
    #[error("{reason}")]
    ConnectionClosed {
        /// What ended it.
        reason: String,
    },
}

/// Why an action of an end effector has no result; `C` is what can be asked of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ActionError<C: ServiceCommand> {
    /// Device: it could not do it, or something ended it: a stop, or a newer action.
    #[error(transparent)]
    Failure(#[from] Failure<C>),
    /// Caller: too many requests wait for their answers. Nothing was sent.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// Peer: its answer cannot be read.
    #[error(transparent)]
    Violation(#[from] Violation<C>),
    /// Link: the connection is gone.
    #[error("{reason}")]
    ConnectionClosed {
        /// What ended it.
        reason: String,
    },
}
