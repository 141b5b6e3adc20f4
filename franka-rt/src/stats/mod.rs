//! Counts and times of the loop, always collected.
//!
//! ```text
//!  due          received                           left      published  prepared
//!   |--- late ---|--- turnaround --------------------|          |          |
//!   |            | orders | decode | program | send  | publish  | prepare  |
//!   |------------------------------- 1 ms -------------------------------------|-- next state
//!                                                    |-------- slack ----------|   due
//! ```
//!
//! The thread is the only writer. Readers may read anywhere, at any time, without a lock. Every
//! counter is a separate atomic, so a reader may see a partly counted cycle: the numbers are for
//! display. The histograms are arrays of atomics with logarithmic buckets. A reader of the
//! `hdrhistogram` crate's plain cells would need a lock or a copy made by the thread. Values that
//! must be consistent, a cycle or the counts of a motion, are passed through a
//! [`slot`](crate::slot).
//!
//! * [`Histogram`]: durations in logarithmic buckets. [`CycleTimes`]: one cycle and its phases.
//! * [`MotionStatistics`]: counts over the running time of one motion.
//! * `arrivals`: when the next state is due. `meter`: the writing side of all of them.

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
    /// Turns of the loop, with a state or without. While the number stands still, a control
    /// function does not return, or the thread is not scheduled.
    pub turns: Counter,
    /// States received and passed to the driver.
    pub states: Counter,
    /// Commands sent.
    pub commands: Counter,
    /// States that were received but skipped, because a newer state had arrived, too.
    pub skipped: Counter,
    /// States that never arrived, by the gaps in `message_id`, minus the skipped states.
    pub lost: Counter,
    /// States that are not newer than the newest: overtaken or duplicate states.
    pub stale: Counter,
    /// Datagrams from other addresses than the robot's.
    pub foreign: Counter,
    /// Datagrams of the robot that are too short for a state, or cannot be decoded.
    pub malformed: Counter,
    /// Receives that failed with an error. An empty socket is no error.
    pub receive_errors: Counter,
    /// Commands that could not be sent.
    pub send_errors: Counter,
    /// Records dropped because their ring was full.
    pub records_lost: Counter,
    /// States dropped from the ring of all states because the ring was full. They were answered,
    /// and the newest of them was published.
    pub states_lost: Counter,
    /// Reports of the loop itself (not of the driver) that were dropped because the queue was full.
    pub reports_lost: Counter,
    /// Times between two consecutive states, by this host's clock.
    pub interval: Histogram,
    /// Times from the receipt of a state to the departure of its command.
    pub turnaround: Histogram,
    /// Times from the departure of a command to the moment when the next state was due: see
    /// [`CycleTimes::slack`]. A command that left later than that counts as zero here, and also in
    /// [`Self::overrun`].
    pub slack: Histogram,
    /// Times by which commands left after the next state was due; one value per overrun.
    pub overrun: Histogram,
    worst: SlotReader<CycleTimes>,
    overran: SlotReader<CycleTimes>,
    motion: SlotReader<MotionStatistics>,
}

impl Stats {
    /// Returns the cycle with the longest [`CycleTimes::total`] so far; `None` before the first
    /// command.
    pub fn worst_cycle(&self) -> Option<CycleTimes> {
        newest(&self.worst)
    }

    /// Returns the newest cycle whose command left after the next state was due; `None` without
    /// such a cycle.
    pub fn newest_overrun(&self) -> Option<CycleTimes> {
        newest(&self.overran)
    }

    /// Returns the counts of the present motion so far, or of the last one; `None` before the first
    /// motion. The state that shows the end of a motion is not counted here, but in the motion's
    /// report.
    pub fn motion(&self) -> Option<MotionStatistics> {
        newest(&self.motion)
    }
}

/// Returns the newest value of a slot. Reads through a clone, because the reader itself is shared.
fn newest<T: Words>(slot: &SlotReader<T>) -> Option<T> {
    match slot.clone().read_retry(ATTEMPTS) {
        Read::Newer(value) => Some(value),
        Read::Same | Read::Torn => None,
    }
}

/// Attempts to read. One attempt fails if this thread is delayed until the value was replaced
/// twice.
const ATTEMPTS: usize = 16;

/// A counter with one writer.
#[derive(Debug, Default)]
pub struct Counter(AtomicU64);

impl Counter {
    /// Returns the present count.
    pub fn get(&self) -> u64 {
        // Relaxed: no other memory is read depending on this value.
        self.0.load(Ordering::Relaxed)
    }

    /// Adds to the count, wrapping. Only for the one writer: a load and a store are cheaper than a
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
