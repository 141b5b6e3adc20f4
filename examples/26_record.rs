//! Records a robot to a file, with a black box for incidents, and reads the file.
//!
//! `cargo run --release --features record --example record -- [ADDRESS] [--to FILE.mcap]`

use std::path::{Path, PathBuf};

use clap::Parser;
use franka_async::prelude::*;
use franka_async::recording::event::EventKind;
use franka_async::recording::{BlackBox, RecordOptions, Recorder, Recording, Track};
use franka_examples::Connection;

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// The new file. Foxglove and Rerun can open it too.
    #[arg(long, default_value = "run.mcap")]
    to: PathBuf,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { connection, to } = Arguments::parse();
    let (robot, _sim) = connection.open().await?;
    connection.ask("moves its hand by 10 cm, there and back")?;

    let options = RecordOptions {
        // Written only if an incident ends a motion: a reflex, a lost link, or a guard.
        black_box: Some(BlackBox::new("incidents")),
        ..RecordOptions::default()
    };
    let recorder = Recorder::to_file(&to, options)?;
    recorder.attach(&robot, Track::default()).await?;
    robot.move_by(Offset::base([0.0, 0.1, 0.0])).await?;
    robot.move_by(Offset::base([0.0, -0.1, 0.0])).await?;
    robot.shutdown().await;
    let status = recorder.finish()?;
    println!(
        "{} cycles in {}, {} dropped, {} black boxes",
        status.cycles,
        to.display(),
        status.dropped,
        status.black_boxes.len()
    );
    read(&to)
}

/// Prints the requests to the robot, and the largest external force.
fn read(file: &Path) -> anyhow::Result<()> {
    let recording = Recording::open(file)?;
    let robot = recording.robot("")?;
    for event in robot.events() {
        let event = event?;
        if let EventKind::Goal(_) | EventKind::Outcome(_) = event.kind {
            println!("{} {}", event.time, event.kind);
        }
    }
    let mut most: f64 = 0.0;
    for cycle in robot.cycles() {
        let [x, y, z, ..] = cycle?.state.O_F_ext_hat_K;
        most = most.max(x.hypot(y).hypot(z));
    }
    println!("external force: {most:.1} N at most");
    Ok(())
}
