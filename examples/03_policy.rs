//! A policy at 10 Hz sets targets for the hand; the arm follows at 1 kHz, smoothly.
//!
//! `cargo run --release --example policy [ADDRESS]`

use std::f64::consts::TAU;
use std::time::Duration;

use franka_async::prelude::*;
use tokio::sync::watch;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let address = std::env::args().nth(1);
    let builder = Robot::builder(address.as_deref().unwrap_or("127.0.0.1"));
    // `Ignore` is for simulators. Without it a real-time kernel is required, as for a robot.
    let robot = builder.realtime(Realtime::Ignore).connect().await?;
    let start = robot.pose();
    let (sender, targets) = watch::channel(start);

    let silence = Duration::from_millis(500);
    let following = robot.follow(targets).watchdog(silence, OnTimeout::Brake);
    let policy = async {
        let mut clock = tokio::time::interval(Duration::from_millis(100));
        for step in 0..=40 {
            clock.tick().await;
            // A real policy would read `robot.state()`. This one moves along a circle of 10 cm.
            let (sin, cos) = (TAU * f64::from(step) / 40.0).sin_cos();
            let way = Pose::translation(0.0, 0.05 * sin, 0.05 - 0.05 * cos);
            if sender.send(way * start).is_err() {
                break; // the motion has ended
            }
        }
        drop(sender); // the motion then ends at the last target
    };
    let (report, ()) = tokio::join!(following.into_future(), policy);
    println!("followed for {:.1?}", report?.duration);
    robot.shutdown().await;
    Ok(())
}
