//! How punctual control is, for the page.

use std::time::Duration;

use franka_async::Robot;
use franka_async::realtime::Stats;
use serde::Serialize;

/// Counters and quantiles of the control thread since it was started, `[us]`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Statistics {
    /// Round trip to this page, `[ms]`; `None` before the first one.
    round_trip_ms: Option<f64>,
    /// `None` where another program controls the robot.
    thread: Option<Thread>,
}

#[derive(Clone, Debug, Serialize)]
struct Thread {
    states: u64,
    lost: u64,
    skipped: u64,
    turnaround: Option<Spread>,
    interval: Option<Spread>,
    slack: Option<Spread>,
}

/// Median, 99th percentile and maximum, `[us]`.
#[derive(Clone, Copy, Debug, Serialize)]
struct Spread {
    p50: f64,
    p99: f64,
    max: f64,
}

impl Statistics {
    pub(crate) fn of(robot: Option<&Robot>, round_trip: Option<Duration>) -> Self {
        Self {
            round_trip_ms: round_trip.map(|it| it.as_secs_f64() * 1e3),
            thread: robot.map(|robot| Thread::of(&robot.stats())),
        }
    }
}

impl Thread {
    fn of(stats: &Stats) -> Self {
        let micros = |time: Duration| time.as_secs_f64() * 1e6;
        let spread = |histogram: &franka_async::realtime::Histogram| {
            histogram.quantiles().map(|it| Spread {
                p50: micros(it.p50),
                p99: micros(it.p99),
                max: micros(it.max),
            })
        };
        Self {
            states: stats.states.get(),
            lost: stats.lost.get(),
            skipped: stats.skipped.get(),
            turnaround: spread(&stats.turnaround),
            interval: spread(&stats.interval),
            slack: spread(&stats.slack),
        }
    }
}
