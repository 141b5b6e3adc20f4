//! A histogram of durations with logarithmic buckets.

use core::fmt;
use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;

use super::Counter;

/// A histogram of durations, with their exact minimum and maximum. Its resolution is 1/16 of a
/// value, or 1 ns for the smallest values.
///
/// The values from `2^e` to below `2^(e+1)` nanoseconds belong to 16 equal buckets, for each `e >=
/// 4`. All durations of 18 minutes (2^40 ns) and more share the last bucket.
pub struct Histogram {
    buckets: Box<[AtomicU64]>,
    count: Counter,
    min: AtomicU64,
    max: AtomicU64,
}

impl fmt::Debug for Histogram {
    /// Prints the number of durations and the quantiles instead of hundreds of buckets.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Histogram")
            .field("count", &self.count())
            .field("quantiles", &self.quantiles())
            .finish_non_exhaustive()
    }
}

impl Default for Histogram {
    /// Returns an empty histogram. Allocates 5 kB for the buckets.
    fn default() -> Self {
        Self {
            buckets: (0..BUCKETS).map(|_| AtomicU64::new(0)).collect(),
            count: Counter::default(),
            min: AtomicU64::new(u64::MAX),
            max: AtomicU64::new(0),
        }
    }
}

impl Histogram {
    /// Returns the median, the 99th percentile and the maximum; `None` if the histogram is empty.
    /// Do not call it on the real-time thread.
    pub fn quantiles(&self) -> Option<Quantiles> {
        Some(Quantiles {
            p50: self.quantile(0.5)?,
            p99: self.quantile(0.99)?,
            max: self.max()?,
        })
    }

    /// Counts one duration, in constant time and without allocation. Only the one writer may call
    /// it.
    pub(crate) fn note(&self, duration: Duration) {
        let nanos = u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        let bucket = &self.buckets[bucket_of(nanos)];
        // Relaxed throughout: the module describes partly counted cycles.
        bucket.store(
            bucket.load(Ordering::Relaxed).wrapping_add(1),
            Ordering::Relaxed,
        );
        self.min.store(
            self.min.load(Ordering::Relaxed).min(nanos),
            Ordering::Relaxed,
        );
        self.max.store(
            self.max.load(Ordering::Relaxed).max(nanos),
            Ordering::Relaxed,
        );
        self.count.add(1);
    }

    /// Returns the number of durations counted.
    pub fn count(&self) -> u64 {
        self.count.get()
    }

    /// Returns the exact minimum; `None` if the histogram is empty.
    pub fn min(&self) -> Option<Duration> {
        // Do not use the count here: a reader may see it before it sees the minimum.
        let min = self.min.load(Ordering::Relaxed);
        (min != u64::MAX).then(|| Duration::from_nanos(min))
    }

    /// Returns the exact maximum; `None` if the histogram is empty.
    pub fn max(&self) -> Option<Duration> {
        (self.count() > 0).then(|| Duration::from_nanos(self.max.load(Ordering::Relaxed)))
    }

    /// Returns the quantile `quantile`, in `[0, 1]`, rounded up by at most 1/16. `None` if the
    /// histogram is empty. Reads all buckets, so do not call it on the real-time thread.
    pub fn quantile(&self, quantile: f64) -> Option<Duration> {
        let max = self.max()?;
        let wanted = (quantile.clamp(0.0, 1.0) * self.count() as f64)
            .ceil()
            .max(1.0) as u64;
        let mut seen = 0;
        for (index, bucket) in self.buckets.iter().enumerate() {
            seen += bucket.load(Ordering::Relaxed);
            if seen >= wanted {
                return Some(Duration::from_nanos(last_of(index)).min(max));
            }
        }
        Some(max)
    }

    /// Returns the longest duration and the number of durations of each bucket that is not empty,
    /// shortest durations first. The longest duration of a bucket is at most 1/16 above its
    /// shortest. Do not call it on the real-time thread.
    pub fn buckets(&self) -> impl Iterator<Item = (Duration, u64)> + '_ {
        let counts = self.buckets.iter().enumerate();
        counts.filter_map(|(index, bucket)| {
            let count = bucket.load(Ordering::Relaxed);
            (count > 0).then(|| (Duration::from_nanos(last_of(index)), count))
        })
    }
}

/// Median, 99th percentile and maximum of a histogram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Quantiles {
    /// Median, accurate to 1/16.
    pub p50: Duration,
    /// 99th percentile, accurate to 1/16.
    pub p99: Duration,
    /// Exact maximum.
    pub max: Duration,
}

/// log2 of the buckets per power of two.
const FINENESS: u32 = 4;

/// Buckets per power of two.
const PER_OCTAVE: usize = 1 << FINENESS;

/// log2 of a duration, in nanoseconds. All durations from this value upwards share the last bucket.
const OCTAVES_MAX: u32 = 40;

const BUCKETS: usize = (OCTAVES_MAX - FINENESS + 1) as usize * PER_OCTAVE;

fn bucket_of(nanos: u64) -> usize {
    let nanos = nanos.min((1 << OCTAVES_MAX) - 1);
    if nanos < PER_OCTAVE as u64 {
        return nanos as usize;
    }
    let shift = nanos.ilog2() - FINENESS;
    (shift as usize + 1) * PER_OCTAVE + (nanos >> shift) as usize - PER_OCTAVE
}

/// Returns the longest duration that belongs to a bucket, in nanoseconds.
fn last_of(bucket: usize) -> u64 {
    if bucket < PER_OCTAVE {
        return bucket as u64;
    }
    let shift = bucket / PER_OCTAVE - 1;
    let mantissa = (PER_OCTAVE + bucket % PER_OCTAVE) as u64;
    ((mantissa + 1) << shift) - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_follow_each_other_without_gap_or_overlap() {
        let mut first = 0;
        for bucket in 0..BUCKETS {
            let last = last_of(bucket);
            assert_eq!(
                (bucket_of(first), bucket_of(last)),
                (bucket, bucket),
                "{first} to {last}"
            );
            assert!(
                (last - first) as f64 <= first as f64 / 16.0,
                "{first} to {last}"
            );
            first = last + 1;
        }
        assert_eq!(first, 1 << OCTAVES_MAX);
        assert_eq!(bucket_of(u64::MAX), BUCKETS - 1);
    }

    #[test]
    fn histogram_prints_as_one_line() {
        let histogram = Histogram::default();
        histogram.note(Duration::from_micros(7));
        let text = format!("{histogram:?}");
        assert!(text.contains("count: 1") && text.contains("7µs"), "{text}");
        assert!(text.len() < 120, "{text}");
    }

    #[test]
    fn an_empty_histogram_has_no_numbers() {
        let histogram = Histogram::default();
        assert_eq!(
            (histogram.count(), histogram.min(), histogram.max()),
            (0, None, None)
        );
        assert_eq!(histogram.quantile(0.5), None);
        assert_eq!(histogram.quantiles(), None);
    }

    #[test]
    fn quantiles_are_within_a_sixteenth_of_the_sorted_values() {
        let histogram = Histogram::default();
        // The values spread unevenly up to 40 ms, out of order.
        let mut values: Vec<u64> = (0..5000u64)
            .map(|i| 40 + (i * 7919 % 5000).pow(2) * 8 / 5)
            .collect();
        for &value in &values {
            histogram.note(Duration::from_nanos(value));
        }
        values.sort_unstable();
        for quantile in [0.0, 0.01, 0.5, 0.9, 0.99, 1.0] {
            let exact = values[((quantile * 5000.0f64).ceil() as usize).max(1) - 1] as f64;
            let found = histogram.quantile(quantile).expect("not empty").as_nanos() as f64;
            assert!(
                exact <= found && found <= exact * (1.0 + 1.0 / 16.0),
                "{quantile}: {found} for {exact}"
            );
        }
        assert_eq!(histogram.count(), 5000);
        assert_eq!(histogram.min(), Some(Duration::from_nanos(values[0])));
        assert_eq!(histogram.max(), Some(Duration::from_nanos(values[4999])));
        let quantiles = histogram.quantiles().expect("not empty");
        assert_eq!(Some(quantiles.p99), histogram.quantile(0.99));
        assert_eq!(Some(quantiles.max), histogram.max());
        let mut seen = 0;
        for (longest, count) in histogram.buckets() {
            seen += count;
            let up_to = values.partition_point(|&value| u128::from(value) <= longest.as_nanos());
            assert_eq!(seen, up_to as u64, "up to {longest:?}");
        }
        assert_eq!(seen, 5000);
    }

    #[test]
    fn the_largest_durations_keep_their_maximum() {
        let histogram = Histogram::default();
        histogram.note(Duration::from_secs(3600));
        assert_eq!(
            histogram.quantile(0.5),
            Some(Duration::from_nanos((1 << OCTAVES_MAX) - 1))
        );
        assert_eq!(histogram.max(), Some(Duration::from_secs(3600)));
    }
}
