//! Draws figures of eight with the hand, upright and across the arm. The size grows from zero and
//! shrinks to zero. So the motion begins and ends at rest, although the figure itself never stops.
//!
//! `cargo run --release --example figure_eight -- [ADDRESS] [--laps 3]`

use std::f64::consts::TAU;

use anyhow::ensure;
use clap::Parser;
use franka_async::control::{CartesianPose, Finish};
use franka_examples::{Connection, Ease, Summary};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Number of figures; the first and the last are the ramps: 2 or more.
    #[arg(long, default_value_t = 3)]
    laps: u32,
}

/// Half the width of the figure, across the arm, `[m]`.
const WIDTH: f64 = 0.08;
/// Half its height, `[m]`.
const HEIGHT: f64 = 0.04;
/// Duration of one figure, `[s]`.
const LAP: f64 = 4.0;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { connection, laps } = Arguments::parse();
    ensure!(laps >= 2, "the ramps take a figure each");
    let what = format!("draws {laps} figures of eight, 16 cm wide and 8 cm high, with its hand");
    let (robot, _sim) = connection.open_ready(&what).await?;
    let start = robot.pose();

    let duration = f64::from(laps) * LAP;
    let (mut time, mut centre) = (0.0, None);
    let drawing = robot.control_cartesian_pose(move |state, step| {
        time += step.as_secs_f64();
        let size = Ease::over(LAP, time).value * Ease::over(LAP, duration - time).value;
        let phase = TAU * time / LAP;
        let mut pose = *centre.get_or_insert(state.O_T_EE_c);
        pose[13] += WIDTH * size * phase.sin();
        pose[14] += HEIGHT * size * (2.0 * phase).sin();
        let command = CartesianPose {
            O_T_EE: pose,
            elbow: None,
        };
        command.finish_if(time >= duration)
    });
    let report = drawing.limit_rate(true).await?;

    let moved = robot.pose().translation.vector - start.translation.vector;
    robot.shutdown().await;
    println!("{}", Summary(&report));
    println!("the hand is back within {:.2} mm", moved.norm() * 1e3);
    Ok(())
}
