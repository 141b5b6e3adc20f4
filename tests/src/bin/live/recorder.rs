//! What a recorder costs the control thread: a robot that moves all the time, in turns with and
//! without a recording of every cycle, in one run.

use std::path::Path;
use std::time::Duration;

use anyhow::Context as _;
use franka_async::prelude::*;
use franka_async::recording::{RecordOptions, Recorder, Track};
use franka_tests::bench::record::processor_time;
use hdrhistogram::Histogram;
use tokio::runtime::Builder;
use tokio::time::{Instant, sleep_until};

use crate::process;

/// Prints the times of the cycles without and with a recorder, `seconds` each, and what the
/// recordings came to. They are written to `directory`, and removed.
pub(crate) fn print(program: &Path, directory: &Path, seconds: u32) -> anyhow::Result<()> {
    let runtime = Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()?;
    runtime.block_on(measure(program, directory, seconds))
}

async fn measure(program: &Path, directory: &Path, seconds: u32) -> anyhow::Result<()> {
    let (_simulator, address) = process::simulator(program)?;
    let robot = Robot::builder(address).realtime(Realtime::Ignore);
    let robot = robot.connect().await?;
    if robot.granted().priority.is_none() {
        println!("SCHED_FIFO is NOT GRANTED: the control thread competes with all others");
    }
    let moving = tokio::spawn(keep_moving(robot.clone()));
    let mut turns = [Turn::default(), Turn::default()];
    let mut recorded = Recorded::default();
    for _ in 0..seconds.div_ceil(BLOCK) {
        turns[0].take(&robot).await;
        let path = directory.join(format!("bench-{}.mcap", std::process::id()));
        let recorder = Recorder::to_file(&path, RecordOptions::default())?;
        recorder.attach(&robot, Track::default()).await?;
        turns[1].take(&robot).await;
        recorded.processor += processor_time().context("Linux tells the time of threads")?;
        let status = tokio::task::spawn_blocking(move || recorder.finish()).await??;
        std::fs::remove_file(&path)?;
        recorded.cycles += status.cycles;
        recorded.dropped += status.dropped;
        recorded.bytes += status.bytes;
    }
    anyhow::ensure!(
        !moving.is_finished(),
        "the robot stopped: {:?}",
        moving.await
    );
    moving.abort();
    robot.shutdown().await;

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
    let time = f64::from(seconds.div_ceil(BLOCK) * BLOCK);
    println!(
        "{} cycles recorded, {} dropped; {:.2} GB an hour; {:.2} % of a core",
        recorded.cycles,
        recorded.dropped,
        recorded.bytes as f64 * 3.6e-6 / time,
        recorded.processor.as_secs_f64() / time * 100.0,
    );
    Ok(())
}

/// Moves up and down until the robot refuses.
async fn keep_moving(robot: Robot) -> Result<(), MotionError> {
    loop {
        for height in [0.1, -0.1] {
            robot.move_by(Offset::base([0.0, 0.0, height])).await?;
        }
    }
}

/// What recordings came to.
#[derive(Default)]
struct Recorded {
    cycles: u64,
    dropped: u64,
    bytes: u64,
    /// Of the recorder's threads, until the end of each recording is written.
    processor: Duration,
}

/// The cycles of some blocks of time, in nanoseconds.
struct Turn {
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
    async fn take(&mut self, robot: &Robot) {
        let stats = robot.stats();
        let counted = |times: &mut Histogram<u64>, now: Vec<(Duration, u64)>, before: &[_]| {
            for (longest, count) in now {
                let nanos = u64::try_from(longest.as_nanos()).expect("less than centuries");
                let seen = before.iter().find(|(time, _)| *time == longest);
                let new = count - seen.map_or(0, |(_, seen)| *seen);
                // The maximum counts what was recorded no time, too.
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
const BLOCK: u32 = 10;
