//! How late a thread wakes up: a histogram, like that of cyclictest.

use core::time::Duration;

/// Latencies of wake-ups in buckets of a microsecond, up to 2 ms; and the exact maximum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WakeUps {
    /// The `SCHED_FIFO` priority of the thread; `None` under the normal scheduler.
    pub priority: Option<i32>,
    buckets: Vec<u64>,
    count: u64,
    min: Duration,
    max: Duration,
}

impl WakeUps {
    /// No wake-ups yet, of a thread with this priority.
    pub fn new(priority: Option<i32>) -> Self {
        Self {
            priority,
            buckets: vec![0; BUCKETS],
            count: 0,
            min: Duration::MAX,
            max: Duration::ZERO,
        }
    }

    /// Counts a wake-up that was late by `latency`. Allocates nothing.
    pub fn note(&mut self, latency: Duration) {
        let us = usize::try_from(latency.as_micros()).unwrap_or(usize::MAX);
        self.buckets[us.min(BUCKETS - 1)] += 1;
        self.count += 1;
        self.min = self.min.min(latency);
        self.max = self.max.max(latency);
    }

    /// How many were counted.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The shortest latency, exactly; `None` without wake-ups.
    pub fn min(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.min)
    }

    /// The longest latency, exactly; `None` without wake-ups.
    pub fn max(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.max)
    }

    /// The smallest whole number of microseconds that the part `part` (in `[0, 1]`) of latencies,
    /// in whole microseconds, does not exceed; 2000 stands for more. `None` without wake-ups.
    pub fn quantile(&self, part: f64) -> Option<u64> {
        let wanted = (part.clamp(0.0, 1.0) * self.count as f64).ceil().max(1.0) as u64;
        let mut seen = 0;
        for (us, count) in self.buckets.iter().enumerate() {
            seen += count;
            if seen >= wanted {
                return Some(us as u64);
            }
        }
        None
    }

    /// How many were late by at least `us` microseconds, at most 2000.
    pub fn at_least(&self, us: usize) -> u64 {
        self.buckets[us.min(BUCKETS - 1)..].iter().sum()
    }

    /// Each latency in microseconds that occurred, and how often.
    pub fn buckets(&self) -> impl Iterator<Item = (usize, u64)> + '_ {
        let counts = self.buckets.iter().copied().enumerate();
        counts.filter(|(_, count)| *count > 0)
    }
}

/// A bucket for each microsecond below 2 ms, and one for all that is later.
const BUCKETS: usize = 2001;
