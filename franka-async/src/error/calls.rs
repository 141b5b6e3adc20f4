//! Errors of calls on a connection.

use std::time::Duration;

#[cfg(all(feature = "model-library", target_os = "linux"))]
use franka_model::model_library::LibraryError;
use franka_proto::gripper::Failure;
use franka_proto::{Command, Refusal, RequestError, ServiceCommand, Violation};
use franka_rt::identify::FitError;
use franka_rt::lifecycle::{CloseReason, MotionError, Party};
use franka_rt::tare::TareRefused;
use franka_rt::thread::{BorrowError, WriteFault};

use super::Row;

/// Reason why a command other than a motion was not carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// Robot: it refused the command, or did not complete it.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// Caller: the robot does not accept a number. Nothing has changed. This is also the error for
    /// a load that is impossible for a rigid body. Such a load is not sent.
    #[error("{refusal} ({why})")]
    InvalidArgument {
        /// The robot's answer, or the answer that the robot would have given.
        refusal: Refusal,
        /// The value that was given, and the documented range.
        why: String,
    },
    /// Caller: the protocol version does not have this command. Nothing was sent.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// Caller: a number is not finite. Nothing was sent.
    #[error("number {number} of {what} is not finite")]
    NotFinite {
        /// Name of the argument that contains the number.
        what: &'static str,
        /// Position of the number in the argument, counted from 1.
        number: usize,
    },
    /// Robot or link: no answer came in time. The robot may still carry out the command.
    #[error("no answer to {command} within {} ms", .deadline.as_millis())]
    Timeout {
        /// Command without an answer.
        command: Command,
        /// Time for which the driver waited for the answer.
        deadline: Duration,
    },
    /// Link: the robot sends no states. It is unknown whether the command was carried out.
    #[error("no robot state for {} ms: the robot may have carried out the command, so check its \
        state when states arrive again", .silence.as_millis())]
    LinkLost {
        /// Time for which the robot has been silent so far.
        silence: Duration,
    },
    /// Peer: the robot's answer cannot be read.
    #[error(transparent)]
    Violation(#[from] Violation),
    /// The connection has ended. Who can act depends on the reason.
    #[error("{reason}")]
    ConnectionClosed {
        /// Reason why the connection ended.
        reason: CloseReason,
    },
}

impl CommandError {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Refused(refusal) => (refusal.entry(), Party::Robot),
            Self::InvalidArgument { refusal, .. } => (refusal.entry(), Party::Caller),
            Self::Request(_) => ("command-request", Party::Caller),
            Self::NotFinite { .. } => ("command-not-finite", Party::Caller),
            Self::Timeout { .. } => ("command-timeout", Party::Link),
            Self::LinkLost { .. } => ("command-link-lost", Party::Link),
            Self::Violation(_) => ("command-violation", Party::Peer),
            Self::ConnectionClosed { reason } => (reason.entry(), reason.party()),
        }
    }
}

/// Reason why an action of an end effector returned neither true nor false; `C` is the command type
/// of the end effector.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ActionError<C: ServiceCommand> {
    /// Device: the action failed, or was ended by a stop or a newer action.
    #[error(transparent)]
    Failure(#[from] Failure<C>),
    /// Caller: the request is out of the range of the device.
    #[error("{failure} ({why})")]
    OutOfRange {
        /// Answer of the device.
        failure: Failure<C>,
        /// The value that was given, and the possible range.
        why: String,
    },
    /// Caller: too many requests wait for their answers. Nothing was sent.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// Peer: the device's answer cannot be read.
    #[error(transparent)]
    Violation(#[from] Violation<C>),
    /// The connection has ended. Who can act depends on the reason.
    #[error("{reason}")]
    ConnectionClosed {
        /// Reason why the connection ended.
        reason: CloseReason,
    },
}

impl<C: ServiceCommand> ActionError<C> {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Failure(_) => ("action-failure", Party::Robot),
            Self::OutOfRange { .. } => ("action-out-of-range", Party::Caller),
            Self::Request(_) => ("action-request", Party::Caller),
            Self::Violation(_) => ("action-violation", Party::Peer),
            Self::ConnectionClosed { reason } => (reason.entry(), reason.party()),
        }
    }
}

/// Reason why no more states could be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Link: the robot has stopped sending states. The text begins as in libfranka.
    #[error("libfranka: UDP receive: Timeout (no robot state for {} ms)", .silence.as_millis())]
    LinkLost {
        /// Time for which the robot has been silent so far.
        silence: Duration,
    },
    /// The connection has ended. Who can act depends on the reason.
    #[error("{reason}")]
    ConnectionClosed {
        /// Reason why the connection ended.
        reason: CloseReason,
    },
}

impl ReadError {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::LinkLost { .. } => ("read-link-lost", Party::Link),
            Self::ConnectionClosed { reason } => (reason.entry(), reason.party()),
        }
    }
}

/// Reason why a state could not be read or a command could not be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ActiveError {
    /// The motion has ended with this error.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The motion has ended, but not as the program asked. An earlier call has returned the same
    /// error.
    #[error("the motion has ended{}: {}", if needs_recovery(.0) { RECOVER } else { "" }, .0)]
    Ended(MotionError),
    /// The motion has ended as asked, because the last command was written earlier.
    #[error("the motion has finished and accepts no more reads or commands: begin a new motion")]
    Finished,
    /// The command was not sent; the motion continues.
    #[error(transparent)]
    Write(#[from] WriteFault),
    /// The control cycle is not available to this thread.
    #[error(transparent)]
    Borrow(#[from] BorrowError),
}

impl ActiveError {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Motion(error) => (error.entry(), error.party()),
            Self::Ended(_) => ("active-ended", Party::Caller),
            Self::Finished => ("active-finished", Party::Caller),
            Self::Write(WriteFault::Link(_)) => ("active-write", Party::Link),
            Self::Write(_) => ("active-write", Party::Caller),
            Self::Borrow(_) => ("active-borrow", Party::Caller),
        }
    }
}

/// True if the robot stopped itself.
fn needs_recovery(error: &MotionError) -> bool {
    error.control().is_some_and(|error| error.is_reflex())
}

const RECOVER: &str = " (call `recover` before the next motion)";

/// Reason why the identification of an arm failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// Caller: the arm has moved since its motions were planned. The identification did not move
    /// it.
    #[error(
        "joint {joint} is at {got:.3} rad, expected {expected:.3} rad, the start of the planned \
         motions: move the arm back, or plan again"
    )]
    Moved {
        /// The joint, 1 to 7.
        joint: usize,
        /// Present position, `[rad]`.
        got: f64,
        /// Position at the time of planning, `[rad]`.
        expected: f64,
    },
    /// A motion did not arrive. The arm stays where it stopped.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Robot: something held or pushed the arm, so the measured torques cannot be used.
    #[error(transparent)]
    Fit(#[from] FitError),
}

impl IdentifyError {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Moved { .. } => ("identify-moved", Party::Caller),
            Self::Motion(error) => (error.entry(), error.party()),
            Self::Fit(_) => ("identify-fit", Party::Robot),
        }
    }
}

/// Reason why a tare failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TareError {
    /// Caller: the arm moves, is touched or guided, or is near a singularity.
    #[error(transparent)]
    Refused(#[from] TareRefused),
    /// No more states could be read.
    #[error(transparent)]
    Read(#[from] ReadError),
}

impl TareError {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Refused(_) => ("tare-refused", Party::Caller),
            Self::Read(error) => error.row(),
        }
    }
}

/// Reason why the robot's model library cannot be used.
#[cfg(all(feature = "model-library", target_os = "linux"))]
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelLibraryError {
    /// The robot did not send the library.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// The library cannot be loaded.
    #[error(transparent)]
    Library(#[from] LibraryError),
}

#[cfg(all(feature = "model-library", target_os = "linux"))]
impl ModelLibraryError {
    row_accessors!();

    pub(super) fn row(&self) -> Row {
        match self {
            Self::Command(error) => error.row(),
            Self::Library(LibraryError::Load { .. } | LibraryError::Symbol { .. }) => {
                ("library-load", Party::Peer)
            }
            Self::Library(_) => ("library-load", Party::Host),
        }
    }
}

#[cfg(all(test, feature = "model-library", target_os = "linux"))]
mod tests {
    use super::*;
    use crate::error::any::Error;

    #[test]
    fn an_architecture_without_a_library_is_this_computers() {
        let error = Error::from(ModelLibraryError::from(LibraryError::Architecture));
        assert_eq!(error.to_string(), "libfranka: Unsupported architecture!");
        assert_eq!(error.party(), Party::Host);
    }
}
