//! Control from outside: somebody reads a state, and writes the command that answers it.

use super::{Command, Misfit};
use crate::driver::Modes;
use crate::shaping::{InvalidCommand, check};

/// The program of a motion whose commands are written from outside.
///
/// Commands pass no filter and no limiter, as with libfranka's `ActiveControl`.
#[derive(Clone, Copy, Debug)]
pub struct ActiveControl;

/// Why a command was not sent. Texts are those of libfranka 0.21, `active_control*.h` and `robot_impl.cpp`.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// No motion runs that takes it: its last command was written, or the robot has ended it.
    #[error("writeOnce must not be called after the motion has finished.")]
    NotRunning,
    /// Torques beside a motion command, under the robot's own controller.
    #[error("Torques can only be commanded in kExternalController mode.")]
    TorquesUnwanted,
    /// A motion command without the torques that the motion wants with it.
    #[error(
        "Torque command missing, please use writeOnce(const MotionGeneratorType& motion_generator_input, const Torques& \
         control_input) for external controllers."
    )]
    TorquesMissing,
    /// A command of a kind that the motion does not take.
    #[error("Wrong writeOnce method called for currently active control!")]
    WrongKind,
    /// The last torques, while a motion generator runs whose own last command is missing.
    #[error("libfranka robot: Motion generator is still running! Can't stop external control")]
    GeneratorRunning,
    /// The command does not fit the motion.
    #[error(transparent)]
    Misfit(#[from] Misfit),
    /// A number of it cannot be sent.
    #[error(transparent)]
    Invalid(#[from] InvalidCommand),
}

impl ActiveControl {
    /// Whether a motion in `modes` takes `command`, in the order in which the reference client asks.
    pub(crate) fn check(
        &self,
        command: &Command,
        modes: Modes,
        finished: bool,
    ) -> Result<(), WriteError> {
        match (&command.motion, &command.torques) {
            (Some(motion), torques) if modes.has_generator() => {
                if motion.generator().in_state() != modes.generator {
                    return Err(WriteError::WrongKind);
                }
                match (modes.is_external(), torques) {
                    (false, Some(_)) => return Err(WriteError::TorquesUnwanted),
                    (true, None) => return Err(WriteError::TorquesMissing),
                    _ => {}
                }
            }
            (None, _) if finished && modes.has_generator() => {
                return Err(WriteError::GeneratorRunning);
            }
            _ => {}
        }
        command.check(modes)?;
        if let Some(motion) = &command.motion {
            motion.validate()?;
        }
        if let Some(torques) = &command.torques {
            check::finite(&torques.0)?;
        }
        Ok(())
    }
}
