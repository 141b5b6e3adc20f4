//! Failures of a motion's program.

use core::any::Any;

use crate::shaping::InvalidCommand;

/// Reason why a program could not continue. The thread sends no more commands to the motion, so the
/// owner of the thread must stop the robot.
#[derive(Debug)]
pub enum Failure {
    /// A command of the program is invalid.
    Invalid(InvalidCommand),
    /// The program gave up, with a code that it chose.
    GivenUp(i32),
    /// The program panicked. The failure carries the payload, so that the payload is freed outside
    /// the thread.
    Panicked(Box<dyn Any + Send>),
}
