//! Recorded cycles at a different rate.

use super::{Cycles, RecordingError};
use crate::Cycle;

/// Iterator over cycles at a constant rate (see
/// [`RobotRecording::resampled`](super::RobotRecording::resampled)).
#[derive(Debug)]
pub struct Resampled {
    cycles: Cycles,
    /// Time between two samples, `[ms]` of the robot's clock.
    period: f64,
    /// Newest cycle that is not later than the next sample.
    held: Option<Cycle>,
    next: Option<Cycle>,
    /// Robot time of the first sample.
    first: u64,
    samples: u64,
}

impl Resampled {
    pub(super) fn of(cycles: Cycles, rate: f64) -> Self {
        // With an invalid rate, the iterator returns every cycle.
        let period = if rate > 0.0 { 1e3 / rate } else { 1.0 };
        Self {
            cycles,
            period: period.max(1.0),
            held: None,
            next: None,
            first: 0,
            samples: 0,
        }
    }

    fn begin(&mut self, cycle: Cycle) {
        self.first = cycle.record.time;
        self.samples = 0;
        self.held = Some(cycle);
    }

    fn due(&self) -> f64 {
        self.first as f64 + self.samples as f64 * self.period
    }
}

impl Iterator for Resampled {
    type Item = Result<Cycle, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let due = self.due();
            if let (Some(held), Some(next)) = (self.held, self.next) {
                let (before, after) = (held.record.time, next.record.time);
                // The robot was restarted, or many consecutive cycles are missing.
                if after < before || after - before > GAP_MAX_MS {
                    self.next = None;
                    self.begin(next);
                    self.samples = 1;
                    return Some(Ok(next));
                }
                if after as f64 > due {
                    self.samples += 1;
                    return Some(Ok(held));
                }
                (self.held, self.next) = (self.next, None);
            }
            match self.cycles.next() {
                Some(Ok(cycle)) if self.held.is_none() => self.begin(cycle),
                Some(Ok(cycle)) => self.next = Some(cycle),
                Some(Err(error)) => return Some(Err(error)),
                None => {
                    let last = self.held.take()?;
                    return (last.record.time as f64 >= due).then_some(Ok(last));
                }
            }
        }
    }
}

/// Longest gap that is filled with the cycle before it, `[ms]`.
const GAP_MAX_MS: u64 = 10_000;
