//! Orders to the driver.

use std::sync::Arc;

use crate::control::Modes;
use crate::driver::{ControlLog, Observer, Program};
use crate::stats::MotionTimes;
use crate::together::StartTicket;

/// Name of one motion for the life of a driver, from arming to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MotionId(pub u64);

/// An order to the thread. Orders pass through a bounded queue and are never lost or reordered.
#[derive(Debug)]
pub enum Order {
    /// Watch for `modes`, then answer every state with `program`. Send this order before the `Move`
    /// leaves on TCP.
    Arm {
        /// The motion that the order begins.
        motion: MotionId,
        /// The modes in which the robot runs the motion.
        modes: Modes,
        /// Program that answers the states of the motion.
        program: Program,
        /// Log for the last cycles of the motion; empty.
        log: ControlLog,
        /// Ticket of a motion that begins together with motions of other robots. Until all are
        /// ready, the driver holds the arm if the program is goals or a control function. Other
        /// programs do not wait.
        ticket: Option<StartTicket>,
        /// Counts for the times of the motion's cycles; empty.
        times: Arc<MotionTimes>,
        /// The observer of the motion's cycles.
        observer: Option<Observer>,
    },
    /// Forget the armed motion, because its `Move` was refused. Has no effect once the motion runs.
    Disarm {
        /// The motion to forget.
        motion: MotionId,
    },
    /// End the motion, because no caller waits for it any more. A program of goals brakes without
    /// the robot, as its newest goal requires. Any other program gets no more states, and the robot
    /// stops on its own without commands. An armed motion ends once the robot has shown no motion
    /// for 20 states in a row.
    Abandon {
        /// The motion to end.
        motion: MotionId,
    },
}
