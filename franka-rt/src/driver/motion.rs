//! The motion that the driver runs, with its phase.

use std::sync::Arc;

use franka_proto::{RobotCommand, RobotMode, RobotState};

use super::{ControlLog, Ending, MotionId, Observer, Program};
use crate::control::Modes;
use crate::stats::MotionTimes;
use crate::team::MemberFault;
use crate::together::{Gate, StartTicket};

/// Phase of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// The motion is requested, and the robot has not shown its modes yet.
    Armed,
    /// The motion was abandoned while it was armed, but the robot may still begin it. Nothing is
    /// sent. The number counts the consecutive states since then that show no motion.
    Unwanted(u32),
    Running,
    /// The finishing command is repeated until the robot leaves the motion's modes.
    Finishing,
    /// The program has failed or was abandoned. Nothing is sent until the robot leaves the motion's
    /// modes.
    Silent,
}

/// Number of consecutive states without a motion, after a stop request, after which the robot can
/// no longer begin the motion. If a reply and a state cross on the network, they are fewer states
/// apart.
pub(super) const UNWANTED_STATES: u32 = 20;

/// A motion from arming to its end.
#[derive(Debug)]
pub(super) struct Execution {
    pub(super) id: MotionId,
    pub(super) modes: Modes,
    pub(super) program: Program,
    pub(super) log: ControlLog,
    pub(super) ticket: Option<StartTicket>,
    pub(super) times: Arc<MotionTimes>,
    pub(super) observer: Option<Observer>,
    /// Newest command that was sent; zeros before the first command.
    pub(super) sent: RobotCommand,
    pub(super) phase: Phase,
}

impl Execution {
    /// Returns whether the motion may begin with this state, or has begun.
    pub(super) fn gate(&mut self, state: &RobotState) -> Gate {
        let Some(ticket) = &mut self.ticket else {
            return Gate::Open;
        };
        if ticket.is_undecided() && self.program.is_withdrawn() {
            ticket.withdraw();
        }
        ticket.pass(state.message_id)
    }

    /// True if the robot has begun the motion and has not left it.
    pub(super) fn has_begun(&self) -> bool {
        matches!(
            self.phase,
            Phase::Running | Phase::Finishing | Phase::Silent
        )
    }

    /// Gives the motion up, so that it ends once the robot has left it. A program that brakes
    /// without the robot's help continues until then.
    pub(super) fn abandon(&mut self) {
        self.phase = match self.phase {
            Phase::Armed => Phase::Unwanted(0),
            Phase::Running | Phase::Finishing if !self.program.brakes() => Phase::Silent,
            _ => return,
        };
        self.leave();
    }

    /// Leaves the common start, so that the other robots stop waiting.
    pub(super) fn leave(&mut self) {
        if let Some(ticket) = &mut self.ticket {
            ticket.end();
        }
    }

    /// Brakes the other members of the motion's team, unless the motion ends as requested.
    pub(super) fn tell_team(&mut self, ending: Ending) {
        match ending {
            Ending::Finished => {}
            Ending::Aborted => self.program.fail_team(MemberFault::RobotStopped),
            Ending::LinkLost { .. } => self.program.fail_team(MemberFault::Silent),
            Ending::Disarmed | Ending::Refused => self.program.fail_team(MemberFault::Gone),
        }
        self.program.leave_team();
    }

    /// True if the robot no longer runs the motion.
    pub(super) fn is_left_by(&self, state: &RobotState) -> bool {
        !self.modes.shown_by(state) || state.robot_mode != RobotMode::Move
    }
}
