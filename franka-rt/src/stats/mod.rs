//! Counts and times of the loop, always on.
//!
//! ```text
//!  due          received                           left      published  prepared
//!   |--- late ---|--- turnaround --------------------|          |          |
//!   |            | orders | decode | program | send  | publish  | prepare  |
//!   |------------------------------- 1 ms -------------------------------------|-- next state
//!                                                    |-------- slack ----------|   due
//! ```
//!
//! One writer, the thread; readers anywhere, at any time, without a lock. Every counter is a
//! separate atomic, so a reader may see a cycle half counted: the numbers are for display. The
//! histograms are arrays of atomics with logarithmic buckets rather than the `hdrhistogram`
//! crate's, whose plain cells a reader could only see through a lock or a copy made by the thread.
//! Values that must be consistent, a cycle or the counts of a motion, cross in a
//! [`slot`](crate::slot).
//!
//! * [`Histogram`]: durations in logarithmic buckets. [`CycleTimes`]: one cycle and its phases.
//! * [`MotionStatistics`]: counts over the running time of one motion.
//! * `lateness`: when the next state is due. `meter`: the writing side of it all.

mod cycle;
mod histogram;
mod laps;
mod lateness;
mod meter;
mod motion;

use core::sync::atomic::{AtomicU64, Ordering};

pub use cycle::{CycleTimes, Phase, Phases, Slack};
pub use histogram::{Histogram, Quantiles};
pub use meter::Arrival;
pub use motion::{MotionStatistics, MotionTimes};

pub(crate) use laps::Laps;
pub(crate) use meter::Meter;

use crate::slot::{Read, SlotReader, Words};

/// Counts and measurements of the loop since it started.
#[derive(Debug)]
pub struct Stats {
    /// Turns of the loop, with a state or without. While they stand still, a control function does
    /// not return, or the thread is not scheduled.
    pub turns: Counter,
    /// States received and handed to the driver.
    pub states: Counter,
    /// Commands sent.
    pub commands: Counter,
    /// States that were received but skipped for a newer state that had arrived too.
    pub skipped: Counter,
    /// States that never arrived, by the gaps in `message_id`, without those skipped.
    pub lost: Counter,
    /// States not newer than the newest: overtaken or duplicate ones.
    pub stale: Counter,
    /// Datagrams from elsewhere than the robot.
    pub foreign: Counter,
    /// Datagrams of the robot too short for a state, or not decodable as one.
    pub malformed: Counter,
    /// Receives that failed with an error; an empty socket is not one.
    pub receive_errors: Counter,
    /// Commands that could not be sent.
    pub send_errors: Counter,
    /// Records dropped because their ring was full.
    pub records_lost: Counter,
    /// States dropped from the ring of all states because it was full. They were answered, and the
    /// newest of them published.
    pub states_lost: Counter,
    /// Reports of the loop itself (not of the driver) dropped because the queue was full.
    pub reports_lost: Counter,
    /// Times between two states in a row, by this host's clock.
    pub interval: Histogram,
    /// Times from the receipt of a state to the departure of its command.
    pub turnaround: Histogram,
    /// Times from the departure of a command to when the next state was due: see
    /// [`CycleTimes::slack`]. A command that left later than that counts as zero here, and in
    /// [`Self::overrun`].
    pub slack: Histogram,
    /// Times by which commands left after the next state was due; one value per overrun.
    pub overrun: Histogram,
    worst: SlotReader<CycleTimes>,
    overran: SlotReader<CycleTimes>,
    motion: SlotReader<MotionStatistics>,
}

impl Stats {
    /// The cycle with the longest [`CycleTimes::total`] so far; `None` before the first command.
    pub fn worst_cycle(&self) -> Option<CycleTimes> {
        newest(&self.worst)
    }

    /// The newest cycle whose command left after the next state was due; `None` without such a
    /// cycle.
    pub fn newest_overrun(&self) -> Option<CycleTimes> {
        newest(&self.overran)
    }

    /// The present motion so far, or the last one; `None` before the first. After a motion has
    /// ended, the state that showed its end is not counted here: its report counts it.
    pub fn motion(&self) -> Option<MotionStatistics> {
        newest(&self.motion)
    }
}

/// Returns the newest value of a slot. Reads through a clone: the reader itself is shared.
fn newest<T: Words>(slot: &SlotReader<T>) -> Option<T> {
    match slot.clone().read_retry(ATTEMPTS) {
        Read::Newer(value) => Some(value),
        Read::Same | Read::Torn => None,
    }
}

/// Attempts to read. One fails if this thread is delayed until the value has been replaced twice.
const ATTEMPTS: usize = 16;

/// A count with one writer.
#[derive(Debug, Default)]
pub struct Counter(AtomicU64);

impl Counter {
    /// The count now.
    pub fn get(&self) -> u64 {
        // Relaxed: no other memory is read depending on this value.
        self.0.load(Ordering::Relaxed)
    }

    /// Adds, wrapping. For the one writer only: a load and a store, without the cost of a
    /// read-modify-write.
    pub(crate) fn add(&self, more: u64) {
        if more != 0 {
            self.0
                .store(self.get().wrapping_add(more), Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_adds_up() {
        let counter = Counter::default();
        counter.add(3);
        counter.add(0);
        counter.add(4);
        assert_eq!(counter.get(), 7);
    }
}
