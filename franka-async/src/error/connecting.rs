//! Errors of connecting.

use std::io;
use std::net::SocketAddr;

#[cfg(feature = "urdf")]
use franka_model::urdf::UrdfError;
use franka_proto::framing::FrameError;
use franka_proto::{IncompatibleVersion, Protocol, Version, Violation};
use franka_rt::driver::{ControlLog, LinkTimeoutError};
use franka_rt::identify::KnownError;
use franka_rt::lifecycle::{CloseReason, Party};
use franka_rt::sched::SchedError;
use franka_rt::session::geometry::RESIDUAL_MAX;
use franka_rt::thread::{LinkFault, StartError};

#[cfg(feature = "urdf")]
use super::CommandError;
use crate::endpoint::EndpointError;

/// Hint for a program that connects to a simulator.
const IGNORE: &str = " (for a simulator: `Realtime::Ignore`, in Python `realtime=\"ignore\"`)";

/// Reason why there is no connection: to a robot, unless `P` names another device. Nothing is left
/// behind, and the program may connect again.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConnectError<P: Protocol = Version> {
    /// Host: the operating system does not grant the requests of real-time control, see
    /// [`Builder::realtime`](crate::connection::Builder::realtime).
    #[error("{}{}", .0, if .0.is_misuse() { "" } else { IGNORE })]
    Realtime(#[from] SchedError),
    /// Caller: the given text is not an endpoint. Nothing was sent.
    #[error(transparent)]
    Endpoint(#[from] EndpointError),
    /// Caller: the silence after which the link counts as lost is out of range, see
    /// [`Builder::link_timeout`](crate::connection::Builder::link_timeout).
    #[error(transparent)]
    LinkTimeout(#[from] LinkTimeoutError),
    /// Caller: the requested log of a motion has more cycles than there is memory for, see
    /// [`Builder::log_size`](crate::connection::Builder::log_size). Nothing was sent.
    #[error(
        "the log has {got} cycles, expected {} at most",
        ControlLog::CAPACITY_MAX
    )]
    LogSize {
        /// Cycles asked for.
        got: usize,
    },
    /// Caller: a function should be asked before recoveries, but no policy supervises the robot.
    /// See [`Builder::ask_before_recovery`](crate::connection::Builder::ask_before_recovery).
    /// Nothing was sent.
    #[error(
        "got ask_before_recovery without supervise, expected both: add supervise with a policy \
         that recovers"
    )]
    Unsupervised,
    /// Caller: the known values are of another kind of robot, or are impossible for an arm. See
    /// [`Builder::known`](crate::connection::Builder::known).
    #[error(transparent)]
    Known(#[from] KnownError),
    /// Host: no thread, socket or file descriptor is available.
    #[error("cannot set up the connection: {0}")]
    System(#[from] io::Error),
    /// Robot: it accepts no connection. FCI is off, or the address is of another machine.
    #[error(
        "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk. ({address})"
    )]
    Refused {
        /// Address tried.
        address: SocketAddr,
    },
    /// Link: the address did not answer.
    #[error(
        "libfranka: Connection timeout. Please check your network connection or settings. ({address})"
    )]
    Timeout {
        /// Address tried.
        address: SocketAddr,
    },
    /// Link: any other failure to connect.
    #[error("libfranka: Connection error: {reason}")]
    Network {
        /// The class of the failure.
        reason: String,
    },
    /// Robot or link: the host name has several addresses, and connecting to each of them failed.
    #[error("{}", list(.attempts))]
    NoAddress {
        /// Result of each attempt, in the order tried.
        attempts: Vec<Attempt<P>>,
    },
    /// Robot: its system has a protocol version that this driver does not support. Caller: the
    /// requested version is not the robot's, see
    /// [`VersionPolicy`](crate::connection::VersionPolicy). The text names the system and the
    /// remedy, where libfranka's text names versions of libfranka.
    #[error(
        "libfranka: Incompatible library version (server version: {}, library version: {}): {}",
        .0.server_version, .0.library_version.number(), .0.explanation()
    )]
    IncompatibleVersion(IncompatibleVersion<P>),
    /// The connection ended during the handshake. Who can act depends on the reason.
    #[error("{}", closed(.reason))]
    ConnectionClosed {
        /// Cause of the end.
        reason: CloseReason,
    },
    /// Link: a datagram of the robot could not be read.
    #[error("{fault}")]
    Datagram {
        /// Fault of the link.
        fault: LinkFault,
    },
    /// Peer: a message breaks the protocol.
    #[error(transparent)]
    Violation(#[from] Violation<P::Command>),
    /// Peer: the stream cannot be split into messages.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// Link: the handshake was not answered in time.
    #[error("libfranka: TCP receive: Timeout ({address})")]
    HandshakeTimeout {
        /// Address tried.
        address: SocketAddr,
    },
    /// Link: the handshake succeeded and no state came. The usual cause is a firewall that blocks
    /// UDP.
    #[error("libfranka: UDP receive: Timeout ({address})")]
    NoState {
        /// Address where the handshake succeeded.
        address: SocketAddr,
    },
    /// Robot: the poses that it reports are of another geometry than its description, or than the
    /// constants of its kind. That geometry is not a known one. See
    /// [`Builder::accept_geometry_error`](crate::connection::Builder::accept_geometry_error).
    #[error(
        "the robot's pose is {:.1} µm from the pose of its model at the same joint positions, expected {:.0} µm at most: check the address and the robot's description, or connect with accept_geometry_error",
        .residual * 1e6,
        RESIDUAL_MAX * 1e6
    )]
    Geometry {
        /// Distance of the reported pose from the pose of the model, `[m]`, or the largest
        /// difference of an element of the rotation matrices times 0.1 m, whichever is greater.
        residual: f64,
    },
    /// Robot, link or peer: the arm has no model. See
    /// [`Builder::nominal_model`](crate::connection::Builder::nominal_model).
    #[cfg(feature = "urdf")]
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl<P: Protocol> ConnectError<P> {
    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::Realtime(error) => error.entry(),
            Self::Endpoint(error) => error.entry(),
            Self::LinkTimeout(_) => "connect-link-timeout",
            Self::LogSize { .. } => "connect-log-size",
            Self::Unsupervised => "connect-unsupervised",
            Self::Known(_) => "connect-known",
            Self::System(_) => "connect-system",
            Self::Refused { .. } => "connect-refused",
            Self::Timeout { .. } => "connect-timeout",
            Self::Network { .. } => "connect-network",
            Self::NoAddress { .. } => "connect-no-address",
            Self::IncompatibleVersion(_) => "connect-incompatible-version",
            Self::ConnectionClosed { reason } if likely_taken(reason) => "closed-by-peer",
            Self::ConnectionClosed { reason } => reason.entry(),
            Self::Datagram { .. } => "connect-datagram",
            Self::Violation(_) => "connect-violation",
            Self::Frame(_) => "connect-frame",
            Self::HandshakeTimeout { .. } => "connect-handshake-timeout",
            Self::NoState { .. } => "connect-no-state",
            Self::Geometry { .. } => "connect-geometry",
            #[cfg(feature = "urdf")]
            Self::Model(error) => error.entry(),
        }
    }

    /// Returns the party that can act on this error.
    pub fn party(&self) -> Party {
        match self {
            Self::Endpoint(_)
            | Self::LinkTimeout(_)
            | Self::LogSize { .. }
            | Self::Unsupervised
            | Self::Known(_) => Party::Caller,
            // A device that refuses exists; the other addresses may not.
            Self::NoAddress { attempts } => attempts
                .iter()
                .map(|attempt| attempt.error.party())
                .find(|party| *party == Party::Robot)
                .unwrap_or(Party::Link),
            Self::Realtime(error) if error.is_misuse() => Party::Caller,
            Self::Realtime(_) | Self::System(_) => Party::Host,
            Self::Refused { .. } | Self::Geometry { .. } => Party::Robot,
            Self::Timeout { .. }
            | Self::Network { .. }
            | Self::Datagram { .. }
            | Self::HandshakeTimeout { .. }
            | Self::NoState { .. } => Party::Link,
            Self::ConnectionClosed { reason } => reason.party(),
            Self::IncompatibleVersion(refusal) => {
                match P::spoken().contains(&refusal.server_version) {
                    true => Party::Caller,
                    false => Party::Robot,
                }
            }
            Self::Violation(_) | Self::Frame(_) => Party::Peer,
            #[cfg(feature = "urdf")]
            Self::Model(error) => error.party(),
        }
    }
}

/// One of a host's addresses, and the reason why connecting to it failed.
#[derive(Debug)]
pub struct Attempt<P: Protocol = Version> {
    /// The address.
    pub address: SocketAddr,
    /// Error of the attempt.
    pub error: ConnectError<P>,
}

/// True if the connection ended as a robot ends it that already has a client.
fn likely_taken(reason: &CloseReason) -> bool {
    matches!(
        reason,
        CloseReason::ClosedByPeer
            | CloseReason::Io {
                kind: io::ErrorKind::ConnectionReset,
                ..
            }
    )
}

fn closed(reason: &CloseReason) -> String {
    if likely_taken(reason) {
        return format!(
            "the connection was closed before the first answer: another client may be connected, \
             or the address belongs to another device ({reason})"
        );
    }
    reason.to_string()
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
            // The enum is open; every other obstacle to starting the thread is a fault of the host.
            other => Self::System(io::Error::other(other)),
        }
    }
}

/// Written by hand: the refusal is not an error source, because its own text is libfranka's.
impl<P: Protocol> From<IncompatibleVersion<P>> for ConnectError<P> {
    fn from(refusal: IncompatibleVersion<P>) -> Self {
        Self::IncompatibleVersion(refusal)
    }
}

impl From<LinkFault> for ConnectError {
    fn from(fault: LinkFault) -> Self {
        Self::Datagram { fault }
    }
}

/// Reason why the connected arm has no model.
/// [`Builder::nominal_model`](crate::connection::Builder::nominal_model) needs no description.
#[cfg(feature = "urdf")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The robot was asked for its description and did not send it.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// Robot: its description does not fit any arm that this driver knows.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
}

#[cfg(feature = "urdf")]
impl ModelError {
    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::Command(error) => error.entry(),
            Self::Urdf(_) => "model-urdf",
        }
    }

    /// Returns the party that can act on this error.
    pub fn party(&self) -> Party {
        match self {
            Self::Command(error) => error.party(),
            Self::Urdf(_) => Party::Peer,
        }
    }
}

#[cfg(all(test, feature = "urdf"))]
mod tests {
    use franka_model::Model;

    use super::*;
    use crate::error::any::Error;

    #[test]
    fn a_description_that_cannot_be_read_is_the_peers_fault() {
        let error = Model::from_urdf("<sdf/>").expect_err("no description");
        let text = error.to_string();
        let error: ConnectError = ModelError::from(error).into();
        let error = Error::from(error);
        assert_eq!((error.to_string(), error.party()), (text, Party::Peer));
    }
}
