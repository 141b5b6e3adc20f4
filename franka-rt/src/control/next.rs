//! What a control function answers a state with.

use super::{CartesianPose, CartesianVelocities, JointPositions, JointVelocities, Torques};

/// A command, and whether it is the last one.
///
/// Control functions may return the bare command for one that goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next<T> {
    /// Send it; the function is called again with the next state.
    Continue(T),
    /// Send it, repeated until the robot has ended the motion; the function is not called again.
    /// The robot refuses to end a motion that still moves.
    Finish(T),
}

impl<T> Next<T> {
    /// The command, and whether it is the last.
    pub fn into_parts(self) -> (T, bool) {
        match self {
            Self::Continue(command) => (command, false),
            Self::Finish(command) => (command, true),
        }
    }

    /// The same with another command made of this one.
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Next<U> {
        match self {
            Self::Continue(command) => Next::Continue(change(command)),
            Self::Finish(command) => Next::Finish(change(command)),
        }
    }
}

impl<T> From<T> for Next<T> {
    fn from(command: T) -> Self {
        Self::Continue(command)
    }
}

/// `command.finish()`, for the last command of a motion.
pub trait Finish: Sized {
    /// This command as the last one of its motion.
    fn finish(self) -> Next<Self> {
        Next::Finish(self)
    }

    /// This command, as the last one of its motion if `over`.
    fn finish_if(self, over: bool) -> Next<Self> {
        if over {
            Next::Finish(self)
        } else {
            Next::Continue(self)
        }
    }
}

impl Finish for Torques {}
impl Finish for JointPositions {}
impl Finish for JointVelocities {}
impl Finish for CartesianPose {}
impl Finish for CartesianVelocities {}
