//! Failures of a program.

use core::any::Any;

use crate::shaping::InvalidCommand;

/// Reason why a program could not continue. The thread sends no more commands to the motion; the
/// owner of the thread must stop the robot.
#[derive(Debug)]
pub enum Failure {
    /// The program's command cannot be sent.
    Invalid(InvalidCommand),
    /// The program gave up, with its own code.
    GivenUp(i32),
    /// The program panicked. The payload is part of the failure, to be freed outside the thread.
    Panicked(Box<dyn Any + Send>),
}
