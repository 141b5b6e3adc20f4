//! What the driver tells the world outside.

use core::time::Duration;

use franka_proto::{Errors, RobotMode, RobotState};

use crate::driver::{ControlLog, Failure, MotionId, Program};
use crate::session::SessionEvent;
use crate::together::{StartFault, StartTicket};

/// Something that happened in the thread. Events cross in order and none is dropped.
#[derive(Debug)]
pub enum Event {
    /// The robot shows the modes of the motion; the first command answers that state.
    Started {
        /// The motion.
        motion: MotionId,
        /// `message_id` of that state, `[ms]` of the robot's clock.
        time: u64,
    },
    /// The motion's program reports.
    Program {
        /// The motion.
        motion: MotionId,
        /// What it reports.
        event: SessionEvent,
        /// Counts so far.
        statistics: MotionStatistics,
    },
    /// The finishing command is out for the first time; it is repeated until the robot leaves the motion's modes.
    Finishing {
        /// The motion.
        motion: MotionId,
    },
    /// The motion's program could not go on. No command leaves any more; the robot has to be told to stop.
    Failed {
        /// The motion.
        motion: MotionId,
        /// What went wrong.
        failure: Failure,
    },
    /// The motion is over for the thread. Its program comes along to be freed.
    Ended(Ended),
    /// No state has come for so long that the link counts as lost. A later state revives it.
    LinkLost {
        /// The silence so far.
        silence: Duration,
    },
}

/// How a motion ended, with what the state of that moment said.
#[derive(Debug)]
pub struct Ended {
    /// The motion.
    pub motion: MotionId,
    /// How it ended.
    pub ending: Ending,
    /// `robot_mode` of the newest state.
    pub robot_mode: RobotMode,
    /// Errors that hold now.
    pub errors: Errors,
    /// What aborted the motion, if the robot did.
    pub reflex_reason: Errors,
    /// Counts over the motion.
    pub statistics: MotionStatistics,
    /// The program, with whatever it learned.
    pub program: Program,
    /// Its last cycles.
    pub log: ControlLog,
    /// Its ticket, if it was to begin together with others.
    pub ticket: Option<StartTicket>,
}

impl Ended {
    /// Why the motion did not begin, if that was for want of the others that it was to begin with.
    pub fn start_fault(&self) -> Option<StartFault> {
        self.ticket.as_ref().and_then(StartTicket::refusal)
    }
}

/// How a motion ended, as the thread saw it. The robot's own word on it is its last reply to the `Move`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The finishing command was sent and the robot left the motion's modes.
    Finished,
    /// The robot left the motion's modes by itself: a reflex, a stop, a preemption.
    Aborted,
    /// Disarmed before it ran.
    Disarmed,
    /// Another motion was armed or running; this one never was.
    Refused,
    /// The robot fell silent.
    LinkLost {
        /// The silence when it was given up.
        silence: Duration,
    },
}

/// Counts over the running time of one motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionStatistics {
    /// States answered.
    pub cycles: u64,
    /// States that never arrived or were skipped for a newer one.
    pub lost_states: u64,
    /// Lowest `control_command_success_rate` seen while running, in `[0, 1]`.
    pub success_rate_min: f64,
    success_rate_sum: f64,
    success_rate_count: u64,
    /// `message_id` of the first and the last state.
    span: Option<(u64, u64)>,
    /// Longest time from the receipt of a state to the departure of its command.
    pub worst_turnaround: Duration,
}

impl Default for MotionStatistics {
    fn default() -> Self {
        Self {
            cycles: 0,
            lost_states: 0,
            success_rate_min: 1.0,
            success_rate_sum: 0.0,
            success_rate_count: 0,
            span: None,
            worst_turnaround: Duration::ZERO,
        }
    }
}

impl MotionStatistics {
    /// Mean `control_command_success_rate`, in `[0, 1]`; 1 for a motion too short to show one.
    pub fn success_rate_avg(&self) -> f64 {
        if self.success_rate_count == 0 {
            1.0
        } else {
            self.success_rate_sum / self.success_rate_count as f64
        }
    }

    /// Time from the first state of the motion to the last, `[ms]` of the robot's clock.
    pub fn duration_ms(&self) -> u64 {
        self.span.map_or(0, |(first, last)| last - first)
    }

    /// Counts one state of the running motion. The first and the final state of a motion report a success rate of 0
    /// whatever happened, so zeros do not count.
    pub(super) fn note(&mut self, state: &RobotState, skipped: u64) {
        self.cycles += 1;
        self.lost_states += skipped;
        let rate = state.control_command_success_rate;
        let first = self.span.map_or(state.message_id, |(first, _)| first);
        self.span = Some((first, state.message_id));
        if rate > 0.0 {
            self.success_rate_min = self.success_rate_min.min(rate);
            self.success_rate_sum += rate;
            self.success_rate_count += 1;
        }
    }
}

/// Events that wait for the thread to carry them out.
///
/// A motion causes at most `Started`, a report per goal, `Failed` or `Finishing`, `Ended` and `LinkLost`, and needs orders from
/// outside; the thread empties the queue every cycle unless the world outside has stopped listening altogether. A link
/// that comes and goes meanwhile fills one slot and no more, so that there is room for the end of a motion.
#[derive(Debug, Default)]
pub(super) struct EventQueue {
    slots: [Option<Event>; EventQueue::CAPACITY],
    first: usize,
    count: usize,
}

impl EventQueue {
    const CAPACITY: usize = 16;

    /// Appends. A full queue leaks the event: what it carries must not be freed on the thread, and no motion can
    /// start without somebody outside who listens.
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
    fn a_link_that_comes_and_goes_unheard_leaves_room_for_the_end_of_a_motion() {
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
