//! The ways in which the program ends: exit codes, and errors that state the next step.

use std::fmt;
use std::io;
use std::process::ExitCode;

use franka_async::error::{CommandError, ConnectError, Party};
use franka_async::{Error, MotionError};

/// Result of a command. The numbers are the exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Ending {
    /// The command succeeded.
    Done = 0,
    /// The robot refused the command, or a motion ended before its goal.
    Failed = 1,
    /// The arguments are invalid. The argument parser uses the same code.
    Usage = 2,
    /// The program could not connect to the robot, or the connection was lost.
    NoRobot = 3,
    /// Another client uses the robot.
    Taken = 4,
    /// The user did not confirm the motion.
    NotConfirmed = 5,
    /// This computer has a local problem with rights, files or ports.
    Host = 6,
    /// A person must act, at the user stop or in Desk.
    Person = 7,
    /// Ctrl-C ended the program. Shells use the same code.
    Interrupted = 130,
    /// SIGTERM ended the program. Shells use the same code.
    Terminated = 143,
}

/// The exit codes, for the help and the book.
pub(crate) const TABLE: &str = "\
Exit codes:
    0  done
    1  the robot refused, or the motion ended before its goal (a reflex, an obstacle)
    2  wrong arguments
    3  no connection to the robot, or it was lost
    4  another client is connected to the robot
    5  not confirmed: declined, or no terminal to ask on and no --yes
    6  local problem: missing real-time rights, or a file or port is unavailable
    7  someone must act at the robot: user stop, brakes, Desk
  130  interrupted by Ctrl-C; an arm that moved was braked
  143  ended by SIGTERM; an arm that moved was braked";

impl Ending {
    pub(crate) fn code(self) -> ExitCode {
        ExitCode::from(self as u8)
    }

    /// Returns the name of the ending for JSON output.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Usage => "usage",
            Self::NoRobot => "no_robot",
            Self::Taken => "taken",
            Self::NotConfirmed => "not_confirmed",
            Self::Host => "host",
            Self::Person => "person",
            Self::Interrupted => "interrupted",
            Self::Terminated => "terminated",
        }
    }

    pub(crate) fn of(error: &anyhow::Error) -> Self {
        if let Some(failure) = error.downcast_ref::<Failure>() {
            return failure.ending;
        }
        if let Some((party, _)) = of_driver(error) {
            match party {
                Party::Link => Self::NoRobot,
                Party::Host => Self::Host,
                _ => Self::Failed,
            }
        } else if error.is::<io::Error>() {
            Self::Host
        } else {
            Self::Failed
        }
    }
}

/// Returns who can act on an error of the driver, and the name of the error's row in the book's
/// chapter on errors.
fn of_driver(error: &anyhow::Error) -> Option<(Party, &'static str)> {
    macro_rules! first_of {
        ($($kind:ty),*) => {
            $(if let Some(error) = error.downcast_ref::<$kind>() {
                return Some((error.party(), error.entry()));
            })*
        };
    }
    first_of!(Error, MotionError, CommandError, ConnectError);
    None
}

/// Like [`of_driver`], but also for errors whose text a command has replaced.
pub(crate) fn origin_of(error: &anyhow::Error) -> Option<(Party, &'static str)> {
    match error.downcast_ref::<Failure>() {
        Some(failure) => failure.origin,
        None => of_driver(error),
    }
}

/// A failure: the text, the ending, and the next step for the user.
#[derive(Debug)]
pub(crate) struct Failure {
    ending: Ending,
    message: String,
    pub(crate) advice: Option<String>,
    /// Who can act on an error of the driver, and the error's row in the book's chapter on errors.
    origin: Option<(Party, &'static str)>,
}

impl Failure {
    pub(crate) fn new(ending: Ending, message: impl Into<String>) -> Self {
        Self {
            ending,
            message: message.into(),
            advice: None,
            origin: None,
        }
    }

    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::new(Ending::Usage, message)
    }

    /// Creates the failure for an option whose feature is missing from this build of the program.
    #[cfg(not(feature = "full"))]
    pub(crate) fn without(option: &str, feature: &str) -> Self {
        let message = format!("{option}: this `franka` was built without the feature `{feature}`");
        let advice = format!(
            "Install it with `cargo install --path franka-cli --features {feature}`, or use the \
             program of a release, which has the feature."
        );
        Self::usage(message).advice(advice)
    }

    pub(crate) fn advice(mut self, advice: impl Into<String>) -> Self {
        self.advice = Some(advice.into());
        self
    }

    /// Returns the same failure, marked as an error of the driver.
    pub(crate) fn of(mut self, party: Party, entry: &'static str) -> Self {
        self.origin = Some((party, entry));
        self
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_has_every_exit_code() {
        use Ending::*;
        let endings = [
            Done,
            Failed,
            Usage,
            NoRobot,
            Taken,
            NotConfirmed,
            Host,
            Person,
            Interrupted,
            Terminated,
        ];
        for ending in endings {
            let number = ending as u8;
            let line = format!("\n{number:>5}  ");
            assert!(TABLE.contains(&line), "{number}");
        }
        assert_eq!(TABLE.lines().count(), 1 + endings.len());
    }

    #[test]
    fn ending_follows_from_who_can_act_on_the_error() {
        let of = |error: anyhow::Error| Ending::of(&error);
        let silent: ConnectError = ConnectError::Timeout {
            address: ([172, 16, 0, 2], 1337).into(),
        };
        assert_eq!(of(silent.into()), Ending::NoRobot);
        assert_eq!(of(MotionError::Superseded.into()), Ending::Failed);
        assert_eq!(of(Failure::usage("no").into()), Ending::Usage);
        assert_eq!(of(io::Error::other("full").into()), Ending::Host);
        let within = anyhow::Error::from(io::Error::other("full")).context("writing it");
        assert_eq!(of(within), Ending::Host);
    }
}
