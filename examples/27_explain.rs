//! An obstacle hits the forearm of a moving arm: the example explains why the robot stopped, and
//! where it was hit.
//!
//! `cargo run --release --features record --example explain -- [--figure FILE.svg]`
//!
//! The robot is simulated, so that the explanation can be compared with the true disturbance.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::Context;
use clap::Parser;
use franka_async::explain::Explanation;
use franka_async::model::{EndEffector, Frame};
use franka_async::prelude::*;
use franka_sim::{Sim, Touch};
use nalgebra::Vector3;

#[derive(Parser)]
struct Arguments {
    /// File for the figure.
    #[arg(long)]
    figure: Option<PathBuf>,
}

/// Point on the forearm, and force on it, in the frame of link 5: `[m]`, `[N]`.
const PLACE: Vector3<f64> = Vector3::new(0.03, 0.083, -0.118);
const FORCE: Vector3<f64> = Vector3::new(-70.0, 0.0, 0.0);

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { figure } = Arguments::parse();
    let sim = Sim::fr3().wait_for_commands(PATIENCE).start().await?;
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    // The last second, and the states after it.
    let robot = builder.log_size(1000).connect().await?;
    let model = robot.model().clone();

    let motion = robot.move_by(Offset::base([0.0, 0.2, 0.1])).speed(0.3);
    let blow = async {
        tokio::time::sleep(Duration::from_millis(1200)).await;
        sim.with(move |robot| {
            let pose = model.pose(Frame::Joint5, robot.q(), &EndEffector::default());
            let turn = pose.fixed_view::<3, 3>(0, 0).into_owned();
            let place = pose.transform_point(&PLACE.into());
            println!("hit on link 5 at {:.3?} m", place.coords.as_slice());
            println!("with {:.1?} N\n", (turn * FORCE).as_slice());
            robot.touch(Touch::force(turn * FORCE).at(Frame::Joint5).offset(PLACE));
        })
        .await
    };
    let (ending, _) = tokio::join!(async { motion.await }, blow);
    let error = ending.err().context("the arm was not stopped")?;
    let error = error
        .control()
        .context("the robot did not end the motion")?;

    let explanation = Explanation::of_error(error);
    print!("{explanation}");
    if let Some(file) = figure {
        std::fs::write(&file, explanation.figure())?;
        println!("\nfigure in {}", file.display());
    }
    robot.shutdown().await;
    Ok(())
}

/// Time for which the simulator waits for the commands of a busy machine.
const PATIENCE: Duration = Duration::from_secs(1);
