//! Control at 1 kHz by the user's own code.
//!
//! * [`Torques`] and the four [`MotionCommand`]s: commands in the robot's own terms.
//! * [`Next`]: the answer of a control function to a state.
//! * [`Callback`]: control functions as the program of a motion, with the order, filter and limiter
//!   of the reference client.
//! * [`Shaper`]: filter, limiter and check of each kind of command, as in libfranka's control
//!   loops.
//! * [`ActiveControl`]: a motion whose commands a thread of the user writes.
//! * [`AsynchronousPositions`]: sparse joint targets between which the robot plans, and their
//!   results.
//! * [`Command`]: content of one datagram; checks whether a motion in given [`Modes`] accepts it.
//! * [`Failure`]: the reason why a program could not continue.

mod active;
mod asynchronous;
mod callback;
mod command;
mod datagram;
mod failure;
mod modes;
mod next;
mod shaper;

pub use active::{ActiveControl, WriteError};
pub use asynchronous::{AbortReason, AsynchronousPositions, AsynchronousTarget, TargetStatus};
pub use callback::Callback;
pub use command::{
    CartesianPose, CartesianVelocities, GeneratorCommand, JointPositions, JointVelocities,
    MotionCommand, Torques,
};
pub use datagram::{Command, Misfit};
pub use failure::Failure;
pub use modes::Modes;
pub use next::{Finish, Next};
pub use shaper::Shaper;
