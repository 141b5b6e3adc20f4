//! `franka bench`: measures this computer, without a robot.

use std::sync::Arc;
use std::time::{Duration, Instant};

use clap::{Args, Subcommand};
use franka_async::control::{Finish, Torques};
use franka_async::doctor::{Host as _, System};
use franka_async::realtime::{Granted, Stats};
use franka_async::record::{CycleFeed, CycleReader};
use franka_async::{MotionError, MotionReport, Realtime, Robot};
use franka_sim::Sim;
use serde_json::json;

use super::test::{quantiles, table, times};
use crate::ending::{Ending, Failure};
use crate::motion::{progress_bar, shown};
use crate::output::Output;
use crate::values::seconds;

/// Measure this computer
#[derive(Debug, Subcommand)]
pub(crate) enum Bench {
    #[command(after_help = "Example: franka bench wake --seconds 60")]
    Wake(Wake),
    #[command(after_help = "Example: franka bench loop --seconds 60")]
    Loop(Loop),
}

/// Measure how late a thread wakes up that sleeps until each millisecond
#[derive(Debug, Args)]
pub(crate) struct Wake {
    /// Duration of the measurement
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "10")]
    seconds: Duration,
    #[command(flatten)]
    output: Output,
}

/// Measure the control loop against a simulated robot in this process
#[derive(Debug, Args)]
pub(crate) struct Loop {
    /// Duration of the measurement
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "10")]
    seconds: Duration,
    #[command(flatten)]
    output: Output,
}

impl Bench {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        match self {
            Self::Wake(wake) => wake.run(),
            Self::Loop(bench) => bench.run().await,
        }
    }
}

impl Wake {
    fn run(self) -> anyhow::Result<Ending> {
        let bar = progress_bar();
        let measured = System::default().wake_ups(self.seconds, &mut |part| {
            bar.set_position((part * 1000.0) as u64);
        });
        bar.finish_and_clear();
        let late = measured.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
        let priority = late.priority;
        let quantile = |part| late.quantile(part).expect("at least one wake-up");
        let [p50, p99, p999] = [0.5, 0.99, 0.999].map(quantile);
        let max = late.max().expect("at least one wake-up").as_micros() as u64;
        let value = json!({
            "wakes": late.count(),
            "priority": priority,
            "late_us": { "p50": p50, "p99": p99, "p999": p999, "max": max },
        });
        self.output.print(&value, || {
            format!(
                "{} wake-ups under {}\nlate by        {}",
                late.count(),
                scheduling(priority),
                times(&value["late_us"])
            )
        })
    }
}

impl Loop {
    async fn run(self) -> anyhow::Result<Ending> {
        // The simulated robot waits for the late commands of a busy computer instead of stopping.
        let sim = Sim::fr3().wait_for_commands(PATIENCE);
        let DryRun {
            outcome,
            stats,
            granted,
            ..
        } = shown("measuring", self.seconds, dry_run(sim, self.seconds)).await?;
        let report = outcome?;
        let value = json!({
            "robot": "simulated FR3 in this process",
            "priority": granted.priority,
            "success_rate": { "min": report.success_rate_min, "avg": report.success_rate_avg },
            "lost": report.lost_states,
            "skipped": report.skipped_states,
            "interval_us": quantiles(&stats.interval),
            "turnaround_us": quantiles(&stats.turnaround),
        });
        self.output.print(&value, || {
            format!(
                "{}scheduling     {}",
                table(&value),
                scheduling(granted.priority)
            )
        })
    }
}

/// Returns a text for the scheduling of a thread that has this `SCHED_FIFO` priority.
fn scheduling(priority: Option<i32>) -> String {
    match priority {
        Some(priority) => format!("SCHED_FIFO {priority}"),
        None => "normal scheduling".to_owned(),
    }
}

/// Result of a control loop with a simulated robot.
pub(super) struct DryRun {
    pub(super) outcome: Result<MotionReport, MotionError>,
    pub(super) stats: Arc<Stats>,
    /// Rights that the operating system granted to the control thread.
    pub(super) granted: Arc<Granted>,
    /// Time at which each command left, with the `message_id` of the state that it answers.
    pub(super) left: Vec<(u64, Instant)>,
}

/// Runs the control loop in this process for `length`, with the simulated robot `sim`.
pub(super) async fn dry_run(sim: Sim, length: Duration) -> anyhow::Result<DryRun> {
    let failed = |error: std::io::Error| Failure::new(Ending::Host, error.to_string());
    let sim = sim.start().await.map_err(failed)?;
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.connect().await?;
    let cycles = robot.cycles(CycleFeed::<()>::DEFAULT_CAPACITY)?;
    let left = tokio::task::spawn_blocking(|| departures(cycles));
    let mut time = Duration::ZERO;
    let control = robot.control_torques(move |_, step| {
        time += step;
        Torques([0.0; 7]).finish_if(time >= length)
    });
    let outcome = control.await;
    let (stats, granted) = (robot.stats(), robot.granted());
    robot.shutdown().await;
    sim.stop().await;
    Ok(DryRun {
        outcome,
        stats,
        granted,
        left: left.await?,
    })
}

/// Returns the times at which commands left. Blocks until the connection ends.
fn departures(mut cycles: CycleReader) -> Vec<(u64, Instant)> {
    let mut left = Vec::new();
    while !cycles.has_ended() {
        cycles.wait(Duration::from_millis(100));
        while let Some(cycle) = cycles.pop() {
            let turnaround = cycle.record.turnaround;
            if !turnaround.is_zero() {
                left.push((cycle.state.message_id, cycle.received + turnaround));
            }
        }
    }
    left
}

/// Time limit for a command of a busy computer.
const PATIENCE: Duration = Duration::from_secs(1);
