//! Events of the driver.

use core::time::Duration;
use std::sync::Arc;

use franka_proto::{Errors, RobotMode};

use crate::control::Failure;
use crate::driver::{ControlLog, MotionId, Observer, Program};
use crate::session::SessionEvent;
use crate::stats::{MotionStatistics, MotionTimes};
use crate::together::{StartFault, StartTicket};

/// An event of the control thread. Events arrive in order. Events are lost only if the receiver no
/// longer reads them.
#[derive(Debug)]
pub enum Event {
    /// A state shows the modes of the motion, so the motion has started. The first command answers
    /// this state.
    Started {
        /// The motion.
        motion: MotionId,
        /// `message_id` of the state, `[ms]` of the robot's clock.
        time: u64,
    },
    /// The motion's program, a [session](crate::session), reports an event.
    Program {
        /// The motion.
        motion: MotionId,
        /// Event of the session.
        event: SessionEvent,
        /// Counts of the motion so far.
        statistics: MotionStatistics,
    },
    /// The thread sends the finishing command for the first time. It repeats the command until the
    /// robot leaves the motion's modes.
    Finishing {
        /// The motion.
        motion: MotionId,
    },
    /// The motion's program could not continue. The thread sends no more commands, so the receiver
    /// must stop the robot.
    Failed {
        /// The motion.
        motion: MotionId,
        /// The reason.
        failure: Failure,
    },
    /// The motion's observer has panicked, and is not called again during this motion.
    Unobserved {
        /// The motion.
        motion: MotionId,
    },
    /// The motion has ended in the control thread. The event contains the program, so that the
    /// receiver frees its memory.
    Ended(Ended),
    /// No state has arrived within the link timeout. The link counts as lost until a state arrives.
    LinkLost {
        /// Time since the last state when the thread noticed the loss.
        silence: Duration,
    },
}

/// End of a motion, with data from the newest state.
#[derive(Debug)]
pub struct Ended {
    /// The motion.
    pub motion: MotionId,
    /// End of the motion.
    pub ending: Ending,
    /// `robot_mode` of the newest state.
    pub robot_mode: RobotMode,
    /// Errors that are active at the end.
    pub errors: Errors,
    /// Errors that aborted the motion, if the robot aborted it.
    pub reflex_reason: Errors,
    /// Counts over the motion.
    pub statistics: MotionStatistics,
    /// Times of the motion's cycles, as histograms.
    pub times: Arc<MotionTimes>,
    /// The program, including everything that it has learned.
    pub program: Program,
    /// Last cycles of the motion.
    pub log: ControlLog,
    /// Ticket with which the motion took part in a common start of several robots, if it did.
    pub ticket: Option<StartTicket>,
    /// Observer of the motion's cycles.
    pub observer: Option<Observer>,
}

impl Ended {
    /// Returns the reason why the motion did not begin, if its common start failed.
    pub fn start_fault(&self) -> Option<StartFault> {
        self.ticket.as_ref().and_then(StartTicket::refusal)
    }
}

/// End of a motion, as the control thread saw it. The robot reports the end separately, in its last
/// reply to the `Move` request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The finishing command was sent and the robot left the motion's modes.
    Finished,
    /// The robot left the motion's modes on its own because of a reflex, a stop or a preemption.
    Aborted,
    /// The motion was disarmed ([`Order::Disarm`](super::Order::Disarm)) before it ran.
    Disarmed,
    /// The motion was not armed, because another motion was armed or running.
    Refused,
    /// The robot sent no state within the link timeout.
    LinkLost {
        /// Time since the last state when the thread noticed that the link was lost.
        silence: Duration,
    },
}

/// Queue of events that the thread has not published yet.
///
/// A motion causes at most `Started`, one report per goal, `Failed` or `Finishing`, `Ended` and
/// `LinkLost`, and needs orders from outside. The thread empties the queue in every cycle, unless
/// the receiver has stopped listening. Meanwhile, a link that is lost repeatedly fills only one
/// slot. So the queue always has room for the end of a motion.
#[derive(Debug, Default)]
pub(super) struct EventQueue {
    slots: [Option<Event>; EventQueue::CAPACITY],
    first: usize,
    count: usize,
}

impl EventQueue {
    const CAPACITY: usize = 16;

    /// Appends an event. If the queue is full, leaks the event, because the thread must not free
    /// memory. No motion can start without a listener outside the thread.
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
