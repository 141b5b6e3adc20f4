//! Return value of a control function.

use super::{CartesianPose, CartesianVelocities, JointPositions, JointVelocities, Torques};

/// A command that continues or finishes the motion, or the decision to give it up.
///
/// To continue, a control function may also return the command itself, without [`Next::Continue`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next<T> {
    /// Sends the command, and calls the function again with the next state.
    Continue(T),
    /// Sends the command, and repeats it until the robot has ended the motion. The function is not
    /// called again. While the arm moves, the robot refuses to end the motion.
    Finish(T),
    /// Sends no more commands, and stops the robot. The motion fails with this code, which the
    /// function chooses.
    GiveUp(i32),
}

impl<T> Next<T> {
    /// Returns the command, and true if it is the last command.
    ///
    /// # Errors
    /// Returns the code of [`Self::GiveUp`].
    pub fn into_parts(self) -> Result<(T, bool), i32> {
        match self {
            Self::Continue(command) => Ok((command, false)),
            Self::Finish(command) => Ok((command, true)),
            Self::GiveUp(code) => Err(code),
        }
    }

    /// Returns the same decision with the command changed by `change`.
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Next<U> {
        match self {
            Self::Continue(command) => Next::Continue(change(command)),
            Self::Finish(command) => Next::Finish(change(command)),
            Self::GiveUp(code) => Next::GiveUp(code),
        }
    }

    /// Combines both commands. The result finishes or gives up if one of the two does.
    pub fn zip<U>(self, other: Next<U>) -> Next<(T, U)> {
        match (self.into_parts(), other.into_parts()) {
            (Ok((first, last)), Ok((second, also_last))) => {
                (first, second).finish_if(last || also_last)
            }
            (Err(code), _) | (_, Err(code)) => Next::GiveUp(code),
        }
    }
}

impl<T> From<T> for Next<T> {
    fn from(command: T) -> Self {
        Self::Continue(command)
    }
}

/// Adds the method [`finish`](Self::finish) to commands, which marks the last command of a motion.
pub trait Finish: Sized {
    /// Returns this command as the last one of its motion.
    fn finish(self) -> Next<Self> {
        Next::Finish(self)
    }

    /// Returns this command, marked as the last one of its motion if `over` is true.
    fn finish_if(self, over: bool) -> Next<Self> {
        if over {
            Next::Finish(self)
        } else {
            Next::Continue(self)
        }
    }
}

impl<T, U> Finish for (T, U) {}
impl Finish for Torques {}
impl Finish for JointPositions {}
impl Finish for JointVelocities {}
impl Finish for CartesianPose {}
impl Finish for CartesianVelocities {}
