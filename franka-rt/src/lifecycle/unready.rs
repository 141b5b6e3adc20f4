//! Reasons why a robot accepts no motions.

use franka_proto::Command;

use super::{Differences, Party};

/// Reason why a robot accepts no motions now. The driver checks it for supervised robots. Without
/// supervision, the robot itself refuses motions, except while a stop is latched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Unready {
    /// Link: there is no connection. The supervisor reconnects.
    #[error("the robot is not connected")]
    Disconnected,
    /// Link: the robot sends no states.
    #[error("no states arrive from the robot")]
    Silent,
    /// Robot: it stopped with a reflex, and the supervisor is recovering it.
    #[error("the robot is being recovered from a reflex")]
    Recovering,
    /// Robot: it stopped with a reflex. The recovery waits for the user's approval.
    #[error("the recovery from a reflex waits for approval (call `agree`)")]
    AgreementAwaited,
    /// Robot: after a lost connection, the robot differs from the robot before. Its recovery from a
    /// reflex waits for the user's approval, and waiting motions do not begin.
    #[error("the robot is not as it was before the connection was lost: {0}")]
    Unrecognised(Differences),
    /// Robot: this program's settings are being sent again after a reconnect.
    #[error("the settings of this program are being restored on the robot")]
    Configuring,
    /// Robot: one of this program's settings could not be restored after a reconnect.
    #[error("the setting \"{0}\" of this program could not be restored after a reconnect")]
    NotConfigured(Command),
    /// Robot: it stopped with a reflex, and the user must recover it.
    #[error("the robot stopped itself by a reflex (call `recover` first)")]
    Reflex,
    /// Robot: the user stop is pressed, or a safety function holds the robot.
    #[error("the user stop is pressed, or a safety function is active")]
    UserStopped,
    /// Robot: a hand guides the arm.
    #[error("the arm is guided by hand")]
    Guided,
    /// Robot: its brakes are closed, or something else prevents it from being ready.
    #[error("the brakes are closed, or the robot is not ready")]
    Braked,
    /// Caller: this program has latched a stop and has not released it.
    #[error("a stop is latched (call `release_stop` first)")]
    StopLatched,
}

impl Unready {
    /// True if the supervisor is about to end this condition. All other conditions must be ended by
    /// people.
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
        self.row().0
    }

    /// Returns the party that can act on this error.
    pub fn party(self) -> Party {
        self.row().1
    }

    pub(super) fn row(&self) -> (&'static str, Party) {
        match self {
            Self::Disconnected => ("unready-disconnected", Party::Link),
            Self::Silent => ("unready-silent", Party::Link),
            Self::Recovering => ("unready-recovering", Party::Robot),
            Self::AgreementAwaited => ("unready-agreement-awaited", Party::Robot),
            Self::Unrecognised(_) => ("unready-unrecognised", Party::Robot),
            Self::Configuring => ("unready-configuring", Party::Robot),
            Self::NotConfigured(_) => ("unready-not-configured", Party::Robot),
            Self::Reflex => ("unready-reflex", Party::Robot),
            Self::UserStopped => ("unready-user-stopped", Party::Robot),
            Self::Guided => ("unready-guided", Party::Robot),
            Self::Braked => ("unready-braked", Party::Robot),
            Self::StopLatched => ("unready-stop-latched", Party::Caller),
        }
    }
}
