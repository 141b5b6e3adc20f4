//! The cycles of a robot in continuous motion, alternately without and with another load.

use std::time::Duration;

use franka_async::prelude::*;
use hdrhistogram::Histogram;
use tokio::time::{Instant, sleep_until};

/// Moves up and down until the robot refuses.
pub(crate) async fn keep_moving(robot: Robot) -> Result<(), MotionError> {
    loop {
        for height in [0.1, -0.1] {
            robot.move_by(Offset::base([0.0, 0.0, height])).await?;
        }
    }
}

/// Prints the times of the cycles without and with the load.
pub(crate) fn print(turns: &[Turn; 2]) {
    println!("microseconds        states   lost     p50     p99   p99.9      max");
    for (turn, name) in turns.iter().zip(["without", "with"]) {
        for (what, times) in [
            ("turnaround", &turn.turnaround),
            ("interval", &turn.interval),
        ] {
            let us = |nanos: u64| nanos as f64 * 1e-3;
            println!(
                "{name:<8} {what:<10} {:>6} {:>6} {:>7.1} {:>7.1} {:>7.1} {:>8.1}",
                times.len(),
                turn.lost,
                us(times.value_at_quantile(0.5)),
                us(times.value_at_quantile(0.99)),
                us(times.value_at_quantile(0.999)),
                us(times.max()),
            );
        }
    }
}

/// The cycles of some blocks of time, in nanoseconds.
pub(crate) struct Turn {
    turnaround: Histogram<u64>,
    interval: Histogram<u64>,
    lost: u64,
}

impl Default for Turn {
    fn default() -> Self {
        let empty = || Histogram::new(3).expect("three digits can be had");
        Self {
            turnaround: empty(),
            interval: empty(),
            lost: 0,
        }
    }
}

impl Turn {
    /// Adds a block.
    pub(crate) async fn take(&mut self, robot: &Robot) {
        let stats = robot.stats();
        let counted = |times: &mut Histogram<u64>, now: Vec<(Duration, u64)>, before: &[_]| {
            for (longest, count) in now {
                let nanos = u64::try_from(longest.as_nanos()).expect("less than centuries");
                let seen = before.iter().find(|(time, _)| *time == longest);
                let new = count - seen.map_or(0, |(_, seen)| *seen);
                // The maximum also counts cycles without a recorded time.
                if new > 0 {
                    times.record_n(nanos, new).expect("it grows as it needs");
                }
            }
        };
        let buckets = || {
            (
                stats.turnaround.buckets().collect(),
                stats.interval.buckets().collect(),
            )
        };
        let (turnaround, interval): (Vec<_>, Vec<_>) = buckets();
        let lost = stats.lost.get();
        sleep_until(Instant::now() + Duration::from_secs(BLOCK.into())).await;
        let (turnaround_now, interval_now) = buckets();
        counted(&mut self.turnaround, turnaround_now, &turnaround);
        counted(&mut self.interval, interval_now, &interval);
        self.lost += stats.lost.get() - lost;
    }
}

/// Length of a block, `[s]`.
pub(crate) const BLOCK: u32 = 10;
