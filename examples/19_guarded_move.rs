//! A guarded move: down until the hand touches an object, and up again.
//!
//! `cargo run --release --example guarded_move [ADDRESS]`

use std::time::Duration;

use franka_async::condition::{elapsed, force_z};
use franka_async::goal::Budget;
use franka_async::prelude::*;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let address = std::env::args().nth(1);
    let builder = Robot::builder(address.as_deref().unwrap_or("127.0.0.1"));
    // `Ignore` is for simulators. Without it a real-time kernel is required, as for a robot.
    let robot = builder.realtime(Realtime::Ignore).connect().await?;
    robot.move_to(READY).speed(0.5).await?;
    let start = robot.pose();

    // Slow, because the force of an impact grows with the velocity of the arm.
    let mut slow = Budget::of(robot.model().joint_limits());
    slow.translation.velocity = 0.05;
    // Friction alone appears as up to 6.5 N here, and more while the arm starts.
    let touched = force_z(8.0).relative() & elapsed(Duration::from_millis(200));
    let down = Offset::base([0.0, 0.0, -0.15]);
    let report = robot.move_by(down).limits(slow).until(touched).await?;
    match report.reacted {
        Some(contact) => println!("contact at {:.3} m", contact.pose.translation.z),
        None => println!("nothing there"),
    }
    robot.move_to(start).await?;
    robot.shutdown().await;
    Ok(())
}
