//! Errors of connecting. A second client gets `ConnectionClosed`; see `is_second_client`.

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
use super::{CommandError, Row};
use crate::endpoint::EndpointError;

/// Hint for a program that connects to a simulator.
const IGNORE: &str =
    " (for a simulator, use `Realtime::Ignore`, or in Python `realtime=\"ignore\"`)";

/// Reason why a connection to a device failed. `P` is the protocol of the device: by default, of a
/// robot. Everything that was opened is closed again, and the program may retry.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConnectError<P: Protocol = Version> {
    /// Host: the control thread cannot run in real time, see
    /// [`Builder::realtime`](crate::connection::Builder::realtime).
    #[error("{}{}", .0, if .0.is_misuse() { "" } else { IGNORE })]
    Realtime(#[from] SchedError),
    /// Caller: the given text is not an endpoint. Nothing was sent.
    #[error(transparent)]
    Endpoint(#[from] EndpointError),
    /// Caller: the link timeout is out of range, see
    /// [`Builder::link_timeout`](crate::connection::Builder::link_timeout).
    #[error(transparent)]
    LinkTimeout(#[from] LinkTimeoutError),
    /// Caller: the requested log of a motion has too many cycles, see
    /// [`Builder::log_size`](crate::connection::Builder::log_size). Nothing was sent.
    #[error(
        "the log has {got} cycles, expected {} at most",
        ControlLog::CAPACITY_MAX
    )]
    LogSize {
        /// Number of cycles that was requested.
        got: usize,
    },
    /// Caller: a function should be asked before each recovery, but no policy supervises the robot.
    /// See [`Builder::ask_before_recovery`](crate::connection::Builder::ask_before_recovery).
    /// Nothing was sent.
    #[error(
        "got ask_before_recovery without supervise, expected both: add supervise with a policy \
         that recovers"
    )]
    Unsupervised,
    /// Caller: the known values belong to a different kind of robot, or are impossible for an arm.
    /// See [`Builder::known`](crate::connection::Builder::known).
    #[error(transparent)]
    Known(#[from] KnownError),
    /// Host: no thread, socket or file descriptor is available.
    #[error("cannot set up the connection: {0}")]
    System(#[from] io::Error),
    /// Robot: it refuses the connection. FCI is off, or the address belongs to a different machine.
    #[error(
        "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk. ({address})"
    )]
    Refused {
        /// The address that was tried.
        address: SocketAddr,
    },
    /// Link: the address did not answer.
    #[error(
        "libfranka: Connection timeout. Please check your network connection or settings. ({address})"
    )]
    Timeout {
        /// The address that was tried.
        address: SocketAddr,
    },
    /// Link: connecting failed in any other way.
    #[error("libfranka: Connection error: {reason}")]
    Network {
        /// Kind of failure.
        reason: String,
    },
    /// Robot or link: the host name has several addresses, and connecting failed for each of them.
    #[error("{}", list(.attempts))]
    NoAddress {
        /// Result of each attempt, in the order in which the addresses were tried.
        attempts: Vec<Attempt<P>>,
    },
    /// Robot: its system uses a protocol version that this driver does not support. Caller: the
    /// requested version is not the version of the robot, see
    /// [`VersionPolicy`](crate::connection::VersionPolicy). The text names the robot's system and
    /// the remedy, while libfranka's text names versions of libfranka.
    #[error(
        "libfranka: Incompatible library version (server version: {}, library version: {}): {}",
        .0.server_version, .0.library_version.number(), .0.explanation()
    )]
    IncompatibleVersion(IncompatibleVersion<P>),
    /// The connection ended during the handshake. Who can act depends on the reason.
    #[error("{}", closed(.reason))]
    ConnectionClosed {
        /// Reason why the connection ended.
        reason: CloseReason,
    },
    /// Link: a datagram from the robot could not be read.
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
        /// The address that was tried.
        address: SocketAddr,
    },
    /// Link: the handshake succeeded, but no state came. The usual cause is a firewall that blocks
    /// UDP.
    #[error("libfranka: UDP receive: Timeout ({address})")]
    NoState {
        /// The address at which the handshake succeeded.
        address: SocketAddr,
    },
    /// Robot: its reported poses do not fit the geometry in its description, or in the constants of
    /// its kind. They do not fit any other known geometry either. See
    /// [`Builder::accept_geometry_error`](crate::connection::Builder::accept_geometry_error).
    #[error(
        "the robot's pose is {:.1} µm from the pose of its model at the same joint positions, expected {:.0} µm at most: check the address and the robot's description, or connect with accept_geometry_error",
        .residual * 1e6,
        RESIDUAL_MAX * 1e6
    )]
    Geometry {
        /// Distance of the reported pose from the pose of the model, `[m]`, or the largest
        /// difference between elements of their rotation matrices times 0.1 m, whichever is
        /// greater.
        residual: f64,
    },
    /// Robot, link or peer: the driver has no model of the arm. See
    /// [`Builder::nominal_model`](crate::connection::Builder::nominal_model).
    #[cfg(feature = "urdf")]
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl<P: Protocol> ConnectError<P> {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Realtime(error) if error.is_misuse() => (error.entry(), Party::Caller),
            Self::Realtime(error) => (error.entry(), Party::Host),
            Self::Endpoint(error) => (error.entry(), Party::Caller),
            Self::LinkTimeout(_) => ("connect-link-timeout", Party::Caller),
            Self::LogSize { .. } => ("connect-log-size", Party::Caller),
            Self::Unsupervised => ("connect-unsupervised", Party::Caller),
            Self::Known(_) => ("connect-known", Party::Caller),
            Self::System(_) => ("connect-system", Party::Host),
            Self::Refused { .. } => ("connect-refused", Party::Robot),
            Self::Timeout { .. } => ("connect-timeout", Party::Link),
            Self::Network { .. } => ("connect-network", Party::Link),
            Self::NoAddress { attempts } => {
                let mut parties = attempts.iter().map(|attempt| attempt.error.party());
                // A device that refuses exists, while the devices of the other addresses may not.
                let party = parties.find(|party| *party == Party::Robot);
                ("connect-no-address", party.unwrap_or(Party::Link))
            }
            Self::IncompatibleVersion(refusal) => {
                let party = match P::spoken().contains(&refusal.server_version) {
                    true => Party::Caller,
                    false => Party::Robot,
                };
                ("connect-incompatible-version", party)
            }
            Self::ConnectionClosed { reason } if is_second_client(reason) => {
                ("closed-by-peer", reason.party())
            }
            Self::ConnectionClosed { reason } => (reason.entry(), reason.party()),
            Self::Datagram { .. } => ("connect-datagram", Party::Link),
            Self::Violation(_) => ("connect-violation", Party::Peer),
            Self::Frame(_) => ("connect-frame", Party::Peer),
            Self::HandshakeTimeout { .. } => ("connect-handshake-timeout", Party::Link),
            Self::NoState { .. } => ("connect-no-state", Party::Link),
            Self::Geometry { .. } => ("connect-geometry", Party::Robot),
            #[cfg(feature = "urdf")]
            Self::Model(error) => error.row(),
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

/// True if the connection ended as it does if the robot already has a client.
fn is_second_client(reason: &CloseReason) -> bool {
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
    if is_second_client(reason) {
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
            // The enum is non-exhaustive; every other obstacle to starting the thread is a fault of
            // the host.
            other => Self::System(io::Error::other(other)),
        }
    }
}

/// Written by hand, because the refusal must not be an error source: its own text is libfranka's.
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

/// Reason why the driver has no model of the connected arm.
/// [`Builder::nominal_model`](crate::connection::Builder::nominal_model) needs no description.
#[cfg(feature = "urdf")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The robot did not send its description when asked for it.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// Robot: its description does not fit any arm that this driver knows.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
}

#[cfg(feature = "urdf")]
impl ModelError {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Command(error) => error.row(),
            Self::Urdf(_) => ("model-urdf", Party::Peer),
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
