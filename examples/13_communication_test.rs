//! Tests the network and this computer for control at 1 kHz. It commands zero torques for some
//! seconds, under which the arm stays where it is, since the robot compensates gravity. It counts
//! losses and measures times.
//!
//! ```text
//! cargo run --release --example communication_test -- \
//!     [ADDRESS] [--seconds 10] [--good 0.95] [--usable 0.9]
//! ```
//! Exit code 0: the average success rate is at least `--good`; 3: it is lower, but at least
//! `--usable`; 4: it is below `--usable`; 1: the test did not run to its end; 2: an error on the
//! command line.

use std::process::ExitCode;

use clap::Parser;
use franka_async::control::{Finish, Torques};
use franka_async::record::{Activity, Record};
use franka_examples::{Connection, Summary};
use franka_rt::stats::Histogram;
use tokio::sync::broadcast;
use tokio::sync::broadcast::error::RecvError;

#[derive(Parser)]
#[command(after_help = "Exit code: 0 good, 3 usable, 4 not usable, 1 the test failed to run.")]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// How long to test, `[s]`.
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
    /// Average success rate that counts as good, in [0, 1].
    #[arg(long, default_value_t = 0.95)]
    good: f64,
    /// Average success rate that counts as usable, in [0, 1].
    #[arg(long, default_value_t = 0.9)]
    usable: f64,
}

#[tokio::main]
async fn main() -> anyhow::Result<ExitCode> {
    let arguments = Arguments::parse();
    let what = "is left to itself, without torques beyond those against gravity";
    let (robot, _sim) = arguments.connection.open_ready(what).await?;

    let watching = tokio::spawn(watch(robot.records()));
    let mut time = 0.0;
    let nothing = robot.control_torques(move |_, step| {
        time += step.as_secs_f64();
        Torques([0.0; 7]).finish_if(time >= arguments.seconds)
    });
    let report = nothing.await?;
    robot.shutdown().await; // which also ends the records
    let best = watching.await?;

    println!("{}", Summary(&report));
    let (worst, average) = (report.success_rate_min, report.success_rate_avg);
    println!("success rate: min {worst:.2}, avg {average:.4}, max {best:.2}");
    println!("over the whole connection:");
    print_times("  between two states", &robot.stats().interval);
    print_times("  from state to command", &robot.stats().turnaround);
    let (verdict, code) = if average >= arguments.good {
        ("good", 0)
    } else if average >= arguments.usable {
        ("usable, but motions will be rough, and may be stopped", 3)
    } else {
        ("not usable: see the chapter on the real-time set-up", 4)
    };
    println!("{verdict}");
    Ok(ExitCode::from(code))
}

/// Prints losses when they occur; returns the highest success rate that the robot has reported.
async fn watch(mut records: broadcast::Receiver<Record>) -> f64 {
    let mut best: f64 = 0.0;
    loop {
        match records.recv().await {
            Ok(record) if record.activity == Activity::Running => {
                best = best.max(record.success_rate);
                if record.skipped > 0 {
                    println!("{} ms: lost {} states", record.time, record.skipped);
                }
            }
            Ok(_) => {}
            Err(RecvError::Lagged(missed)) => println!("{missed} records were missed"),
            Err(RecvError::Closed) => return best,
        }
    }
}

fn print_times(what: &str, times: &Histogram) {
    let at = |quantile| times.quantile(quantile).unwrap_or_default();
    println!(
        "{what}: median {:?}, 99 % {:?}, 99.9 % {:?}, max {:?}",
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
}
