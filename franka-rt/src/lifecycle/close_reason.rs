//! Reasons for the end of a connection.

use core::time::Duration;
use std::io;

use super::Party;

/// Reason why a connection to a robot or an end effector has ended. `Display` prints the text of
/// the reference client where that client has the same reason.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CloseReason {
    /// Caller: this program closed the connection: by `shutdown`, a cancelled token, or dropping
    /// the last handle.
    #[error("this program has closed the connection")]
    ClosedByUs,
    /// Link: the other side closed it.
    #[error("libfranka: server closed connection")]
    ClosedByPeer,
    /// Link: sending or receiving failed.
    #[error("{text}")]
    Io {
        /// The class of the failure.
        kind: io::ErrorKind,
        /// Failed operation, in the words of the reference client.
        text: String,
    },
    /// Peer: a message breaks the protocol in a way that no later message can repair.
    #[error("{text}")]
    Protocol {
        /// Expected and received values.
        text: String,
    },
    /// Host: the control thread has ended or does not respond.
    #[error("the control thread failed: {text}")]
    ThreadEnded {
        /// Evidence for this.
        text: String,
    },
    /// Link: the robot sent no states, on a connection that looked alive. Its supervisor closed it.
    #[error("no robot state for {} ms more than the link timeout", .silence.as_millis())]
    Silent {
        /// Length of the silence, from the moment when it was noticed.
        silence: Duration,
    },
    /// Link: the connection was lost, and the supervisor has stopped trying to reconnect.
    #[error("no new connection within {} s, {attempts} attempts; the last one: {text}", .after.as_secs())]
    GivenUp {
        /// Attempts that failed.
        attempts: u32,
        /// Time since the connection was lost.
        after: Duration,
        /// Error of the last attempt.
        text: String,
    },
    /// Robot: after the connection was lost, another robot answered. Models and goals are made for
    /// the previous robot.
    #[error("another robot answers: {text}")]
    AnotherRobot {
        /// Description of the difference.
        text: String,
    },
    /// Caller: the runtime that served the connection was shut down.
    #[error("the Tokio runtime that served the connection has ended")]
    RuntimeEnded,
}

impl CloseReason {
    /// True if this program, or its runtime, has closed the connection: nothing was lost.
    pub fn is_ours(&self) -> bool {
        matches!(self, Self::ClosedByUs | Self::RuntimeEnded)
    }

    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::ClosedByUs => "closed-by-us",
            Self::ClosedByPeer => "closed-by-peer",
            Self::Io { .. } => "closed-io",
            Self::Protocol { .. } => "closed-protocol",
            Self::ThreadEnded { .. } => "closed-thread-ended",
            Self::Silent { .. } => "closed-silent",
            Self::GivenUp { .. } => "closed-given-up",
            Self::AnotherRobot { .. } => "closed-another-robot",
            Self::RuntimeEnded => "closed-runtime-ended",
        }
    }

    /// Returns the party that can act on this error.
    pub fn party(&self) -> Party {
        match self {
            Self::ClosedByUs | Self::RuntimeEnded => Party::Caller,
            Self::ClosedByPeer | Self::Io { .. } | Self::Silent { .. } | Self::GivenUp { .. } => {
                Party::Link
            }
            Self::AnotherRobot { .. } => Party::Robot,
            Self::Protocol { .. } => Party::Peer,
            Self::ThreadEnded { .. } => Party::Host,
        }
    }
}
