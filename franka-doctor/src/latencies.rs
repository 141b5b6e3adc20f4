//! Histogram of a thread's latencies, as in cyclictest.

use core::time::Duration;

/// Latencies of a thread. The histogram has buckets of one microsecond up to 2 ms. The minimum and
/// the maximum are exact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Latencies {
    /// The `SCHED_FIFO` priority of the thread; `None` if it runs under the normal scheduler.
    pub priority: Option<i32>,
    buckets: Vec<u64>,
    count: u64,
    min: Duration,
    max: Duration,
}

impl Latencies {
    /// Creates an empty histogram for a thread that runs with this priority.
    pub fn new(priority: Option<i32>) -> Self {
        Self {
            priority,
            buckets: vec![0; BUCKETS],
            count: 0,
            min: Duration::MAX,
            max: Duration::ZERO,
        }
    }

    /// Adds a latency. This method does not allocate.
    pub fn note(&mut self, latency: Duration) {
        let us = usize::try_from(latency.as_micros()).unwrap_or(usize::MAX);
        self.buckets[us.min(BUCKETS - 1)] += 1;
        self.count += 1;
        self.min = self.min.min(latency);
        self.max = self.max.max(latency);
    }

    /// Returns the number of latencies.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns the exact minimum; `None` without latencies.
    pub fn min(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.min)
    }

    /// Returns the exact maximum; `None` without latencies.
    pub fn max(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.max)
    }

    /// Returns the quantile `part`, in `[0, 1]`, in whole microseconds; `None` without latencies.
    /// It is the smallest number of microseconds such that at least the share `part` of the
    /// latencies is less than or equal to this number. A result of 2000 means 2000 or more.
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

    /// Returns the number of latencies of at least `us` microseconds. `us` must not exceed 2000.
    pub fn at_least(&self, us: usize) -> u64 {
        self.buckets[us.min(BUCKETS - 1)..].iter().sum()
    }

    /// Returns each latency that occurred, in microseconds, and how often it occurred.
    pub fn buckets(&self) -> impl Iterator<Item = (usize, u64)> + '_ {
        let counts = self.buckets.iter().copied().enumerate();
        counts.filter(|(_, count)| *count > 0)
    }
}

/// Number of buckets: one for each microsecond below 2 ms, and one for all longer latencies.
const BUCKETS: usize = 2001;
