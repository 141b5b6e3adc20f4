//! A script without async: waits for motions on its own thread, then draws a circle by setting a
//! goal every 20 ms, which never waits.
//!
//! `cargo run --release --example script -- [ADDRESS] [--turns N]`

use std::f64::consts::TAU;
use std::thread::sleep;
use std::time::Duration;

use clap::Parser;
use franka_async::blocking::Wait;
use franka_async::nalgebra::{Translation3, Vector6};
use franka_async::{Engage, Offset, Pose};
use franka_examples::{Connection, Summary};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// How many circles.
    #[arg(long, default_value_t = 2)]
    turns: u32,
}

const RADIUS: f64 = 0.05;

/// Seconds per circle.
const TIME: f64 = 4.0;

/// Goals per second.
const RATE: u32 = 50;

fn main() -> anyhow::Result<()> {
    let Arguments { connection, turns } = Arguments::parse();
    let (robot, _sim) = connection.open().wait()?;
    connection.ask("rises by 3 cm and draws circles of 10 cm")?;
    let up = Offset::base(Translation3::new(0.0, 0.0, 0.03));
    println!("{}", Summary(&robot.move_by(up).wait()?));

    let start = robot.pose();
    let arm = robot.engage(Engage::default()).wait()?;
    for step in 0..=turns * RATE * TIME as u32 {
        let angle = TAU * f64::from(step) / (f64::from(RATE) * TIME);
        let (sin, cos) = angle.sin_cos();
        let there = Pose::translation(0.0, RADIUS * sin, RADIUS * (1.0 - cos)) * start;
        // With its velocity, a target that moves is followed without a lag.
        let speed = RADIUS * TAU / TIME;
        let twist = Vector6::new(0.0, speed * cos, speed * sin, 0.0, 0.0, 0.0);
        arm.try_set((there, twist))?;
        sleep(Duration::from_secs(1) / RATE);
    }
    arm.set(start).wait()?;
    arm.at_rest().wait()?;
    let off = (robot.pose().translation.vector - start.translation.vector).norm();
    println!("back, {:.2} mm off", off * 1e3);
    arm.disengage().wait()?;
    robot.shutdown().wait();
    Ok(())
}
