//! Orders to the driver.

use std::sync::Arc;

use crate::control::Modes;
use crate::driver::{ControlLog, Observer, Program};
use crate::stats::MotionTimes;
use crate::together::StartTicket;

/// Number of a motion, unique during the life of a driver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MotionId(pub u64);

/// An order to the thread. A bounded queue passes the orders, and never loses or reorders them.
#[derive(Debug)]
pub enum Order {
    /// Waits for `modes`, then answers every state with `program`. Send this order before the
    /// `Move` is sent on TCP.
    Arm {
        /// The motion that the order begins.
        motion: MotionId,
        /// The modes in which the robot runs the motion.
        modes: Modes,
        /// Program that answers the states of the motion.
        program: Program,
        /// Empty log for the last cycles of the motion.
        log: ControlLog,
        /// Ticket of a motion that is part of a common start. If the program is goals or a control
        /// function, the driver holds the arm until all robots are ready. Other programs do not
        /// wait.
        ticket: Option<StartTicket>,
        /// Empty histograms for the times of the motion's cycles.
        times: Arc<MotionTimes>,
        /// Observer of the motion's cycles.
        observer: Option<Observer>,
    },
    /// Forgets the armed motion, because its `Move` was refused. Has no effect once the motion
    /// runs.
    Disarm {
        /// The motion to forget.
        motion: MotionId,
    },
    /// Ends the motion, because no caller waits for it any more. A program of goals brakes without
    /// the robot's help, as its newest goal requires. Any other program receives no more states.
    /// The robot then receives no commands and stops on its own. An armed motion ends once 20
    /// consecutive states have shown no motion.
    Abandon {
        /// The motion to end.
        motion: MotionId,
    },
}
