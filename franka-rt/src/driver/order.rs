//! Orders to the driver.

use std::sync::Arc;

use crate::control::Modes;
use crate::driver::{ControlLog, Observer, Program};
use crate::stats::MotionTimes;
use crate::together::StartTicket;

/// Names one motion for the life of a driver, from arming to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MotionId(pub u64);

/// An order into the thread. Orders cross in a bounded queue and are never lost or reordered.
#[derive(Debug)]
pub enum Order {
    /// Watch for `modes`, then answer every state with `program`. Comes before the `Move` goes out
    /// on TCP.
    Arm {
        /// The motion that this begins.
        motion: MotionId,
        /// The modes in which the robot runs it.
        modes: Modes,
        /// Program that answers the states.
        program: Program,
        /// Log of its last cycles; empty.
        log: ControlLog,
        /// Ticket of a motion that begins together with others. Until they are all there the driver
        /// holds the arm, by goals or a control function; other programs do not wait.
        ticket: Option<StartTicket>,
        /// Counts of the times of its cycles; empty.
        times: Arc<MotionTimes>,
        /// The observer of its cycles.
        observer: Option<Observer>,
    },
    /// Forget the armed motion: its `Move` was refused. Has no effect once the motion runs.
    Disarm {
        /// The motion to forget.
        motion: MotionId,
    },
    /// End the motion: no caller waits for it any more. Goals brake alone, as the newest one
    /// requires. Any other program gets no more states, and the robot stops on its own when its
    /// commands stay away. An armed motion ends once the robot has shown no motion for 20 states in
    /// a row.
    Abandon {
        /// The motion to end.
        motion: MotionId,
    },
}
