//! Latencies of a thread: a histogram, like that of cyclictest.

use core::time::Duration;

/// Latencies of a thread in buckets of a microsecond, up to 2 ms; and exactly the shortest and the
/// longest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Latencies {
    /// The `SCHED_FIFO` priority of the thread; `None` under the normal scheduler.
    pub priority: Option<i32>,
    buckets: Vec<u64>,
    count: u64,
    min: Duration,
    max: Duration,
}

impl Latencies {
    /// None yet, of a thread with this priority.
    pub fn new(priority: Option<i32>) -> Self {
        Self {
            priority,
            buckets: vec![0; BUCKETS],
            count: 0,
            min: Duration::MAX,
            max: Duration::ZERO,
        }
    }

    /// Counts one. Allocates nothing.
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

    /// The shortest one, exactly; `None` if there is none.
    pub fn min(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.min)
    }

    /// The longest one, exactly; `None` if there is none.
    pub fn max(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.max)
    }

    /// The smallest whole number of microseconds that the part `part` (in `[0, 1]`) of latencies,
    /// in whole microseconds, does not exceed; 2000 stands for more. `None` if there is none.
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

    /// How many were at least `us` microseconds, which is 2000 at most.
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
