//! Reads targets from standard input and moves the hand to the newest one; with `--raw`, without
//! the generator that converts them to a motion, for comparison.
//!
//! ```text
//! cargo run --release --example commander -- [ADDRESS] [--speed 0.5] [--csv FILE] [--raw]
//! 0.35 0.1 0.45     a position in the base frame, [m]
//! by 0 0 -0.05      from the target before
//! wait 0.5          seconds, for input from a file
//! ```
//! At the end of the input the arm stops at the last target. With an address the first line
//! confirms, unless `--yes` is given. Exit code 3: the robot stopped itself, which happens soon
//! with `--raw`.

mod raw;
mod run;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::Context;
use clap::Parser;
use franka_async::diagnosis::Diagnose;
use franka_async::{MotionError, Pose};
use franka_examples::{Connection, Summary};
use tokio::sync::watch;

#[derive(Parser)]
#[command(after_help = "Exit code: 0 arrived, 3 the robot stopped itself, 1 anything else.")]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Speed, as a factor of the default.
    #[arg(long, default_value_t = 1.0)]
    speed: f64,
    /// Forward targets as they arrive, in a control function that only limits their speed to 0.25
    /// m/s.
    #[arg(long)]
    raw: bool,
    /// File for the run: target, command and measurement of each millisecond.
    #[arg(long)]
    csv: Option<PathBuf>,
}

#[tokio::main]
async fn main() -> anyhow::Result<ExitCode> {
    let Arguments {
        connection,
        speed,
        raw,
        csv,
    } = Arguments::parse();
    let (robot, _sim) = connection.open().await?;
    connection.ask("follows what is typed")?;
    let targets = read_targets(robot.pose());
    let recording = tokio::spawn(run::record(robot.clone(), raw, targets.clone()));
    let outcome = match raw {
        false => robot.follow(targets).speed(speed).await,
        true => raw::follow(&robot, targets).await,
    };
    robot.shutdown().await; // this also ends the recording
    let mut rows = recording.await?;
    if let Some(error) = outcome.as_ref().err().and_then(MotionError::control)
        && raw
    {
        run::end_with(&mut rows, &error.log);
    }
    let [velocity, acceleration, jerk] = run::derivatives(&rows);
    println!("command: at most {velocity:.2} m/s, {acceleration:.1} m/s^2, {jerk:.0} m/s^3");
    if let Some(file) = csv {
        std::fs::write(&file, run::table(&rows)).with_context(|| file.display().to_string())?;
        println!("{} rows in {}", rows.len(), file.display());
    }
    match outcome {
        Ok(report) => println!("{}", Summary(&report)),
        Err(error) => {
            let Some(diagnosis) = error.diagnose() else {
                return Err(error.into());
            };
            println!("{error}\n{diagnosis}");
            return Ok(ExitCode::from(3));
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Returns the newest target; closed at the end of the input. Reading blocks, so it has a thread.
fn read_targets(start: Pose) -> watch::Receiver<Pose> {
    let (sender, targets) = watch::channel(start);
    std::thread::spawn(move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            let target = *sender.borrow();
            let (what, numbers) = match line.split_once(' ') {
                Some((word @ ("by" | "wait"), rest)) => (word, rest),
                _ => ("to", line.as_str()),
            };
            let numbers: Result<Vec<f64>, _> = numbers.split_whitespace().map(str::parse).collect();
            match (what, numbers.as_deref()) {
                ("wait", Ok(&[seconds])) if seconds >= 0.0 => {
                    std::thread::sleep(Duration::from_secs_f64(seconds.min(3600.0)));
                }
                ("to", Ok(&[x, y, z])) => {
                    sender.send_replace(Pose::from_parts([x, y, z].into(), target.rotation));
                }
                ("by", Ok(&[x, y, z])) => {
                    sender.send_replace(Pose::translation(x, y, z) * target);
                }
                _ => eprintln!("not understood: {line}"),
            }
        }
    });
    targets
}
