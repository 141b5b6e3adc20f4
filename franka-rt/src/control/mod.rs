//! Control at 1 kHz by the user's own code.
//!
//! * [`Torques`] and the four [`MotionCommand`]s: commands in the robot's own quantities.
//! * [`Next`]: the return value of a control function.
//! * [`Callback`]: the program of a motion that calls control functions. The order of the calls,
//!   the filter and the limiter are the same as in libfranka.
//! * [`Shaper`]: filter, limiter and check of each kind of command, as in libfranka's control
//!   loops.
//! * [`ActiveControl`]: the program of a motion in which a thread of the user writes each command.
//! * [`AsynchronousPositions`]: sparse joint targets. The robot plans the motion between them.
//! * [`Command`]: content of one datagram. [`Command::check`] checks whether a motion in given
//!   [`Modes`] accepts it.
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
