//! Guarded moves: down until the hand touches something and rests on it; then at two places beside
//! it, where the control thread takes the hand up again by itself.
//!
//! `cargo run --release --example guarded_move -- [ADDRESS] [--reach METRES]`

use std::time::Duration;

use clap::Parser;
use franka_async::condition::{Reacted, elapsed, force_z};
use franka_async::goal::Budget;
use franka_async::nalgebra::{Translation3, Vector3};
use franka_async::{Engage, Offset, Pose};
use franka_examples::Connection;
use franka_sim::{Running, Touch};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// How far down the hand may go, `[m]`.
    #[arg(long, default_value_t = 0.15)]
    reach: f64,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { connection, reach } = Arguments::parse();
    let what = format!("moves its hand down by up to {reach} m until it touches something");
    let (robot, sim) = connection.open_ready(&what).await?;
    if let Some(sim) = &sim {
        lay_table(sim).await?;
    }
    let arm = robot.engage(Engage::default()).await?;
    let start = robot.pose();

    // A slow approach: what the arm hits it with grows with its velocity.
    let mut slow = Budget::of(robot.model().joint_limits());
    slow.translation.velocity = 0.05;
    // Friction alone shows up to 6.5 N here, more while the arm sets out.
    let touched = force_z(8.0).relative() & elapsed(Duration::from_millis(200));
    let down = Offset::base(Translation3::new(0.0, 0.0, -reach));

    let report = arm.move_by(down).limits(slow).until(touched).await?;
    match report.reacted {
        Some(contact) => {
            show(&contact);
            tokio::time::sleep(Duration::from_secs(1)).await;
            let [_, _, force, ..] = robot.state().O_F_ext_hat_K;
            println!("rests on it: {force:.1} N along z, friction included");
        }
        None => println!("nothing there"),
    }

    for side in [0.04, -0.04] {
        let above = Pose::translation(0.0, side, 0.0) * start;
        arm.move_to(above).await?;
        // Back up at once, however busy this program is.
        let probe = arm.move_by(down).limits(slow).until(touched.then(above));
        match probe.await?.reacted {
            Some(contact) => show(&contact),
            None => println!("nothing there"),
        }
    }
    arm.move_to(start).await?;
    arm.disengage().await?;
    robot.shutdown().await;
    Ok(())
}

fn show(contact: &Reacted) {
    let [_, _, force, ..] = contact.wrench;
    let (at, after) = (contact.pose.translation, contact.after.as_secs_f64());
    println!(
        "contact at y {:.3} m, z {:.3} m after {after:.2} s: {force:.1} N",
        at.y, at.z
    );
}

/// Puts a table 8 cm below the hand of a simulated robot.
async fn lay_table(sim: &Running) -> anyhow::Result<()> {
    sim.with(|robot| {
        let hand = robot.true_pose().translation.vector;
        let up = Vector3::z();
        robot.touch(Touch::wall(hand - up * 0.08, up));
    })
    .await?;
    Ok(())
}
