//! Picks up a block and puts it back, with arm and hand. Each is awaited; they can move at the same
//! time.
//!
//! `cargo run --release --example pick [ADDRESS]`; on a robot, with the block between the fingers.

use anyhow::ensure;
use clap::Parser;
use franka_async::Pose;
use franka_async::gripper::Grasp;
use franka_examples::Arguments;

/// Width of the block, `[m]`.
const BLOCK: f64 = 0.03;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let connection = Arguments::parse().connection;
    let (robot, sim) = connection.open().await?;
    let gripper = connection.open_gripper(&robot, sim.as_ref()).await?;
    connection.ask("lifts its hand by 8 cm, grasps what is below, lifts it and puts it back")?;
    let table = robot.pose();
    let above = Pose::translation(0.0, 0.0, 0.08) * table;

    // Homing measures the largest opening of the fingers; the arm can move meanwhile.
    let (homed, moved) = tokio::join!(gripper.homing(), robot.move_to(above));
    moved?;
    ensure!(homed?, "homing failed: the fingers did not find their ends");
    robot.move_to(table).speed(0.5).await?;

    let grasped = gripper.grasp(Grasp::new(BLOCK, 0.05, 40.0)).await?;
    let width = gripper.state().width;
    ensure!(
        grasped,
        "nothing of {BLOCK} m there: the fingers closed to {width:.4} m"
    );
    println!("holding {:.1} mm", width * 1e3);

    robot.move_to(above).await?;
    robot.move_to(table).speed(0.5).await?;
    ensure!(gripper.state().is_grasped, "the block was lost on the way");
    gripper.move_to(0.08, 0.1).await?;
    println!("put down");
    robot.shutdown().await;
    Ok(())
}
