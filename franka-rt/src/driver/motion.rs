//! The motion that the driver runs, and its phase.

use std::sync::Arc;

use franka_proto::{RobotCommand, RobotMode, RobotState};

use super::{ControlLog, Ending, MotionId, Observer, Program};
use crate::control::Modes;
use crate::stats::MotionTimes;
use crate::team::MemberFault;
use crate::together::{Gate, StartTicket};

/// What the driver is doing.
#[derive(Debug)]
pub(super) enum DriverPhase {
    Watching,
    Armed(Execution),
    /// Abandoned while it was armed, and the number of states in a row since then that show no
    /// motion: the robot may begin it all the same. Nothing is sent.
    Unwanted(Execution, u32),
    Running(Execution),
    /// The finishing command is repeated until the robot leaves the motion's modes.
    Finishing(Execution),
    /// The program has failed, or was left alone: nothing is sent until the robot leaves the
    /// motion's modes.
    Silent(Execution),
}

impl DriverPhase {
    /// The motion that the robot has begun; `None` if it has begun none, or has left it.
    pub(super) fn begun(&self) -> Option<&Execution> {
        match self {
            Self::Running(motion) | Self::Finishing(motion) | Self::Silent(motion) => Some(motion),
            Self::Watching | Self::Armed(_) | Self::Unwanted(..) => None,
        }
    }

    /// [`Self::begun`], to be changed.
    pub(super) fn begun_mut(&mut self) -> Option<&mut Execution> {
        match self {
            Self::Running(motion) | Self::Finishing(motion) | Self::Silent(motion) => Some(motion),
            Self::Watching | Self::Armed(_) | Self::Unwanted(..) => None,
        }
    }
}

/// States in a row without a motion after which a robot that was told to stop is taken not to begin
/// it any more. A reply and a state that cross on their way are apart by less than that.
pub(super) const UNWANTED_STATES: u32 = 20;

/// What a motion owns from arming to its end.
#[derive(Debug)]
pub(super) struct Execution {
    pub(super) id: MotionId,
    pub(super) modes: Modes,
    pub(super) program: Program,
    pub(super) log: ControlLog,
    pub(super) ticket: Option<StartTicket>,
    pub(super) times: Arc<MotionTimes>,
    pub(super) observer: Option<Observer>,
    /// The newest command that was sent; zeros before the first.
    pub(super) sent: RobotCommand,
}

impl Execution {
    /// Whether it may begin, or has begun, at this state.
    pub(super) fn gate(&mut self, state: &RobotState) -> Gate {
        let Some(ticket) = &mut self.ticket else {
            return Gate::Open;
        };
        if ticket.is_undecided() && self.program.is_withdrawn() {
            ticket.withdraw();
        }
        ticket.pass(state.message_id)
    }

    /// Lets those go that it was to begin with.
    pub(super) fn leave(&mut self) {
        if let Some(ticket) = &mut self.ticket {
            ticket.end();
        }
    }

    /// Brakes the others of its team if it ends otherwise than asked.
    pub(super) fn tell_team(&mut self, ending: Ending) {
        match ending {
            Ending::Finished => {}
            Ending::Aborted => self.program.fail_team(MemberFault::RobotStopped),
            Ending::LinkLost { .. } => self.program.fail_team(MemberFault::Silent),
            Ending::Disarmed | Ending::Refused => self.program.fail_team(MemberFault::Gone),
        }
        self.program.leave_team();
    }

    /// Whether the robot no longer runs the motion.
    pub(super) fn is_left_by(&self, state: &RobotState) -> bool {
        !self.modes.shown_by(state) || state.robot_mode != RobotMode::Move
    }
}
