//! Moves the joints to the ready pose: hand in front of the arm and pointing down, far from limits
//! and singularities.
//!
//! `cargo run --release --example move_to_ready -- [ADDRESS] [--speed FACTOR]`

use clap::Parser;
use franka_async::READY;
use franka_examples::{Connection, Summary};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Speed: 1 is the usual speed of a motion, about 50 degrees per second.
    #[arg(long, default_value_t = 0.5)]
    speed: f64,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { connection, speed } = Arguments::parse();
    let (robot, _sim) = connection.open().await?;
    connection.ask("goes to its ready pose, all joints at once")?;
    println!("from {:.3?} rad", robot.state().q);
    let report = robot.move_to(READY).speed(speed).await?;
    println!("to   {:.3?} rad", robot.state().q);
    println!("{}", Summary(&report));
    robot.shutdown().await;
    Ok(())
}
