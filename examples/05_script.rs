//! A script without async: waits for motions, then draws a circle with a goal every 20 ms.
//!
//! `cargo run --release --example script [ADDRESS]`

use std::f64::consts::TAU;
use std::time::Duration;

use franka_async::blocking::Wait;
use franka_async::prelude::*;

fn main() -> anyhow::Result<()> {
    let address = std::env::args().nth(1);
    let builder = Robot::builder(address.as_deref().unwrap_or("127.0.0.1"));
    // `Ignore` is for simulators. Without it a real-time kernel is required, as for a robot.
    let robot = builder.realtime(Realtime::Ignore).connect().wait()?;
    robot.move_to(READY).speed(0.5).wait()?;

    let start = robot.pose();
    let arm = robot.engage(Engage::default()).wait()?;
    for step in 0..=200 {
        let (sin, cos) = (TAU * f64::from(step) / 200.0).sin_cos();
        let way = Pose::translation(0.0, 0.05 * sin, 0.05 - 0.05 * cos);
        arm.try_set(way * start)?; // never waits
        std::thread::sleep(Duration::from_millis(20));
    }
    arm.at_rest().wait()?;
    let off = (robot.pose().translation.vector - start.translation.vector).norm();
    println!("back, {:.2} mm off", off * 1e3);
    arm.disengage().wait()?;
    robot.shutdown().wait();
    Ok(())
}
