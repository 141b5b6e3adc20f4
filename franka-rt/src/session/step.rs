//! What a session answers a state with, and what the record has of it.

use core::time::Duration;

use franka_model::JointVector;

use super::reference::Reference;
use super::{Bindings, GoalId, Target};
use crate::control::{MotionCommand, Torques};

/// What a session answers a state with.
#[derive(Debug)]
pub(crate) struct SessionStep {
    pub(crate) answer: SessionCommand,
    pub(crate) trace: Trace,
    /// The last command: the motion ends once the robot has taken it.
    pub(crate) finished: bool,
}

/// What the record of a cycle has of the session; all zero where no goal is followed.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    pub(crate) goal: GoalId,
    pub(crate) reference: Reference,
    /// What it heads for, where that is now; `None` where no goal is followed.
    pub(crate) target: Option<Target>,
    /// Since the goal was first seen.
    pub(crate) elapsed: Duration,
    /// Until the reference meets the goal's target.
    pub(crate) remaining: Duration,
    /// `[N m]`
    pub(crate) compensation: JointVector,
    pub(crate) bindings: Bindings,
}

/// The command that answers a state: torques, or a setpoint.
#[derive(Debug)]
pub(crate) enum SessionCommand {
    Torques(Torques),
    Setpoint(MotionCommand),
}
