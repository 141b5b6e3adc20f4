//! The punctuality of the control thread, for the page.

use std::collections::BTreeMap;
use std::time::Duration;

use franka_async::Robot;
use franka_async::realtime::{Histogram, Stats};
use serde::Serialize;

/// Counters and quantiles since the control thread was started, `[us]`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Statistics {
    /// Round trip to this page, `[ms]`; `None` before the first measurement.
    round_trip_ms: Option<f64>,
    /// Values of the control thread; `None` if another program controls the robot.
    thread: Option<Thread>,
    /// Values since the previous statistics for this viewer; `None` in the first statistics.
    recent: Option<Recent>,
}

#[derive(Clone, Debug, Serialize)]
struct Thread {
    /// Priority of the thread under `SCHED_FIFO`; `None` if the system did not grant it.
    priority: Option<i32>,
    states: u64,
    lost: u64,
    skipped: u64,
    turnaround: Option<Spread>,
    interval: Option<Spread>,
    slack: Option<Spread>,
}

/// Minimum, median and maximum of the newest cycles, with a resolution of 1/16, `[us]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Recent {
    turnaround: [f64; 3],
    slack: [f64; 3],
}

/// Contents of the histograms at the previous statistics for a viewer.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    turnaround: Buckets,
    slack: Buckets,
}

/// Number of durations up to each bound.
type Buckets = BTreeMap<Duration, u64>;

impl Counts {
    /// Returns the values since the last call; `None` in the first call, and if there are no new
    /// values.
    fn take(&mut self, stats: &Stats) -> Option<Recent> {
        let turnaround = since(&mut self.turnaround, &stats.turnaround);
        let slack = since(&mut self.slack, &stats.slack);
        Some(Recent {
            turnaround: turnaround?,
            slack: slack?,
        })
    }
}

/// Returns the minimum, median and maximum of the values that were added to a histogram since
/// `before`, and updates `before`.
fn since(before: &mut Buckets, histogram: &Histogram) -> Option<[f64; 3]> {
    spread(before, histogram.buckets().collect())
}

fn spread(before: &mut Buckets, now: Buckets) -> Option<[f64; 3]> {
    let before = std::mem::replace(before, now.clone());
    let more = now.into_iter().filter_map(|(duration, count)| {
        // After a reconnect, the counts begin at zero.
        let count = count.saturating_sub(before.get(&duration).copied().unwrap_or(0));
        (count > 0).then_some((duration, count))
    });
    let more: Vec<_> = more.collect();
    let half = more.iter().map(|(_, count)| count).sum::<u64>().div_ceil(2);
    let mut seen = 0;
    let median = more.iter().find(|(_, count)| {
        seen += count;
        seen >= half
    });
    let three = [more.first()?, median?, more.last()?];
    (!before.is_empty()).then(|| three.map(|(duration, _)| micros(*duration)))
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// Median, 99th percentile and maximum, `[us]`.
#[derive(Clone, Copy, Debug, Serialize)]
struct Spread {
    p50: f64,
    p99: f64,
    max: f64,
}

impl Statistics {
    /// Creates the statistics. `before` contains the counts of the previous statistics for this
    /// viewer.
    pub(crate) fn of(
        robot: Option<&Robot>,
        round_trip: Option<Duration>,
        before: &mut Counts,
    ) -> Self {
        Self {
            round_trip_ms: round_trip.map(|it| it.as_secs_f64() * 1e3),
            thread: robot.map(|robot| Thread::of(&robot.stats(), robot.granted().priority)),
            recent: robot.and_then(|robot| before.take(&robot.stats())),
        }
    }
}

impl Thread {
    fn of(stats: &Stats, priority: Option<i32>) -> Self {
        let spread = |histogram: &Histogram| {
            histogram.quantiles().map(|it| Spread {
                p50: micros(it.p50),
                p99: micros(it.p99),
                max: micros(it.max),
            })
        };
        Self {
            priority,
            states: stats.states.get(),
            lost: stats.lost.get(),
            skipped: stats.skipped.get(),
            turnaround: spread(&stats.turnaround),
            interval: spread(&stats.interval),
            slack: spread(&stats.slack),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_covers_only_counts_since_the_last_report() {
        let buckets = |counts: &[(u64, u64)]| -> Buckets {
            let each = counts.iter();
            each.map(|(us, count)| (Duration::from_micros(*us), *count))
                .collect()
        };
        let mut before = Buckets::default();
        assert_eq!(spread(&mut before, buckets(&[(5, 9), (900, 1)])), None);
        let now = buckets(&[(5, 10), (7, 3), (20, 1), (900, 1)]);
        assert_eq!(spread(&mut before, now.clone()), Some([5.0, 7.0, 20.0]));
        assert_eq!(spread(&mut before, now), None, "nothing has come");
        // After a reconnect, the counts begin at zero.
        assert_eq!(spread(&mut before, buckets(&[(6, 2)])), Some([6.0; 3]));
    }
}
