//! What answers the states of a running motion.

use core::any::Any;

use franka_proto::{RobotState, Version};

use crate::control::{ActiveControl, AsynchronousPositions, Callback, Command};
use crate::driver::Record;
use crate::session::{SessionEvent, TargetSession};
use crate::shaping::InvalidCommand;

/// What answers the states of a running motion. Built outside the thread and freed outside it.
#[derive(Debug)]
pub enum Program {
    /// Goals from a slot, turned into torques.
    Target(Box<TargetSession>),
    /// A function of the user's, called with every state.
    Callback(Box<Callback>),
    /// Commands written from outside, see [`Driver::write`](super::Driver::write).
    Active(ActiveControl),
    /// Sparse targets, between which the robot plans.
    Asynchronous(AsynchronousPositions),
}

/// Why a program could not go on. The motion then gets no more commands; it is for the world outside to stop the robot.
#[derive(Debug)]
pub enum Failure {
    /// Its command cannot be sent.
    Invalid(InvalidCommand),
    /// It panicked. What with comes along to be freed.
    Panicked(Box<dyn Any + Send>),
}

/// What a program answers a state with.
pub(super) struct Step {
    pub(super) answer: Answer,
    pub(super) event: Option<SessionEvent>,
}

#[expect(
    clippy::large_enum_variant,
    reason = "one per cycle, and a box would allocate on the thread"
)]
pub(super) enum Answer {
    /// This command; the last one if it says so.
    Command { command: Command, finished: bool },
    /// Nothing now, but perhaps something is written before the next state.
    Open,
    /// No command, and none later.
    Failed(Failure),
}

impl Program {
    pub(super) fn step(
        &mut self,
        version: Version,
        state: &RobotState,
        record: &mut Record,
    ) -> Step {
        let answer = match self {
            Self::Target(session) => {
                let step = session.step(state, record);
                return Step {
                    answer: Answer::Command {
                        command: Command::torques(version, step.torques),
                        finished: step.finished,
                    },
                    event: step.event,
                };
            }
            Self::Callback(callback) => match callback.step(state) {
                Ok((command, finished)) => Answer::Command { command, finished },
                Err(failure) => Answer::Failed(failure),
            },
            Self::Active(_) => Answer::Open,
            Self::Asynchronous(positions) => match positions.step() {
                Some((command, finished)) => Answer::Command { command, finished },
                None => Answer::Open,
            },
        };
        Step {
            answer,
            event: None,
        }
    }
}
