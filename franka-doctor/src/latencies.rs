//! Latencies of a thread: a histogram, as in cyclictest.

use core::time::Duration;

/// Latencies of a thread: counts in buckets of one microsecond up to 2 ms, and the exact minimum
/// and maximum.
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
    /// Creates an empty histogram for a thread with this priority.
    pub fn new(priority: Option<i32>) -> Self {
        Self {
            priority,
            buckets: vec![0; BUCKETS],
            count: 0,
            min: Duration::MAX,
            max: Duration::ZERO,
        }
    }

    /// Adds a latency. This allocates nothing.
    pub fn note(&mut self, latency: Duration) {
        let us = usize::try_from(latency.as_micros()).unwrap_or(usize::MAX);
        self.buckets[us.min(BUCKETS - 1)] += 1;
        self.count += 1;
        self.min = self.min.min(latency);
        self.max = self.max.max(latency);
    }

    /// Number of latencies.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The exact minimum; `None` without latencies.
    pub fn min(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.min)
    }

    /// The exact maximum; `None` without latencies.
    pub fn max(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.max)
    }

    /// Returns the quantile `part`, in `[0, 1]`, in whole microseconds: the smallest number that at
    /// least this share of the latencies does not exceed. 2000 stands for all larger latencies.
    /// `None` without latencies.
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

    /// Number of latencies of at least `us` microseconds. `us` must be at most 2000.
    pub fn at_least(&self, us: usize) -> u64 {
        self.buckets[us.min(BUCKETS - 1)..].iter().sum()
    }

    /// Returns each latency that occurred, in microseconds, with its count.
    pub fn buckets(&self) -> impl Iterator<Item = (usize, u64)> + '_ {
        let counts = self.buckets.iter().copied().enumerate();
        counts.filter(|(_, count)| *count > 0)
    }
}

/// Number of buckets: one for each microsecond below 2 ms, and one for all larger latencies.
const BUCKETS: usize = 2001;
