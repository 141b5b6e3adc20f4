//! Failures of a motion's program.

use core::any::Any;

use crate::shaping::InvalidCommand;

/// Reason why a program could not continue. The control thread sends no more commands in this
/// motion, so the owner of the thread must stop the robot.
#[derive(Debug)]
pub enum Failure {
    /// A command of the program is invalid.
    Invalid(InvalidCommand),
    /// The program gave up ([`Next::GiveUp`](super::Next::GiveUp)) with this code.
    GivenUp(i32),
    /// The program panicked. The failure carries the payload, so that the payload is freed outside
    /// the thread.
    Panicked(Box<dyn Any + Send>),
}
