//! Reasons why a robot accepts no motion.

use franka_proto::Command;

use super::{Differences, Party};

/// Reason why a robot accepts no motion now. The driver checks this for supervised robots; a robot
/// without supervision refuses motions itself, except while a stop is latched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Unready {
    /// Link: there is no connection. The supervisor reconnects.
    #[error("the robot is not connected")]
    Disconnected,
    /// Link: the robot is silent.
    #[error("no states arrive from the robot")]
    Silent,
    /// Robot: a reflex, from which the supervisor recovers the robot.
    #[error("the robot is being recovered from a reflex")]
    Recovering,
    /// Robot: a reflex. Its recovery waits for the user's approval.
    #[error("the recovery from a reflex waits for approval (`agree`)")]
    AgreementAwaited,
    /// Robot: after a lost connection, the robot differs from before. Its recovery from a reflex
    /// waits for the user's approval, and a motion that waited does not begin.
    #[error("the robot differs from the robot before the connection was lost: {0}")]
    Unrecognised(Differences),
    /// Robot: the settings of this program are being sent again after a reconnect.
    #[error("the settings of this program are being restored on the robot")]
    Configuring,
    /// Robot: a setting of this program could not be restored after a reconnect.
    #[error("the setting \"{0}\" of this program could not be restored after a reconnect")]
    NotConfigured(Command),
    /// Robot: a reflex, from which the user must recover the robot.
    #[error("the robot stopped itself by a reflex (`recover` first)")]
    Reflex,
    /// Robot: the user stop is pressed, or a safety function holds the robot.
    #[error("the user stop is pressed, or a safety function is active")]
    UserStopped,
    /// Robot: a hand guides the arm.
    #[error("the arm is guided by hand")]
    Guided,
    /// Robot: its brakes are closed, or it is not ready for another reason.
    #[error("the brakes are closed, or the robot is not ready")]
    Braked,
    /// Caller: this program has latched a stop and has not released it.
    #[error("a stop is latched (`release_stop` first)")]
    StopLatched,
}

impl Unready {
    /// True if the supervisor is about to end this condition. People must end all other conditions.
    pub fn is_passing(self) -> bool {
        matches!(
            self,
            Self::Disconnected
                | Self::Silent
                | Self::Recovering
                | Self::AgreementAwaited
                | Self::Unrecognised(_)
                | Self::Configuring
        )
    }

    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::Disconnected => "unready-disconnected",
            Self::Silent => "unready-silent",
            Self::Recovering => "unready-recovering",
            Self::AgreementAwaited => "unready-agreement-awaited",
            Self::Unrecognised(_) => "unready-unrecognised",
            Self::Configuring => "unready-configuring",
            Self::NotConfigured(_) => "unready-not-configured",
            Self::Reflex => "unready-reflex",
            Self::UserStopped => "unready-user-stopped",
            Self::Guided => "unready-guided",
            Self::Braked => "unready-braked",
            Self::StopLatched => "unready-stop-latched",
        }
    }

    /// Returns the party that can act on this error.
    pub fn party(self) -> Party {
        match self {
            Self::Disconnected | Self::Silent => Party::Link,
            Self::Recovering
            | Self::AgreementAwaited
            | Self::Unrecognised(_)
            | Self::Configuring
            | Self::NotConfigured(_)
            | Self::Reflex
            | Self::UserStopped
            | Self::Guided
            | Self::Braked => Party::Robot,
            Self::StopLatched => Party::Caller,
        }
    }
}
