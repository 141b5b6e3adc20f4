//! One error type that can hold the error of any call.

use franka_proto::{gripper, vacuum};
use franka_rt::lifecycle::{ControlError, MotionError, Party};

#[cfg(all(feature = "model-library", target_os = "linux"))]
use super::ModelLibraryError;
use super::{
    ActionError, ActiveError, CommandError, ConnectError, IdentifyError, ReadError, Row, TareError,
};

/// Any error of a robot or its end effectors. Every error of this crate converts into it, for
/// example through `?`, and `Display` prints the error inside.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no connection to the robot.
    #[error(transparent)]
    Connect(#[from] ConnectError),
    /// A command other than a motion was not carried out.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// The robot ended a motion by a reflex or a stop. The error contains the log of the motion's
    /// last cycles.
    #[error(transparent)]
    Control(Box<ControlError>),
    /// A motion ended short of its goal for any other reason.
    #[error(transparent)]
    Motion(MotionError),
    /// Active control could not continue.
    #[error(transparent)]
    Active(ActiveError),
    /// The identification of an arm failed, but not because of a motion.
    #[error(transparent)]
    Identify(IdentifyError),
    /// No more states could be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The tare failed, but not because of a lost link.
    #[error(transparent)]
    Tare(TareError),
    /// There is no connection to the Franka Hand.
    #[error(transparent)]
    ConnectGripper(#[from] ConnectError<gripper::Version>),
    /// The Franka Hand did not carry out an action.
    #[error(transparent)]
    Gripper(#[from] ActionError<gripper::Command>),
    /// There is no connection to the vacuum gripper.
    #[error(transparent)]
    ConnectVacuumGripper(#[from] ConnectError<vacuum::Version>),
    /// The vacuum gripper did not carry out an action.
    #[error(transparent)]
    VacuumGripper(#[from] ActionError<vacuum::Command>),
    /// The robot's model library cannot be used.
    #[cfg(all(feature = "model-library", target_os = "linux"))]
    #[error(transparent)]
    ModelLibrary(#[from] ModelLibraryError),
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

impl From<IdentifyError> for Error {
    fn from(error: IdentifyError) -> Self {
        match error {
            IdentifyError::Motion(error) => error.into(),
            other => Self::Identify(other),
        }
    }
}

impl From<TareError> for Error {
    fn from(error: TareError) -> Self {
        match error {
            TareError::Read(error) => error.into(),
            other => Self::Tare(other),
        }
    }
}

impl Error {
    /// Returns the name of this error's row in the book's `errors.md`, which explains what to do.
    /// Every error of a call has a row.
    ///
    /// ```
    /// # use franka_async::{Error, MotionError};
    /// let error = Error::from(MotionError::Superseded);
    /// assert_eq!(
    ///     format!("{error} (errors.md#{})", error.entry()),
    ///     "superseded by a newer goal (errors.md#motion-superseded)",
    /// );
    /// ```
    pub fn entry(&self) -> &'static str {
        self.row().0
    }

    /// Returns the party that can act on this error.
    pub fn party(&self) -> Party {
        self.row().1
    }

    fn row(&self) -> Row {
        match self {
            Self::Connect(error) => error.row(),
            Self::Command(error) => error.row(),
            Self::Control(error) => (error.entry(), Party::Robot),
            Self::Motion(error) => (error.entry(), error.party()),
            Self::Active(error) => error.row(),
            Self::Identify(error) => error.row(),
            Self::Read(error) => error.row(),
            Self::Tare(error) => error.row(),
            Self::ConnectGripper(error) => error.row(),
            Self::Gripper(error) => error.row(),
            Self::ConnectVacuumGripper(error) => error.row(),
            Self::VacuumGripper(error) => error.row(),
            #[cfg(all(feature = "model-library", target_os = "linux"))]
            Self::ModelLibrary(error) => error.row(),
        }
    }
}

#[cfg(test)]
mod tests {
    use franka_proto::Version;
    use franka_rt::lifecycle::CloseReason;

    use super::*;
    use crate::error::VacuumGripperError;

    #[test]
    fn every_error_converts_and_keeps_its_text_and_party() {
        fn check(error: impl Into<Error>, text: &str, party: Party) {
            let error = error.into();
            assert_eq!(error.to_string(), text);
            assert_eq!(error.party(), party, "{error:?}");
        }
        check(
            ConnectError::<Version>::Refused {
                address: ([172, 16, 0, 2], 1337).into(),
            },
            "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk. (172.16.0.2:1337)",
            Party::Robot,
        );
        check(
            ConnectError::<gripper::Version>::HandshakeTimeout {
                address: ([172, 16, 0, 2], 1338).into(),
            },
            "libfranka: TCP receive: Timeout (172.16.0.2:1338)",
            Party::Link,
        );
        check(
            MotionError::Superseded,
            "superseded by a newer goal",
            Party::Caller,
        );
        check(
            IdentifyError::from(MotionError::Superseded),
            "superseded by a newer goal",
            Party::Caller,
        );
        check(
            IdentifyError::Moved {
                joint: 2,
                got: 0.1,
                expected: -0.5,
            },
            "joint 2 is at 0.100 rad, expected -0.500 rad, the start of the planned motions: move \
             the arm back, or plan again",
            Party::Caller,
        );
        let reason = CloseReason::ClosedByPeer;
        let text = "libfranka: server closed connection";
        check(
            CommandError::ConnectionClosed {
                reason: reason.clone(),
            },
            text,
            Party::Link,
        );
        check(
            VacuumGripperError::ConnectionClosed {
                reason: reason.clone(),
            },
            text,
            Party::Link,
        );
        check(ReadError::ConnectionClosed { reason }, text, Party::Link);
        let what = "nothing";
        check(MotionError::Protocol { what }, what, Party::Peer);
    }
}
