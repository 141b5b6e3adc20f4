//! Causes a reflex, prints the robot's report of it, recovers and continues, as an unattended
//! program does.
//!
//! `cargo run --release --example recovery -- [ADDRESS] [--log FILE.csv]`

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Parser;
use franka_async::control::{Finish, JointVelocities};
use franka_async::{Diagnose, MotionError, RobotMode};
use franka_examples::{Connection, Ease, Summary};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Where to write the last cycles before the reflex, as a table.
    #[arg(long)]
    log: Option<PathBuf>,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { connection, log } = Arguments::parse();
    let what = "stops itself with a reflex (a jerk and the click of its brakes), and turns its hand by 0.3 rad";
    let (robot, _sim) = connection.open_ready(what).await?;

    // From standstill to 0.2 rad/s within a millisecond is more acceleration than the robot
    // accepts.
    let mut cycle = 0;
    let step = robot.control_joint_velocities(move |_, _| {
        cycle += 1;
        let speed = if cycle < 100 { 0.0 } else { 0.2 };
        JointVelocities([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, speed]).finish_if(cycle > 1000)
    });
    // Filter and limiter would have turned this into an acceptable command.
    let error = match step.limit_rate(false).cutoff_frequency(1000.0).await {
        Err(MotionError::Control(error)) if error.is_reflex() => error,
        Err(error) => return Err(error).context("the motion did not end by a reflex"),
        Ok(_) => bail!("the robot accepted a step in velocity"),
    };
    println!("{error}");
    if let Some(diagnosis) = error.diagnose() {
        println!("{diagnosis}");
    }
    let newest = error.log.iter().next_back();
    let entry = newest.context("an empty log")?;
    println!(
        "at {} ms, after the command {:?}",
        entry.state.message_id, entry.command.dq_c
    );
    if let Some(file) = log {
        std::fs::write(&file, error.log.to_csv())?;
        println!("{} cycles in {}", error.log.len(), file.display());
    }

    println!(
        "mode: {}, errors: {}",
        robot.state().robot_mode,
        robot.state().errors
    );
    robot.recover().await?;
    let mut states = robot.states();
    states
        .wait_for(|state| state.robot_mode == RobotMode::Idle)
        .await?;
    println!(
        "mode: {}, errors: {}",
        robot.state().robot_mode,
        robot.state().errors
    );

    let mut time = 0.0;
    let turn = robot.control_joint_velocities(move |_, step| {
        time += step.as_secs_f64();
        let speed = 0.3 * Ease::over(2.0, time).rate;
        JointVelocities([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, speed]).finish_if(time >= 2.0)
    });
    println!("and on: {}", Summary(&turn.limit_rate(true).await?));
    robot.shutdown().await;
    Ok(())
}
