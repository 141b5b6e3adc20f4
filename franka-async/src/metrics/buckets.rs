//! Converts histograms into the buckets of the text.

use std::time::Duration;

use franka_rt::stats::Histogram;

/// A histogram of the control thread, in the buckets of the text, in seconds.
#[derive(Debug, PartialEq)]
pub(super) struct Buckets {
    /// The bound of each bucket, and the number of durations between it and the previous bound.
    pub(super) counts: Vec<(f64, u64)>,
    /// Sum of all durations, `[s]`.
    pub(super) sum: f64,
}

impl Buckets {
    pub(super) fn of(histogram: &Histogram) -> Self {
        Self::regrouped(histogram.buckets())
    }

    fn regrouped(fine: impl Iterator<Item = (Duration, u64)>) -> Self {
        let bounds = BOUNDS.into_iter().chain([f64::INFINITY]);
        let mut counts: Vec<_> = bounds.map(|bound| (bound, 0)).collect();
        let mut sum = 0.0;
        for (longest, count) in fine {
            let longest = longest.as_secs_f64();
            let bucket = counts.partition_point(|(bound, _)| *bound < longest);
            counts[bucket].1 += count;
            sum += count as f64 * longest * MIDDLE;
        }
        Self { counts, sum }
    }
}

/// Upper bounds of the buckets, `[s]`; they are close together around the cycle of a millisecond.
const BOUNDS: [f64; 11] = [
    5e-5, 1e-4, 2e-4, 3e-4, 5e-4, 7.5e-4, 1e-3, 1.25e-3, 2e-3, 5e-3, 1e-2,
];

/// Middle of a bucket of the control thread, as a share of the longest duration in it.
const MIDDLE: f64 = 1.0 - 1.0 / 32.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_duration_is_in_the_bucket_below_whose_bound_it_lies() {
        let micros = [
            (49, 1),
            (51, 2),
            (100, 4),
            (980, 8),
            (1010, 16),
            (90_000, 32),
        ];
        let fine = micros.map(|(longest, count)| (Duration::from_micros(longest), count));
        let Buckets { counts, sum } = Buckets::regrouped(fine.into_iter());
        let at = |bound| {
            counts
                .iter()
                .find(|(b, _)| *b == bound)
                .map(|found| found.1)
        };
        assert_eq!(at(5e-5), Some(1));
        assert_eq!(at(1e-4), Some(2 + 4));
        assert_eq!(at(1e-3), Some(8));
        assert_eq!(at(1.25e-3), Some(16));
        assert_eq!(at(f64::INFINITY), Some(32));
        let all: u64 = counts.iter().map(|(_, count)| count).sum();
        assert_eq!(all, 63);
        let exact: f64 = micros
            .iter()
            .map(|(t, count)| *t as f64 * 1e-6 * *count as f64)
            .sum();
        assert!((sum / exact - MIDDLE).abs() < 1e-12, "{sum} for {exact}");
    }
}
