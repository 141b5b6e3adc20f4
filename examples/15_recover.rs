//! Explains why a robot has stopped itself, and recovers it.
//!
//! `cargo run --release --example recover -- [ADDRESS] [--yes] [--provoke] [--log FILE.csv]`
//!
//! Exit code 0: the robot is ready for a motion; 3: it needs a person, at the user stop or in its
//! web interface; 1: the recovery failed; 2: an error on the command line.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context, bail};
use clap::Parser;
use franka_async::control::{Finish, JointVelocities};
use franka_async::diagnosis::{Case, Commander, Diagnose, Diagnosis};
use franka_async::error::ControlError;
use franka_async::record::ControlLog;
use franka_async::state::RobotMode;
use franka_async::{MotionError, Robot};
use franka_examples::{Connection, Ease, Summary, make_ready};

#[derive(Parser)]
#[command(after_help = "Exit code: 0 ready, 3 a person is needed, 1 the recovery failed.")]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Causes a reflex first, and moves once more after the recovery. Without an address, the
    /// simulator has no other reflex to recover from.
    #[arg(long)]
    provoke: bool,
    /// File for the last cycles before a provoked reflex, as a table.
    #[arg(long, requires = "provoke")]
    log: Option<PathBuf>,
}

#[tokio::main]
async fn main() -> anyhow::Result<ExitCode> {
    let Arguments {
        connection,
        provoke,
        log,
    } = Arguments::parse();
    let (robot, _sim) = connection.open().await?;
    if provoke {
        connection.ask(
            "goes to its ready pose, and stops itself there (a jerk, and the click of its brakes)",
        )?;
        make_ready(&robot).await?;
        let error = provoke_a_reflex(&robot).await?;
        println!("{error}");
        println!("{}", error.diagnose().context("a reflex has a diagnosis")?);
        if let Some(file) = log {
            std::fs::write(&file, error.log.to_csv())?;
            println!("{} cycles in {}", error.log.len(), file.display());
        }
    }
    let state = robot.state();
    println!("mode: {}, errors: {}", state.robot_mode, state.errors);
    match state.robot_mode {
        RobotMode::Reflex => {}
        RobotMode::Idle | RobotMode::Move | RobotMode::Guiding => {
            println!("nothing to recover from");
            return Ok(ExitCode::SUCCESS);
        }
        RobotMode::UserStopped | RobotMode::Other | RobotMode::AutomaticErrorRecovery => {
            println!(
                "release the user stop, open the brakes, and look at the robot's web interface"
            );
            return Ok(ExitCode::from(3));
        }
    }
    if !provoke {
        // The program that controlled the motion received the log. Here only the errors are
        // available.
        let case = Case {
            commander: Commander::Goals,
            errors: state.reflex_reason,
            log: Arc::new(ControlLog::with_capacity(0)),
            statistics: None,
        };
        println!("{}", Diagnosis::of(&case, robot.model()));
    }
    connection.ask("is freed by a recovery: what it presses against may give way")?;
    robot.recover().await?;
    let mut states = robot.states();
    let idle = states
        .wait_for(|state| state.robot_mode == RobotMode::Idle)
        .await?;
    println!("mode: {}, errors: {}", idle.robot_mode, idle.errors);
    if provoke {
        println!("and on: {}", Summary(&turn(&robot).await?));
    }
    robot.shutdown().await;
    Ok(ExitCode::SUCCESS)
}

/// From standstill to 0.2 rad/s within a millisecond: more acceleration than the robot accepts.
async fn provoke_a_reflex(robot: &Robot) -> anyhow::Result<Box<ControlError>> {
    let mut cycle = 0;
    let step = robot.control_joint_velocities(move |_, _| {
        cycle += 1;
        let speed = if cycle < 100 { 0.0 } else { 0.2 };
        JointVelocities([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, speed]).finish_if(cycle > 1000)
    });
    // Filter and limiter would have turned this into an acceptable command.
    match step.limit_rate(false).cutoff_frequency(1000.0).await {
        Err(MotionError::Control(error)) if error.is_reflex() => Ok(error),
        Err(error) => Err(error).context("the motion did not end by a reflex"),
        Ok(_) => bail!("the robot accepted a step in velocity"),
    }
}

/// Turns the hand by 0.3 rad.
async fn turn(robot: &Robot) -> Result<franka_async::MotionReport, MotionError> {
    let mut time = 0.0;
    let turn = robot.control_joint_velocities(move |_, step| {
        time += step.as_secs_f64();
        let speed = 0.3 * Ease::over(2.0, time).rate;
        JointVelocities([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, speed]).finish_if(time >= 2.0)
    });
    turn.limit_rate(true).await
}
