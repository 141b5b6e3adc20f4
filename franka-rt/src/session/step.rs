//! The answer of a session to a state, and the values of it that the record keeps.

use core::time::Duration;

use franka_model::JointVector;

use super::reference::Reference;
use super::{Bindings, GoalId, Target};
use crate::control::{MotionCommand, Torques};

#[derive(Debug)]
pub(crate) struct SessionStep {
    pub(crate) answer: SessionCommand,
    pub(crate) trace: Trace,
    /// True for the last command. The motion ends once the robot has accepted that command.
    pub(crate) finished: bool,
}

/// Values of a session for the record of a cycle. All are zero if the session follows no goal.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    pub(crate) goal: GoalId,
    pub(crate) reference: Reference,
    /// Present place of the target; `None` if the session follows no goal.
    pub(crate) target: Option<Target>,
    /// Time since the session first saw the goal.
    pub(crate) elapsed: Duration,
    /// Time until the reference meets the goal's target.
    pub(crate) remaining: Duration,
    /// Compensation torques, `[N m]`.
    pub(crate) compensation: JointVector,
    pub(crate) bindings: Bindings,
}

/// The command that answers a state: torques, or a setpoint.
#[derive(Debug)]
pub(crate) enum SessionCommand {
    Torques(Torques),
    Setpoint(MotionCommand),
}
