//! Measures the effect of a recorder on the control thread: a robot in continuous motion,
//! alternately with and without a recording of every cycle, in one run.

use std::path::Path;
use std::time::Duration;

use anyhow::Context as _;
use franka_async::prelude::*;
use franka_async::recording::{RecordOptions, Recorder, Track};
use franka_bench::record::processor_time;
use tokio::runtime::Builder;

use crate::process;
use crate::turn::{self, BLOCK, Turn, keep_moving};

/// Prints the times of the cycles without and with a recorder, `seconds` each, and the totals of
/// the recordings. The recordings are written to `directory`, and removed.
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

    turn::print(&turns);
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

/// The totals of recordings.
#[derive(Default)]
struct Recorded {
    cycles: u64,
    dropped: u64,
    bytes: u64,
    /// Processor time of the recorder's threads, until the end of each recording is written.
    processor: Duration,
}
