//! A task sets targets at 10 Hz, in steps; the arm follows the newest one at 1 kHz, smoothly.
//!
//! `cargo run --release --example follow_watch [ADDRESS]`

use std::f64::consts::TAU;
use std::time::Duration;

use clap::Parser;
use franka_async::Pose;
use franka_async::error::PoseError;
use franka_examples::Arguments;
use tokio::sync::watch;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let connection = Arguments::parse().connection;
    let (robot, _sim) = connection.open().await?;
    connection.ask("leads its hand along a circle of 16 cm, upwards from where it is")?;
    let start = robot.pose();
    let (sender, targets) = watch::channel(start);

    // Targets may come from a planner, a policy or a person. Here they walk along a circle of 8 cm
    // radius.
    let planner = tokio::spawn(async move {
        let mut clock = tokio::time::interval(Duration::from_millis(100));
        for step in 0..=60 {
            clock.tick().await;
            let angle = TAU * f64::from(step) / 60.0;
            let offset = Pose::translation(0.0, 0.08 * angle.sin(), 0.08 - 0.08 * angle.cos());
            if sender.send(offset * start).is_err() {
                break; // the motion has ended
            }
        }
        // Dropping the sender ends the motion at the last target.
    });

    let reporter = robot.clone();
    let states = tokio::spawn(async move {
        loop {
            tokio::time::sleep(Duration::from_millis(500)).await;
            let hand = reporter.pose().translation.vector - start.translation.vector;
            println!("hand at {:+.1?} mm", (hand * 1e3).as_slice());
        }
    });

    let report = robot.follow(targets).speed(1.5).await?;
    states.abort();
    planner.await?;
    let error = PoseError::between(&robot.pose(), &start);
    robot.shutdown().await;
    println!(
        "followed for {:.1} s, {} states missed; {:.3} mm, {:.3} mrad from the last target",
        report.duration.as_secs_f64(),
        report.lost_states + report.skipped_states,
        error.translation * 1e3,
        error.rotation * 1e3
    );
    Ok(())
}
