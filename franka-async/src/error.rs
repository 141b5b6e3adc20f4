//! What can go wrong, grouped by who can act on it. Texts are those of the reference client where
//! it has one.

use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use franka_proto::framing::FrameError;
use franka_proto::gripper::{self, Failure};
use franka_proto::{
    Command, IncompatibleVersion, Protocol, Refusal, RequestError, ServiceCommand, Version,
    Violation, vacuum,
};
use franka_rt::driver::LinkTimeoutError;
use franka_rt::sched::SchedError;
use franka_rt::thread::{LinkFault, StartError};

pub use crate::active::ActiveError;
pub use crate::endpoint::EndpointError;
pub use crate::reading::ReadError;

pub use franka_rt::lifecycle::{ControlError, MotionError, Party};
pub use franka_rt::session::GoalError;

/// Anything that can go wrong with a robot or its end effectors: what a program with many kinds of
/// calls returns. Every error of this crate converts into it, so that `?` does, and `Display` is
/// that of the error inside.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no connection to the robot.
    #[error(transparent)]
    Connect(#[from] ConnectError),
    /// A command other than a motion was not carried out.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// The robot ended a motion: a reflex, a stop. The error has the log of the motion's last
    /// cycles.
    #[error(transparent)]
    Control(Box<ControlError>),
    /// A motion ended short of its goal for another reason.
    #[error(transparent)]
    Motion(MotionError),
    /// Active control could not go on.
    #[error(transparent)]
    Active(ActiveError),
    /// States could not be read any further.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// There is no connection to the Franka Hand.
    #[error(transparent)]
    ConnectGripper(#[from] ConnectError<gripper::Version>),
    /// The Franka Hand did not do it.
    #[error(transparent)]
    Gripper(#[from] ActionError<gripper::Command>),
    /// There is no connection to the vacuum gripper.
    #[error(transparent)]
    ConnectVacuumGripper(#[from] ConnectError<vacuum::Version>),
    /// The vacuum gripper did not do it.
    #[error(transparent)]
    VacuumGripper(#[from] ActionError<vacuum::Command>),
    /// The robot's model library cannot be used.
    #[cfg(all(feature = "model-library", target_os = "linux"))]
    #[error(transparent)]
    ModelLibrary(#[from] crate::ModelLibraryError),
}

impl From<MotionError> for Error {
    fn from(error: MotionError) -> Self {
        match error {
            MotionError::Control(error) => Self::Control(error),
            other => Self::Motion(other),
        }
    }
}

impl From<ActiveError> for Error {
    fn from(error: ActiveError) -> Self {
        match error {
            ActiveError::Motion(error) => error.into(),
            other => Self::Active(other),
        }
    }
}

impl Error {
    /// Who can act on it.
    pub fn party(&self) -> Party {
        match self {
            Self::Connect(error) => error.party(),
            Self::Command(error) => error.party(),
            Self::Control(_) => Party::Robot,
            Self::Motion(error) => error.party(),
            Self::Active(error) => error.party(),
            Self::Read(error) => error.party(),
            Self::ConnectGripper(error) => error.party(),
            Self::Gripper(error) => error.party(),
            Self::ConnectVacuumGripper(error) => error.party(),
            Self::VacuumGripper(error) => error.party(),
            #[cfg(all(feature = "model-library", target_os = "linux"))]
            Self::ModelLibrary(error) => error.party(),
        }
    }
}

/// Why there is no connection: to a robot, unless `P` says otherwise. Nothing is left behind;
/// connecting again is always possible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConnectError<P: Protocol = Version> {
    /// Host: it does not grant what real-time control needs, see
    /// [`Builder::realtime`](crate::Builder::realtime).
    #[error(transparent)]
    Realtime(#[from] SchedError),
    /// Caller: the text that was given as the place of the device names none. Nothing was sent.
    #[error(transparent)]
    Endpoint(#[from] EndpointError),
    /// Caller: the silence after which the link counts as lost is out of range, see
    /// [`Builder::link_timeout`](crate::Builder::link_timeout).
    #[error(transparent)]
    LinkTimeout(#[from] LinkTimeoutError),
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
    /// Robot or link: the host name has several addresses, and there is no connection to any of
    /// them.
    #[error("{}", list(.attempts))]
    NoAddress {
        /// What came of each, in the order tried.
        attempts: Vec<Attempt<P>>,
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
    /// Link: the handshake succeeded and no state came. A firewall in the way of UDP is the usual
    /// cause.
    #[error("libfranka: UDP receive: Timeout")]
    NoState,
    /// Robot, link or peer: there is no model of the arm. See
    /// [`Builder::nominal_model`](crate::Builder::nominal_model).
    #[cfg(feature = "urdf")]
    #[error(transparent)]
    Model(#[from] crate::ModelError),
}

impl<P: Protocol> ConnectError<P> {
    /// Who can act on it.
    pub fn party(&self) -> Party {
        match self {
            Self::Endpoint(_) | Self::LinkTimeout(_) => Party::Caller,
            // One that refuses is there, the others need not be.
            Self::NoAddress { attempts } => attempts
                .iter()
                .map(|attempt| attempt.error.party())
                .find(|party| *party == Party::Robot)
                .unwrap_or(Party::Link),
            Self::Realtime(error) if error.is_misuse() => Party::Caller,
            Self::Realtime(_) | Self::System(_) => Party::Host,
            Self::Refused => Party::Robot,
            Self::Timeout
            | Self::Network { .. }
            | Self::Link { .. }
            | Self::HandshakeTimeout
            | Self::NoState => Party::Link,
            Self::IncompatibleVersion(_) | Self::Violation(_) | Self::Frame(_) => Party::Peer,
            #[cfg(feature = "urdf")]
            Self::Model(error) => error.party(),
        }
    }
}

/// One of a host's addresses, and why there is no connection to it.
#[derive(Debug)]
pub struct Attempt<P: Protocol = Version> {
    /// The address.
    pub address: SocketAddr,
    /// What went wrong.
    pub error: ConnectError<P>,
}

fn list<P: Protocol>(attempts: &[Attempt<P>]) -> String {
    let lines = attempts
        .iter()
        .map(|Attempt { address, error }| format!("{address}: {error}"));
    lines.collect::<Vec<_>>().join("; ")
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

impl CommandError {
    /// Who can act on it.
    pub fn party(&self) -> Party {
        match self {
            Self::Refused(_) => Party::Robot,
            Self::Request(_) => Party::Caller,
            Self::Timeout { .. } | Self::ConnectionClosed { .. } => Party::Link,
            Self::Violation(_) => Party::Peer,
        }
    }
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

impl<C: ServiceCommand> ActionError<C> {
    /// Who can act on it.
    pub fn party(&self) -> Party {
        match self {
            Self::Failure(_) => Party::Robot,
            Self::Request(_) => Party::Caller,
            Self::Violation(_) => Party::Peer,
            Self::ConnectionClosed { .. } => Party::Link,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_converts_and_keeps_its_text_and_party() {
        fn check(error: impl Into<Error>, text: &str, party: Party) {
            let error = error.into();
            assert_eq!(error.to_string(), text);
            assert_eq!(error.party(), party, "{error:?}");
        }
        check(
            ConnectError::<Version>::Refused,
            "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk.",
            Party::Robot,
        );
        check(
            ConnectError::<gripper::Version>::HandshakeTimeout,
            "libfranka: TCP receive: Timeout",
            Party::Link,
        );
        check(
            MotionError::Superseded,
            "superseded by a newer goal",
            Party::Caller,
        );
        let reason = String::from("libfranka: server closed connection");
        check(
            CommandError::ConnectionClosed {
                reason: reason.clone(),
            },
            &reason,
            Party::Link,
        );
        check(
            ActionError::<vacuum::Command>::ConnectionClosed {
                reason: reason.clone(),
            },
            &reason,
            Party::Link,
        );
        check(
            ReadError::ConnectionClosed {
                reason: reason.clone(),
            },
            &reason,
            Party::Link,
        );
        let what = "nothing";
        check(MotionError::Protocol { what }, what, Party::Peer);
    }
}
