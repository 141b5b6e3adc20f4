//! Connects, prints the state, moves the hand 5 cm up and back, and then moves two joints.
//!
//! ```text
//! cargo run --release --example quickstart              # a simulated robot in this process
//! cargo run --release --example quickstart 172.16.0.2   # the robot at an address
//! ```
//! The exit code is 0 only if all motions arrived.

use std::time::Duration;

use anyhow::{Context as _, ensure};
use franka_async::error::PoseError;
use franka_async::{Motion, MotionReport, Pose, Realtime, Robot};
use franka_sim::{Running, Sim};

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let (robot, _sim) = connect(std::env::args().nth(1)).await?;
    let state = robot.state();
    println!("connected to {}", robot.address());
    println!("mode: {}, joints: {:.3?} rad", state.robot_mode, state.q);

    let start = robot.pose();
    println!("hand at {:.4?} m", start.translation.vector.as_slice());
    let up = Pose::translation(0.0, 0.0, 0.05) * start;
    let mut q = state.q;
    q[0] += 0.2;
    q[6] -= 0.3;

    arrive("5 cm up", &robot, robot.move_to(up), up).await?;
    arrive("and back", &robot, robot.move_to(start), start).await?;
    let turned = robot.pose_at(q);
    let (report, error) = arrive("joints", &robot, robot.move_joints(q), turned).await?;

    robot.shutdown().await;
    println!(
        "arrived: {:.3} mm, {:.3} mrad from the target after {:.2} s",
        error.translation * 1e3,
        error.rotation * 1e3,
        report.duration.as_secs_f64()
    );
    Ok(())
}

/// Connects to the robot at `address`, or to a simulated robot, which runs until the second value
/// is dropped. Asks before a real arm may move.
async fn connect(address: Option<String>) -> anyhow::Result<(Robot, Option<Running>)> {
    let Some(address) = address else {
        // The simulated robot waits for a busy computer. A real robot would stop its arm.
        let sim = Sim::fr3().wait_for_commands(Duration::from_secs(1));
        let sim = sim.start().await.context("starting the simulator")?;
        let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
        return Ok((robot.connect().await?, Some(sim)));
    };
    let robot = Robot::connect(address.as_str()).await;
    let robot = robot.with_context(|| format!("connecting to {address}"))?;
    println!("The arm moves its hand 5 cm up and back, then joints 1 and 7 by up to 0.3 rad.");
    println!(
        "Clear the path of the arm, and keep the user stop within reach. Enter to continue, Ctrl-C to cancel."
    );
    let read = std::io::stdin().read_line(&mut String::new())?;
    ensure!(
        read > 0,
        "the input ended without a confirmation that the arm may move"
    );
    Ok((robot, None))
}

/// Awaits a motion, and checks in the robot's own state that the arm arrived.
async fn arrive(
    name: &str,
    robot: &Robot,
    motion: Motion,
    target: Pose,
) -> anyhow::Result<(MotionReport, PoseError)> {
    let report = motion.await?;
    let error = PoseError::between(&robot.pose(), &target);
    ensure!(
        error.translation <= 1e-3 && error.rotation <= 2e-3,
        "{name}: {:.3} mm, {:.3} mrad from the target",
        error.translation * 1e3,
        error.rotation * 1e3
    );
    println!("{name}: {:.2} s", report.duration.as_secs_f64());
    Ok((report, error))
}
