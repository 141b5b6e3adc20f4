//! One session with many goals: poses, joints, a stream, the chunks of a policy, and hand guiding,
//! without a stop in between.
//!
//! `cargo run --release --example engage [ADDRESS]`

use std::time::Duration;

use clap::Parser;
use franka_async::diagnosis::Diagnose;
use franka_async::error::PoseError;
use franka_async::goal::{Chunk, Deadman, Free, Gains, OnTimeout, Tuning, Waypoint};
use franka_async::state::RobotState;
use franka_async::{Engage, MotionError, Pose, Robot};
use franka_examples::Arguments;
use tokio::sync::watch;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let connection = Arguments::parse().connection;
    let (robot, _sim) = connection.open().await?;
    connection.ask("moves its hand by up to 10 cm from where it is")?;
    let outcome = run(&robot).await;
    if let Err(error) = &outcome
        && let Some(diagnosis) = error.diagnose()
    {
        eprintln!("{diagnosis}");
    }
    robot.shutdown().await;
    Ok(outcome?)
}

async fn run(robot: &Robot) -> Result<(), MotionError> {
    // The holder of the token must keep it alive. Here a task does so; a remote front end would do
    // so with every message.
    let (token, monitor) = Deadman::new(Duration::from_millis(500));
    let alive = tokio::spawn(async move {
        let mut clock = tokio::time::interval(Duration::from_millis(50));
        loop {
            clock.tick().await;
            token.keep_alive();
        }
    });
    let arm = robot.engage(Engage::default().deadman(monitor)).await?;
    let start = robot.pose();
    let ready = robot.state().q;

    arm.move_to(Pose::translation(0.0, 0.0, 0.05) * start)
        .await?;
    // The next goal can arrive in mid-motion and be of another kind.
    arm.set(Pose::translation(0.0, 0.1, 0.05) * start).await?;
    tokio::time::sleep(Duration::from_millis(300)).await;
    arm.move_joints(ready).await?;
    // Moves along two sides of a square without a stop at the corner.
    let corner = Waypoint::new(Pose::translation(0.0, 0.05, 0.0) * start).blend(0.02);
    let end = Pose::translation(0.0, 0.05, 0.05) * start;
    arm.move_through([corner, end.into()]).await?;

    let soft = [300.0, 300.0, 300.0, 15.0, 15.0, 15.0];
    let gains = Gains::cartesian().with_cartesian_stiffness(soft);
    let tuning = Tuning {
        gains: Some(gains),
        ..Tuning::default()
    };
    arm.tune(tuning).await?;

    // When a stream times out, the error reports it, and the arm is held.
    let (sender, targets) = watch::channel(start);
    let silence = Duration::from_millis(200);
    let follow = arm.follow(targets).watchdog(silence, OnTimeout::Hold);
    sender.send_replace(Pose::translation(0.0, -0.05, 0.0) * start);
    match follow.await {
        Err(MotionError::Held(why)) => println!("held: {why}"),
        other => println!("the stream ended: {other:?}"),
    }

    for _ in 0..10 {
        let chunk = predict(&robot.state(), &ready);
        arm.chunk(chunk).await?;
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    arm.hold().await?;

    arm.guide(Free::ALL).await?;
    tokio::time::sleep(Duration::from_millis(500)).await;
    let report = arm.move_joints(ready).await?;
    let error = PoseError::between(&robot.pose(), &start);
    println!(
        "back after {:.2} s, {:.3} mm off",
        report.duration.as_secs_f64(),
        error.translation * 1e3
    );
    arm.disengage().await?;
    alive.abort();
    Ok(())
}

/// Returns a policy's prediction from an observation: here, a second of motion of the first joint
/// towards the ready pose.
fn predict(observation: &RobotState, ready: &[f64; 7]) -> Chunk {
    let points = (1..=10_u32).map(|step| {
        let share = f64::from(step) / 10.0;
        let q = std::array::from_fn(|joint| {
            observation.q_d[joint] + share * (ready[joint] - observation.q_d[joint])
        });
        (Duration::from_millis(100) * step, q)
    });
    let chunk = Chunk::joints(points).expect("the points are apart and finite");
    chunk.observed_at(observation.message_id)
}
