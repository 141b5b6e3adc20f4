//! Why a program fails.

use core::any::Any;

use crate::shaping::InvalidCommand;

/// Why a program could not go on. The motion then gets no more commands; the owner of the thread
/// has to stop the robot.
#[derive(Debug)]
pub enum Failure {
    /// Its command cannot be sent.
    Invalid(InvalidCommand),
    /// It gave up, with a code of its own.
    GivenUp(i32),
    /// It panicked. The payload leaves with the failure, to be freed outside the thread.
    Panicked(Box<dyn Any + Send>),
}
