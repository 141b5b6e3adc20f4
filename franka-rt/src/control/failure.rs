//! Failures of a program.

use core::any::Any;

use crate::shaping::InvalidCommand;

/// Reason why a program could not continue. The motion then gets no more commands; the owner of the
/// thread must stop the robot.
#[derive(Debug)]
pub enum Failure {
    /// Its command cannot be sent.
    Invalid(InvalidCommand),
    /// It gave up, with its own code.
    GivenUp(i32),
    /// It panicked. The payload leaves with the failure, to be freed outside the thread.
    Panicked(Box<dyn Any + Send>),
}
