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
//! Only the thread writes. Any thread may read at any time, without a lock. Every counter is a
//! separate atomic, so a reader may see a partly counted cycle: the numbers are for display. The
//! histograms are arrays of atomics with logarithmic buckets, because the plain cells of the
//! `hdrhistogram` crate would need a lock or a copy by the thread. Values that must be consistent,
//! such as a cycle or the counts of a motion, pass through a [`slot`](crate::slot).
//!
//! * [`Histogram`]: durations in logarithmic buckets. [`CycleTimes`]: times of one cycle and its
//!   phases.
//! * [`MotionStatistics`]: counts of one motion while it runs.
//! * `lateness`: when the next state is due. `meter`: the writing side of all statistics.

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

/// Counts and times of the loop since it started.
#[derive(Debug)]
pub struct Stats {
    /// Turns of the loop, with or without a state. If the number does not change, a control
    /// function has not returned, or the thread is not scheduled.
    pub turns: Counter,
    /// States received and passed to the driver.
    pub states: Counter,
    /// Commands sent.
    pub commands: Counter,
    /// States that were received but skipped, because a newer state had also arrived.
    pub skipped: Counter,
    /// States that never arrived: the gaps in `message_id` without the skipped states.
    pub lost: Counter,
    /// States that were not newer than the newest state: overtaken or duplicate states.
    pub stale: Counter,
    /// Datagrams from addresses other than the robot's.
    pub foreign: Counter,
    /// Datagrams from the robot that are too short for a state or cannot be decoded.
    pub malformed: Counter,
    /// Receives that failed with an error. An empty socket does not count.
    pub receive_errors: Counter,
    /// Commands that could not be sent.
    pub send_errors: Counter,
    /// Records that were dropped because their ring was full.
    pub records_lost: Counter,
    /// States that were dropped from the ring of all states because it was full. They were still
    /// answered and published as the newest state.
    pub states_lost: Counter,
    /// Reports of the loop itself, not of the driver, that were dropped because the queue was full.
    pub reports_lost: Counter,
    /// Times between consecutive states, by this host's clock.
    pub interval: Histogram,
    /// Times from the receipt of a state to the departure of its command.
    pub turnaround: Histogram,
    /// Times from the departure of a command until the next state was due: see
    /// [`CycleTimes::slack`]. A command that left too late counts as zero here, and also counts in
    /// [`Self::overrun`].
    pub slack: Histogram,
    /// Times by which commands left after the next state was due; one value for each overrun.
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

    /// Returns the newest cycle whose command left after the next state was due; `None` if there
    /// was no such cycle.
    pub fn newest_overrun(&self) -> Option<CycleTimes> {
        newest(&self.overran)
    }

    /// Returns the counts of the current motion so far, or of the last motion; `None` before the
    /// first motion. The state that shows the end of a motion counts in the motion's report, but
    /// not here.
    pub fn motion(&self) -> Option<MotionStatistics> {
        newest(&self.motion)
    }
}

/// Returns the newest value of a slot. Reads through a clone, because the reader is shared.
fn newest<T: Words>(slot: &SlotReader<T>) -> Option<T> {
    match slot.clone().read_retry(ATTEMPTS) {
        Read::Newer(value) => Some(value),
        Read::Same | Read::Torn => None,
    }
}

/// Number of attempts to read. An attempt fails if the value is replaced twice while it reads.
const ATTEMPTS: usize = 16;

/// A counter with one writer.
#[derive(Debug, Default)]
pub struct Counter(AtomicU64);

impl Counter {
    /// Returns the current count.
    pub fn get(&self) -> u64 {
        // Relaxed: no other memory is read depending on this count.
        self.0.load(Ordering::Relaxed)
    }

    /// Adds to the count and wraps. Only the one writer may call it: a load and a store are cheaper
    /// than a read-modify-write.
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
