//! The writing side of the statistics.

use core::time::Duration;
use std::sync::Arc;
use std::time::Instant;

use super::lateness::Arrivals;
use super::{Counter, CycleTimes, Histogram, MotionStatistics, Stats};
use crate::slot::{self, SlotWriter};

/// Arrival of a state: time since the previous state, and lateness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arrival {
    /// Time since the previous state, by this host's clock; `None` for the first state.
    pub interval: Option<Duration>,
    /// Time by which the state was late: see [`CycleTimes::late`].
    pub late: Duration,
}

/// The writing side of [`Stats`], which the thread owns.
#[derive(Debug)]
pub(crate) struct Meter {
    stats: Arc<Stats>,
    arrivals: Arrivals,
    newest: Option<Newest>,
    /// Longest total time of a cycle so far.
    longest: Duration,
    worst: SlotWriter<CycleTimes>,
    overran: SlotWriter<CycleTimes>,
    motion: SlotWriter<MotionStatistics>,
}

/// The newest state.
#[derive(Clone, Copy, Debug)]
struct Newest {
    time: u64,
    received: Instant,
    late: Duration,
}

impl Meter {
    /// Returns empty statistics. No other method allocates.
    pub(crate) fn new() -> Self {
        let (worst, worst_reader) = slot::slot();
        let (overran, overran_reader) = slot::slot();
        let (motion, motion_reader) = slot::slot();
        let stats = Stats {
            turns: Counter::default(),
            states: Counter::default(),
            commands: Counter::default(),
            skipped: Counter::default(),
            lost: Counter::default(),
            stale: Counter::default(),
            foreign: Counter::default(),
            malformed: Counter::default(),
            receive_errors: Counter::default(),
            send_errors: Counter::default(),
            records_lost: Counter::default(),
            states_lost: Counter::default(),
            reports_lost: Counter::default(),
            interval: Histogram::default(),
            turnaround: Histogram::default(),
            slack: Histogram::default(),
            overrun: Histogram::default(),
            worst: worst_reader,
            overran: overran_reader,
            motion: motion_reader,
        };
        Self {
            stats: Arc::new(stats),
            arrivals: Arrivals::default(),
            newest: None,
            longest: Duration::ZERO,
            worst,
            overran,
            motion,
        }
    }

    pub(crate) fn stats(&self) -> &Arc<Stats> {
        &self.stats
    }

    /// Returns the time when the newest state was received.
    pub(crate) fn heard(&self) -> Option<Instant> {
        self.newest.map(|newest| newest.received)
    }

    /// Counts a state and `skipped` older states that arrived with it. Returns the arrival of the
    /// state.
    pub(crate) fn note_arrival(&mut self, time: u64, received: Instant, skipped: u64) -> Arrival {
        let late = self.arrivals.note(time, received);
        let before = self.newest.replace(Newest {
            time,
            received,
            late,
        });
        self.stats.states.add(1);
        let interval = before.map(|before| {
            let missing = time.saturating_sub(before.time).saturating_sub(1);
            self.stats.lost.add(missing.saturating_sub(skipped));
            received.saturating_duration_since(before.received)
        });
        if let Some(interval) = interval {
            self.stats.interval.note(interval);
        }
        Arrival { interval, late }
    }

    /// Returns the times of the cycle for the newest state, whose command left at `departed`.
    pub(crate) fn answered(&self, departed: Instant) -> CycleTimes {
        let newest = self.newest.expect("only a state that came is answered");
        let turnaround = departed.saturating_duration_since(newest.received);
        CycleTimes::new(newest.time, newest.late, turnaround)
    }

    /// Adds a cycle that sent a command, and publishes the counts of its motion.
    pub(crate) fn note_cycle(&mut self, cycle: &CycleTimes, motion: Option<&MotionStatistics>) {
        self.stats.commands.add(1);
        self.stats.turnaround.note(cycle.turnaround);
        self.stats
            .slack
            .note(cycle.slack.left().unwrap_or_default());
        if let Some(overrun) = cycle.slack.overrun() {
            self.overran.write(cycle);
            // Count after writing the cycle, so that a reader that sees the count also finds the
            // cycle.
            self.stats.overrun.note(overrun);
        }
        if cycle.total() > self.longest {
            self.longest = cycle.total();
            self.worst.write(cycle);
        }
        if let Some(motion) = motion {
            self.motion.write(motion);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::{Phase, Phases};

    const US: fn(u64) -> Duration = Duration::from_micros;

    #[test]
    fn answer_is_measured_from_receipt_and_due_time() {
        let mut meter = Meter::new();
        let start = Instant::now();
        assert_eq!(meter.heard(), None);
        meter.note_arrival(10, start, 0);
        let arrival = meter.note_arrival(14, start + US(4200), 2);
        let expected = Arrival {
            interval: Some(US(4200)),
            late: US(200),
        };
        assert_eq!(arrival, expected);
        assert_eq!(meter.stats().lost.get(), 1, "three are missing, two came");
        assert_eq!(meter.heard(), Some(start + US(4200)));
        let cycle = meter.answered(start + US(4500));
        assert_eq!(
            (cycle.time, cycle.late, cycle.turnaround),
            (14, US(200), US(300))
        );
        assert_eq!(cycle.slack.left(), Some(US(500)));
    }

    #[test]
    fn worst_cycle_keeps_its_phases_beside_newest_overrun() {
        let mut meter = Meter::new();
        let stats = meter.stats().clone();
        assert_eq!((stats.worst_cycle(), stats.newest_overrun()), (None, None));
        let timed = CycleTimes {
            phases: Some(Phases {
                program: US(80),
                publish: US(2000),
                ..Phases::default()
            }),
            ..CycleTimes::new(2, US(5), US(90))
        };
        let late = CycleTimes::new(3, US(900), US(150));
        for cycle in [CycleTimes::new(1, US(30), US(100)), timed, late] {
            meter.note_cycle(&cycle, None);
        }
        assert_eq!(stats.motion(), None);
        let last = CycleTimes::new(4, US(0), US(90));
        let mut motion = MotionStatistics::default();
        motion.note_cycle(&last);
        meter.note_cycle(&last, Some(&motion));
        assert_eq!(stats.motion(), Some(motion));
        assert_eq!(stats.worst_cycle(), Some(timed));
        assert_eq!(timed.longest(), (Phase::Publish, US(2000)));
        assert_eq!(stats.newest_overrun(), Some(late));
        assert_eq!((stats.commands.get(), stats.overrun.count()), (4, 1));
        assert_eq!(stats.overrun.max(), Some(US(50)));
        assert_eq!(stats.slack.count(), 4);
        assert_eq!(stats.slack.min(), Some(Duration::ZERO));
        assert_eq!(stats.slack.max(), Some(US(910)));
        assert_eq!(stats.turnaround.max(), Some(US(150)));
    }
}
