//! Measures the effect of a dashboard with viewers on the control thread: a robot in continuous
//! motion, alternately without and with viewers that read and a viewer that never does, in one run.

use std::io::{BufRead as _, BufReader};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::Context as _;
use franka_async::prelude::*;
use franka_dash::Options;
use nix::time::{ClockId, clock_gettime};
use tokio::runtime::Builder;

use crate::process;
use crate::turn::{self, BLOCK, Turn, keep_moving};
use crate::viewers::{READY, VIEWERS};

/// Prints the times of the cycles without and with viewers, `seconds` each, the processor time per
/// viewer, and the growth of memory.
pub(crate) fn print(programs: &Path, seconds: u32) -> anyhow::Result<()> {
    let runtime = Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()?;
    runtime.block_on(measure(programs, seconds))
}

async fn measure(programs: &Path, seconds: u32) -> anyhow::Result<()> {
    let (_simulator, address) = process::simulator(&programs.join("franka-sim"))?;
    let robot = Robot::builder(address).realtime(Realtime::Ignore);
    let robot = robot.connect().await?;
    if robot.granted().priority.is_none() {
        println!("SCHED_FIFO is NOT GRANTED: the control thread competes with all others");
    }
    let options = Options::default();
    let listener = franka_dash::bind("127.0.0.1:0".parse()?, &options).await?;
    let page = listener.local_addr()?;
    let router = franka_dash::router(robot.clone(), options);
    let router = router.into_make_service_with_connect_info::<SocketAddr>();
    tokio::spawn(axum::serve(listener, router).into_future());
    let moving = tokio::spawn(keep_moving(robot.clone()));
    let mut turns = [Turn::default(), Turn::default()];
    let (mut spent, mut memory, mut frames) = ([Duration::ZERO; 2], Vec::new(), 0);
    let blocks = seconds.div_ceil(BLOCK);
    for _ in 0..blocks {
        let before = processor_time()?;
        turns[0].take(&robot).await;
        spent[0] += processor_time()? - before;
        let mut viewers = Viewers::start(programs, page)?;
        let before = processor_time()?;
        turns[1].take(&robot).await;
        spent[1] += processor_time()? - before;
        memory.push(memory_now()?);
        frames += viewers.finish()?;
    }
    anyhow::ensure!(
        !moving.is_finished(),
        "the robot stopped: {:?}",
        moving.await
    );
    moving.abort();
    robot.shutdown().await;

    turn::print(&turns);
    let time = f64::from(blocks * BLOCK);
    let share = |spent: Duration| spent.as_secs_f64() / time * 100.0;
    println!(
        "{VIEWERS} viewers that read {:.1} frames a second each, and one that never reads: {:.2} % of a core \
         with, {:.2} % without, {:.2} % for each viewer",
        frames as f64 / time / VIEWERS as f64,
        share(spent[1]),
        share(spent[0]),
        share(spent[1].saturating_sub(spent[0])) / VIEWERS as f64,
    );
    println!("resident memory with viewers, MiB, every {BLOCK} s: {memory:.1?}");
    Ok(())
}

/// Viewers in a separate process.
struct Viewers(Child);

impl Viewers {
    /// Starts them, and returns when all have received a frame.
    fn start(programs: &Path, page: SocketAddr) -> anyhow::Result<Self> {
        let mut command = Command::new(programs.join("live"));
        command.arg("viewers").arg(page.to_string());
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut viewers = Self(command.spawn()?);
        let ready = viewers.line()?;
        anyhow::ensure!(ready.trim() == READY, "{ready:?}");
        Ok(viewers)
    }

    fn line(&mut self) -> anyhow::Result<String> {
        let output = self.0.stdout.as_mut().context("it is piped")?;
        let mut line = String::new();
        BufReader::new(output).read_line(&mut line)?;
        Ok(line)
    }

    /// Ends them. Returns the number of frames they have read.
    fn finish(&mut self) -> anyhow::Result<u64> {
        drop(self.0.stdin.take());
        Ok(self.line()?.trim().parse()?)
    }
}

impl Drop for Viewers {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Returns the processor time of this process.
fn processor_time() -> anyhow::Result<Duration> {
    Ok(clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID)?.into())
}

/// Returns the resident memory of this process, `[MiB]`.
fn memory_now() -> anyhow::Result<f64> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let mut lines = status.lines();
    let line = lines.find_map(|line| line.strip_prefix("VmRSS:"));
    let kibibytes = line.and_then(|it| it.trim().strip_suffix(" kB"));
    Ok(kibibytes.context("no VmRSS")?.parse::<f64>()? / 1024.0)
}
