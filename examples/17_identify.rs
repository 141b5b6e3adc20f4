//! Measures the parameters that an arm needs in addition to its model: describes the motion,
//! measures friction, bias and load with a minute of small motions, and starts the next connection
//! with them.
//!
//! `cargo run --release --features json --example identify -- [ADDRESS] [--save FILE]`

use std::path::PathBuf;

use anyhow::Context;
use clap::Parser;
use franka_async::{Pose, Robot};
use franka_examples::{Connection, Summary};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// File for the results, as JSON.
    #[arg(long)]
    save: Option<PathBuf>,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { connection, save } = Arguments::parse();
    let (robot, _sim) = connection.open().await?;
    let identify = robot.identify();
    for motion in identify.motions() {
        println!("{motion}");
    }
    let reach = identify.reach();
    connection.ask(&format!(
        "makes these motions, {:.0?} in all; its hand goes up to {:.0} cm away, {:.0} cm of it down",
        identify.duration(),
        reach.end_effector * 1e2,
        reach.down * 1e2
    ))?;
    let found = identify.run().await?;
    println!("{found}");
    if let Some(path) = save {
        let text = serde_json::to_string_pretty(&found)?;
        std::fs::write(&path, text).with_context(|| format!("writing {}", path.display()))?;
    }
    let address = robot.address();
    robot.shutdown().await;

    let builder = Robot::builder(address).realtime(connection.scheduling().realtime);
    let robot = builder.known(found).connect().await?;
    let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
    println!("{}", Summary(&robot.move_to(up).await?));
    robot.shutdown().await;
    Ok(())
}
