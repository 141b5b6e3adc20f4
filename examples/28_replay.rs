//! Records a motion, exports it as tables and as a dataset for training, and replays it at half its
//! speed.
//!
//! `cargo run --release --features export --example replay -- --to FOLDER [ADDRESS]`

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use franka_async::export::lerobot::{Dataset, DatasetOptions};
use franka_async::export::{Columns, NewFile, write_csv, write_parquet};
use franka_async::recording::{
    Episode, RecordOptions, Recorder, Recording, Sample, Samples, Track,
};
use franka_async::replay::{ReplayOptions, ReplayPlan};
use franka_async::{Engage, Pose, Robot};
use franka_examples::Connection;

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// New folder for the recording and the exports.
    #[arg(long, default_value = "replay")]
    to: PathBuf,
    /// Speed, as a share of the recorded speed.
    #[arg(long, default_value_t = 0.5)]
    speed: f64,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments {
        connection,
        to,
        speed,
    } = Arguments::parse();
    let (robot, _sim) = connection.open().await?;
    connection.ask("moves its hand by 10 cm from where it is, twice")?;
    fs::create_dir(&to)?;
    record(&robot, &to.join("run.mcap")).await?;
    let samples = export(&to)?;
    let options = ReplayOptions::default().speed(speed);
    let plan = ReplayPlan::new(robot.model().kind(), &samples, options, robot.model())?;
    let report = robot.replay(&plan).await?;
    println!(
        "replayed in {:.1} s: the hand {:.1} mm off at most, {:.1} mm in the median",
        report.duration.as_secs_f64(),
        report.position.max * 1e3,
        report.position.median * 1e3
    );
    robot.shutdown().await;
    Ok(())
}

async fn record(robot: &Robot, path: &Path) -> anyhow::Result<()> {
    let recorder = Recorder::to_file(path, RecordOptions::default())?;
    recorder.attach(robot, Track::default()).await?;
    let arm = robot.engage(Engage::default()).await?;
    let start = robot.pose();
    recorder.begin_episode("square-1", "draw half of a square")?;
    for offset in [[0.0, 0.1, 0.0], [0.0, 0.1, -0.1]] {
        let [x, y, z] = offset;
        arm.move_to(Pose::translation(x, y, z) * start).await?;
    }
    recorder.end_episode(Some(true));
    arm.move_to(start).await?;
    arm.disengage().await?;
    let status = recorder.finish()?;
    println!("{} cycles, {} dropped", status.cycles, status.dropped);
    Ok(())
}

/// Exports the recording, and returns the samples of its first episode.
fn export(folder: &Path) -> anyhow::Result<Vec<Sample>> {
    let recording = Recording::open(folder.join("run.mcap"))?;
    let robot = recording.robot("")?;
    let columns = Columns::named(["q", "q_ref", "tau_ext_hat_filtered", "robot_mode"])?;
    let mut csv = NewFile::create(folder.join("run.csv"))?;
    write_csv(robot.cycles(), &columns, true, &mut csv)?;
    csv.finish()?;
    let rows = write_parquet(robot.cycles(), &Columns::all(), folder.join("run.parquet"))?;
    println!("{rows} rows in run.csv and run.parquet");

    let options = DatasetOptions::new("franka").gripper(false);
    let mut dataset = Dataset::create(folder.join("dataset"), options)?;
    let mut first = Vec::new();
    for episode in Episode::of(robot.events())? {
        let part = robot.from(episode.begin).to(episode.end);
        let samples = Samples::new(part.cycles(), part.gripper_states());
        let samples: Vec<Sample> = samples.collect::<Result<_, _>>()?;
        let frames =
            dataset.add_episode(&episode.task, episode.success, samples.iter().copied())?;
        println!("episode {}: {frames} frames", episode.name);
        if first.is_empty() {
            first = samples;
        }
    }
    dataset.finish()?;
    Ok(first)
}
