//! Orders to the driver.

use std::sync::Arc;

use crate::control::Modes;
use crate::driver::{ControlLog, Observer, Program};
use crate::stats::MotionTimes;
use crate::together::StartTicket;

/// Number of a motion. A driver uses each number only once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MotionId(pub u64);

/// An order to the control thread. Orders pass through a bounded queue, which never loses or
/// reorders them.
#[derive(Debug)]
pub enum Order {
    /// Waits for a state that shows `modes`, then answers every state with `program`. Send this
    /// order before the `Move` request is sent on TCP.
    Arm {
        /// The motion that the order begins.
        motion: MotionId,
        /// The modes in which the robot runs the motion.
        modes: Modes,
        /// Program that answers the states of the motion.
        program: Program,
        /// Empty log for the last cycles of the motion.
        log: ControlLog,
        /// Ticket of a motion that is part of a common start of several robots. If the program is
        /// [`Program::Target`] or [`Program::Callback`], the driver holds the arm until all robots
        /// are ready. Other programs do not wait.
        ticket: Option<StartTicket>,
        /// Empty histograms for the times of the motion's cycles.
        times: Arc<MotionTimes>,
        /// Observer of the motion's cycles.
        observer: Option<Observer>,
    },
    /// Forgets the armed motion, because the robot refused its `Move` request. Has no effect once
    /// the motion runs.
    Disarm {
        /// The motion to forget.
        motion: MotionId,
    },
    /// Ends the motion, because no caller waits for it any more. If the program is
    /// [`Program::Target`], it continues, and brakes the arm as its newest goal requires. Any other
    /// program receives no more states, so the robot receives no commands and stops on its own. If
    /// the motion is still armed, it ends once 20 consecutive states have shown no motion.
    Abandon {
        /// The motion to end.
        motion: MotionId,
    },
}
