//! Events of the driver.

use core::time::Duration;
use std::sync::Arc;

use franka_proto::{Errors, RobotMode};

use crate::control::Failure;
use crate::driver::{ControlLog, MotionId, Observer, Program};
use crate::session::SessionEvent;
use crate::stats::{MotionStatistics, MotionTimes};
use crate::together::{StartFault, StartTicket};

/// Something that happened in the thread. Events arrive in order and none is dropped.
#[derive(Debug)]
pub enum Event {
    /// The robot shows the modes of the motion. The first command answers that state.
    Started {
        /// The motion.
        motion: MotionId,
        /// `message_id` of that state, `[ms]` of the robot's clock.
        time: u64,
    },
    /// The motion's program reports an event.
    Program {
        /// The motion.
        motion: MotionId,
        /// Report of the session.
        event: SessionEvent,
        /// Counts so far.
        statistics: MotionStatistics,
    },
    /// The finishing command is sent for the first time. It is repeated until the robot leaves the
    /// motion's modes.
    Finishing {
        /// The motion.
        motion: MotionId,
    },
    /// The motion's program could not continue. The thread sends no more commands; the robot must
    /// be stopped.
    Failed {
        /// The motion.
        motion: MotionId,
        /// Cause.
        failure: Failure,
    },
    /// The motion's observer has panicked, and is not called again in this motion.
    Unobserved {
        /// The motion.
        motion: MotionId,
    },
    /// The motion has ended for the thread. The event carries its program, to be freed.
    Ended(Ended),
    /// No state has come for the link timeout, so the link counts as lost. A later state revives
    /// it.
    LinkLost {
        /// The silence so far.
        silence: Duration,
    },
}

/// End of a motion, with the data of the state at that moment.
#[derive(Debug)]
pub struct Ended {
    /// The motion.
    pub motion: MotionId,
    /// Kind of end.
    pub ending: Ending,
    /// `robot_mode` of the newest state.
    pub robot_mode: RobotMode,
    /// Errors that are active at the end.
    pub errors: Errors,
    /// Errors that aborted the motion, if the robot aborted it.
    pub reflex_reason: Errors,
    /// Counts over the motion.
    pub statistics: MotionStatistics,
    /// Times of the motion's cycles.
    pub times: Arc<MotionTimes>,
    /// The program, with everything that it learned.
    pub program: Program,
    /// The motion's last cycles.
    pub log: ControlLog,
    /// The motion's ticket, if it was part of a common start of several robots.
    pub ticket: Option<StartTicket>,
    /// The observer of the motion's cycles.
    pub observer: Option<Observer>,
}

impl Ended {
    /// Returns the reason why the motion did not begin, if its common start failed.
    pub fn start_fault(&self) -> Option<StartFault> {
        self.ticket.as_ref().and_then(StartTicket::refusal)
    }
}

/// End of a motion, as the thread saw it. The robot's own report of the end is its last reply to
/// the `Move`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The finishing command was sent and the robot left the motion's modes.
    Finished,
    /// The robot left the motion's modes on its own: a reflex, a stop, a preemption.
    Aborted,
    /// The motion was disarmed before it ran.
    Disarmed,
    /// Another motion was armed or running, so this one never was.
    Refused,
    /// The robot fell silent.
    LinkLost {
        /// Length of the silence when the motion was given up.
        silence: Duration,
    },
}

/// Queue of events that wait for the thread to publish them.
///
/// A motion causes at most `Started`, a report per goal, `Failed` or `Finishing`, `Ended` and
/// `LinkLost`, and needs orders from outside. The thread empties the queue every cycle unless the
/// receiver has stopped listening altogether. A link that comes and goes meanwhile fills only one
/// slot. The queue therefore has room for the end of a motion.
#[derive(Debug, Default)]
pub(super) struct EventQueue {
    slots: [Option<Event>; EventQueue::CAPACITY],
    first: usize,
    count: usize,
}

impl EventQueue {
    const CAPACITY: usize = 16;

    /// Appends an event. A full queue leaks the event, because its memory must not be freed on the
    /// thread. No motion can start without a listener outside.
    pub(super) fn push(&mut self, event: Event) {
        let newest = (self.first + self.count + Self::CAPACITY - 1) % Self::CAPACITY;
        if let (Event::LinkLost { silence }, Some(Event::LinkLost { silence: told })) =
            (&event, &mut self.slots[newest])
        {
            *told = *silence;
            return;
        }
        if self.count == Self::CAPACITY {
            core::mem::forget(event);
            return;
        }
        self.slots[(self.first + self.count) % Self::CAPACITY] = Some(event);
        self.count += 1;
    }

    pub(super) fn pop(&mut self) -> Option<Event> {
        let event = self.slots[self.first].take()?;
        self.first = (self.first + 1) % Self::CAPACITY;
        self.count -= 1;
        Some(event)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unheard_link_events_leave_room_for_the_motions_end() {
        let mut queue = EventQueue::default();
        for ms in 1..=100 {
            queue.push(Event::LinkLost {
                silence: Duration::from_millis(ms),
            });
        }
        queue.push(Event::Finishing {
            motion: MotionId(7),
        });
        let Some(Event::LinkLost { silence }) = queue.pop() else {
            panic!("the link was lost")
        };
        assert_eq!(silence.as_millis(), 100);
        assert!(matches!(queue.pop(), Some(Event::Finishing { .. })));
        assert!(queue.pop().is_none());
    }

    #[test]
    fn a_full_queue_keeps_what_it_holds_and_does_not_panic() {
        let mut queue = EventQueue::default();
        for number in 0..40 {
            queue.push(Event::Finishing {
                motion: MotionId(number),
            });
        }
        for expected in 0..EventQueue::CAPACITY as u64 {
            let event = queue.pop();
            assert!(
                matches!(event, Some(Event::Finishing { motion: MotionId(got) }) if got == expected)
            );
        }
        assert!(queue.pop().is_none());
    }
}
