//! Connects, prints the state, moves the hand 5 cm up and back, then the joints. The exit code is 0
//! only if all motions arrived.
//!
//! `cargo run --release --example quickstart [ADDRESS]`

use std::time::Duration;

use anyhow::ensure;
use clap::Parser;
use franka_async::error::PoseError;
use franka_async::{Motion, MotionReport, Pose, Robot};
use franka_examples::Arguments;
use indicatif::{ProgressBar, ProgressStyle};

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let connection = Arguments::parse().connection;
    let (robot, _sim) = connection.open().await?;
    connection.ask("moves its hand 5 cm up and back, then joints 1 and 7 by up to 0.3 rad")?;
    let state = robot.state();
    println!("connected to {}", robot.address());
    println!("mode: {}, joints: {:.3?} rad", state.robot_mode, state.q);

    let start = robot.pose();
    println!("hand at {:.4?} m", start.translation.vector.as_slice());
    let up = Pose::translation(0.0, 0.0, 0.05) * start;
    let mut q = state.q;
    q[0] += 0.2;
    q[6] -= 0.3;

    drive(&robot, "5 cm up", robot.move_to(up), up).await?;
    drive(&robot, "and back", robot.move_to(start), start).await?;
    let turned = robot.pose_at(q);
    let (report, error) = drive(&robot, "joints", robot.move_joints(q), turned).await?;

    robot.shutdown().await;
    println!(
        "arrived: {:.3} mm, {:.3} mrad from the target after {:.2} s",
        error.translation * 1e3,
        error.rotation * 1e3,
        report.duration.as_secs_f64()
    );
    Ok(())
}

/// Awaits a motion behind a progress bar and checks, from the robot's own state, that it arrived.
async fn drive(
    robot: &Robot,
    name: &'static str,
    motion: Motion,
    target: Pose,
) -> anyhow::Result<(MotionReport, PoseError)> {
    let left = |robot: &Robot| {
        let error = PoseError::between(&robot.pose(), &target);
        error.translation + 0.1 * error.rotation
    };
    let whole = left(robot);
    let style = ProgressStyle::with_template("{msg:10} [{bar:40}] {percent:>3} %")?;
    let bar = ProgressBar::new(1000)
        .with_style(style.progress_chars("=> "))
        .with_message(name);
    let mut moving = motion.into_future();
    let report = loop {
        tokio::select! {
            report = &mut moving => break report?,
            () = tokio::time::sleep(Duration::from_millis(30)) => {
                bar.set_position((1000.0 * (1.0 - left(robot) / whole)) as u64);
            }
        }
    };
    bar.finish();
    let error = PoseError::between(&robot.pose(), &target);
    ensure!(
        error.translation <= 1e-3 && error.rotation <= 2e-3,
        "{name}: {:.3} mm, {:.3} mrad from the target",
        error.translation * 1e3,
        error.rotation * 1e3
    );
    Ok((report, error))
}
