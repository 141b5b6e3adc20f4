//! Reasons for the end of a connection.

use core::time::Duration;
use std::io;

use super::Party;

/// Reason why a connection to a robot or an end effector has ended. If libfranka has an error for
/// the same reason, `Display` prints libfranka's text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CloseReason {
    /// Caller: this program closed the connection, by calling `shutdown`, by cancelling a token, or
    /// by dropping the last handle.
    #[error("this program has closed the connection")]
    ClosedByUs,
    /// Link: the other side closed the connection.
    #[error("libfranka: server closed connection")]
    ClosedByPeer,
    /// Link: sending or receiving failed.
    #[error("{text}")]
    Io {
        /// Kind of the I/O error.
        kind: io::ErrorKind,
        /// Description of the failed operation, in libfranka's words.
        text: String,
    },
    /// Peer: a message violates the protocol in a way that no later message can repair.
    #[error("{text}")]
    Protocol {
        /// Description of the expected and the received value.
        text: String,
    },
    /// Host: the control thread has ended or does not respond.
    #[error("the control thread failed: {text}")]
    ThreadEnded {
        /// Description of what happened to the thread.
        text: String,
    },
    /// Link: the robot sent no states although its connection was still open, so the supervisor
    /// closed the connection.
    #[error("the robot sent no state within the link timeout, and for {} ms after it", .silence.as_millis())]
    Silent {
        /// Time without a state, counted from the end of the link timeout.
        silence: Duration,
    },
    /// Link: the connection was lost, and the supervisor has stopped trying to reconnect.
    #[error("no new connection within {} s, after {attempts} attempts; the last attempt failed: {text}", .after.as_secs())]
    GivenUp {
        /// Number of failed attempts.
        attempts: u32,
        /// Time from the loss of the connection to the end of the attempts.
        after: Duration,
        /// Error of the last attempt.
        text: String,
    },
    /// Robot: after the connection was lost, a different robot answered. Models and goals of the
    /// previous robot are not valid for this robot.
    #[error("another robot answers: {text}")]
    AnotherRobot {
        /// Description of how the robots differ.
        text: String,
    },
    /// Caller: the Tokio runtime that served the connection was shut down.
    #[error("the Tokio runtime that served the connection has ended")]
    RuntimeEnded,
}

impl CloseReason {
    /// True if this program or its runtime closed the connection, so the connection was not lost.
    pub fn is_ours(&self) -> bool {
        matches!(self, Self::ClosedByUs | Self::RuntimeEnded)
    }

    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        self.row().0
    }

    /// Returns the party that can act on this error.
    pub fn party(&self) -> Party {
        self.row().1
    }

    pub(super) fn row(&self) -> (&'static str, Party) {
        match self {
            Self::ClosedByUs => ("closed-by-us", Party::Caller),
            Self::ClosedByPeer => ("closed-by-peer", Party::Link),
            Self::Io { .. } => ("closed-io", Party::Link),
            Self::Protocol { .. } => ("closed-protocol", Party::Peer),
            Self::ThreadEnded { .. } => ("closed-thread-ended", Party::Host),
            Self::Silent { .. } => ("closed-silent", Party::Link),
            Self::GivenUp { .. } => ("closed-given-up", Party::Link),
            Self::AnotherRobot { .. } => ("closed-another-robot", Party::Robot),
            Self::RuntimeEnded => ("closed-runtime-ended", Party::Caller),
        }
    }
}
