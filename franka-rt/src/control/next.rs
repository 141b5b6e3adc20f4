//! Answer of a control function to a state.

use super::{CartesianPose, CartesianVelocities, JointPositions, JointVelocities, Torques};

/// A command, with the decision whether the motion continues, finishes or is given up.
///
/// Control functions may return the bare command to continue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next<T> {
    /// Send the command, and call the function again with the next state.
    Continue(T),
    /// Send the command, repeated until the robot has ended the motion; do not call the function
    /// again. The robot refuses to end a motion of an arm that still moves.
    Finish(T),
    /// Send nothing more, and stop the robot. The motion fails with this code, which the function
    /// chooses.
    GiveUp(i32),
}

impl<T> Next<T> {
    /// Returns the command, and whether it is the last.
    ///
    /// # Errors
    /// The code of [`Self::GiveUp`].
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

    /// Returns both commands: finished if either is, given up if either is.
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

/// Adds `command.finish()`, for the last command of a motion.
pub trait Finish: Sized {
    /// Returns this command as the last one of its motion.
    fn finish(self) -> Next<Self> {
        Next::Finish(self)
    }

    /// Returns this command, as the last one of its motion if `over`.
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
