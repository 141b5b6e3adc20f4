//! Tests the network and this computer for control at 1 kHz, with one robot or two at the same
//! time. It commands zero torques for some seconds; the arm stays in place, because the robot
//! compensates gravity. It counts losses and measures times.
//!
//! ```text
//! cargo run --release --example link_test -- \
//!     [ADDRESS [OTHER]] [--two] [--seconds 10] [--good 0.95] [--usable 0.9]
//! ```
//! Exit code 0: the average success rate is at least `--good`; 3: it is lower, but at least
//! `--usable`; 4: it is below `--usable`; 1: the test was not completed; 2: an error on the command
//! line. With two robots the worse result counts.

use std::process::ExitCode;

use clap::Parser;
use franka_async::control::{Finish, Torques};
use franka_async::realtime::Histogram;
use franka_async::record::{Activity, Record};
use franka_async::{MotionReport, Robot};
use franka_examples::Connection;
use tokio::sync::broadcast;
use tokio::sync::broadcast::error::RecvError;

#[derive(Parser)]
#[command(after_help = "Exit code: 0 good, 3 usable, 4 not usable, 1 the test failed to run.")]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Address of the other robot, which uses the same options.
    #[arg(requires = "address")]
    other: Option<String>,
    /// Two simulated robots instead of one.
    #[arg(long, conflicts_with = "address")]
    two: bool,
    /// Duration of the test, `[s]`.
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
    /// Average success rate that counts as good, in [0, 1].
    #[arg(long, default_value_t = 0.95)]
    good: f64,
    /// Average success rate that counts as usable, in [0, 1].
    #[arg(long, default_value_t = 0.9)]
    usable: f64,
}

/// The result of one robot's test.
struct Measured {
    robot: Robot,
    report: MotionReport,
    /// The highest success rate reported by the robot.
    best: f64,
}

#[tokio::main]
async fn main() -> anyhow::Result<ExitCode> {
    let Arguments {
        connection,
        other,
        two,
        seconds,
        good,
        usable,
    } = Arguments::parse();
    let what = "is left to itself, without torques beyond those against gravity";
    let another = (two || other.is_some()).then(|| Connection {
        address: other,
        ..connection.clone()
    });
    let (robot, _sim) = connection.open_ready(what).await?;
    let measured = match another {
        None => vec![measure(&robot, seconds).await?],
        Some(another) => {
            let (another, _another_sim) = another.open_ready(what).await?;
            // If one motion fails, `try_join` drops the other, which stops its robot.
            let both = tokio::try_join!(measure(&robot, seconds), measure(&another, seconds));
            both.map(|(one, other)| vec![one, other])?
        }
    };

    for (name, figure) in FIGURES {
        print(&measured, name, figure);
    }
    println!("over the whole connection");
    for (name, quantile) in QUANTILES {
        let (interval, turnaround) = (format!("interval, {name}"), format!("turnaround, {name}"));
        print(&measured, &interval, |of| {
            at(&of.robot.stats().interval, quantile)
        });
        print(&measured, &turnaround, |of| {
            at(&of.robot.stats().turnaround, quantile)
        });
    }
    let rates = measured.iter().map(|of| of.report.success_rate_avg);
    let worst = rates.fold(1.0, f64::min);
    let (verdict, code) = if worst >= good {
        ("good", 0)
    } else if worst >= usable {
        (
            "usable, but motions will be rough, and the robot may stop them",
            3,
        )
    } else {
        ("not usable: see the chapter on the real-time set-up", 4)
    };
    println!("{verdict}");
    Ok(ExitCode::from(code))
}

async fn measure(robot: &Robot, seconds: f64) -> anyhow::Result<Measured> {
    let watching = tokio::spawn(watch(robot.address().to_string(), robot.records()));
    let mut time = 0.0;
    let nothing = robot.control_torques(move |_, step| {
        time += step.as_secs_f64();
        Torques([0.0; 7]).finish_if(time >= seconds)
    });
    let report = nothing.await?;
    robot.shutdown().await; // this also ends the records
    Ok(Measured {
        robot: robot.clone(),
        report,
        best: watching.await?,
    })
}

/// Prints losses when they occur; returns the highest success rate reported by the robot.
async fn watch(robot: String, mut records: broadcast::Receiver<Record>) -> f64 {
    let mut best: f64 = 0.0;
    loop {
        match records.recv().await {
            Ok(record) if record.activity == Activity::Running => {
                best = best.max(record.success_rate);
                if record.skipped > 0 {
                    println!(
                        "{robot}, {} ms: lost {} states",
                        record.time, record.skipped
                    );
                }
            }
            Ok(_) => {}
            Err(RecvError::Lagged(missed)) => println!("{robot}: {missed} records were missed"),
            Err(RecvError::Closed) => return best,
        }
    }
}

/// Prints a value of each robot, side by side.
fn print(measured: &[Measured], name: &str, of: impl Fn(&Measured) -> String) {
    let figures: String = measured
        .iter()
        .map(|one| format!("{:>22}", of(one)))
        .collect();
    println!("{name:<20}{figures}");
}

fn at(times: &Histogram, quantile: f64) -> String {
    let time = times.quantile(quantile).unwrap_or_default();
    format!("{:.0} us", time.as_secs_f64() * 1e6)
}

const QUANTILES: [(&str, f64); 4] = [
    ("median", 0.5),
    ("99 %", 0.99),
    ("99.9 %", 0.999),
    ("max", 1.0),
];

type Figure = fn(&Measured) -> String;

/// Values of one robot's test, by their names.
const FIGURES: [(&str, Figure); 6] = [
    ("robot", |of| of.robot.address().to_string()),
    ("success rate, min", |of| {
        format!("{:.2}", of.report.success_rate_min)
    }),
    ("success rate, avg", |of| {
        format!("{:.4}", of.report.success_rate_avg)
    }),
    ("success rate, max", |of| format!("{:.2}", of.best)),
    ("states lost", |of| of.report.lost_states.to_string()),
    ("states skipped", |of| of.report.skipped_states.to_string()),
];
