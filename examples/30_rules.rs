//! The book's seven rules for control at 1 kHz, each violated on a separate simulated robot, with
//! the driver's messages. Accepts no address: a robot would stop itself six times.
//!
//! `cargo run --release --example rules`

use std::time::Duration;

use anyhow::{Context, bail};
use franka_async::control::{Finish, JointPositions, JointVelocities};
use franka_async::diagnosis::Diagnose;
use franka_async::model::Wrench;
use franka_async::prelude::*;
use franka_async::settings::CollisionBehavior;
use franka_examples::Ease;
use franka_sim::{Running, Sim, Tool};

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    println!("1. Answer every state within its millisecond");
    let (robot, _sim) = connected(fr3()).await?;
    let mut cycle = 0;
    let late = robot.control_joint_velocities(move |_, _| {
        cycle += 1;
        if cycle == 100 {
            std::thread::sleep(Duration::from_secs(1)); // a disk, a lock, or a page of memory
        }
        JointVelocities([0.0; 7]).finish_if(cycle > 500)
    });
    explain(late.await)?;

    println!("2. Begin where the robot is");
    let (robot, _sim) = connected(fr3()).await?;
    let mut start = None;
    let mut cycle = 0;
    let elsewhere = robot.control_joint_positions(move |state, _| {
        cycle += 1;
        let mut q = *start.get_or_insert(state.q_d);
        q[0] += 0.2;
        JointPositions(q).finish_if(cycle > 1000)
    });
    explain(elsewhere.await)?;

    println!("3. Go on without steps");
    let (robot, _sim) = connected(fr3()).await?;
    let mut cycle = 0;
    let step = robot.control_joint_velocities(move |_, _| {
        cycle += 1;
        let speed = if cycle < 100 { 0.0 } else { 0.2 };
        JointVelocities([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, speed]).finish_if(cycle > 1000)
    });
    explain(step.await)?;

    println!("4. End at rest");
    let (robot, _sim) = connected(fr3()).await?;
    let mut time = 0.0;
    let moving = robot.control_joint_velocities(move |_, step| {
        time += step.as_secs_f64();
        let speed = 0.3 * Ease::over(2.0, time).rate;
        JointVelocities([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, speed]).finish_if(time >= 1.0)
    });
    explain(moving.await)?;

    println!("5. Stay in the range of the joints");
    let (robot, _sim) = connected(fr3()).await?;
    let mut q = robot.state().q;
    q[3] = 0.1;
    explain(robot.move_joints(q).await)?;

    println!("6. Let one program at a time have the robot");
    let (robot, sim) = connected(fr3()).await?;
    let second = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    match second.connect().await {
        Err(error) => println!("   {error}"),
        Ok(_) => bail!("a second program was connected"),
    }
    let arm = robot.engage(Engage::default()).await?;
    explain(robot.move_to(READY).await)?;
    arm.disengage().await?;

    println!("7. Expect contacts, and recover before the next motion");
    let mut was_hit = false;
    let something_in_the_way = move |robot: &mut franka_sim::Robot| {
        if !was_hit && robot.state().dq[0] > 0.05 {
            was_hit = true;
            robot.push_end_effector(Wrench::new(0.0, -60.0, 0.0, 0.0, 0.0, 0.0), 100);
        }
    };
    let (robot, _sim) = connected(fr3().every_millisecond(something_in_the_way)).await?;
    robot
        .set_collision_behavior(CollisionBehavior::careful())
        .await?;
    explain(robot.move_by(Offset::base([0.0, 0.1, 0.0])).await)?;
    explain(robot.move_to(READY).await)?;
    robot.recover().await?;
    robot.move_to(READY).await.context("after the recovery")?;
    println!("   recovered, and moved on");
    Ok(())
}

/// Returns a simulated Franka Research 3 with a Hand. It counts the cycles of its client, so that
/// the load of this machine does not affect the outcome.
fn fr3() -> Sim {
    let sim = Sim::fr3().tool(Tool::hand());
    sim.virtual_time(Duration::from_millis(10))
}

/// Starts a robot and connects to it.
async fn connected(sim: Sim) -> anyhow::Result<(Robot, Running)> {
    let sim = sim.start().await?;
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    Ok((builder.connect().await?, sim))
}

/// Prints why a motion ended, with the diagnosis of a stop.
fn explain<T>(outcome: Result<T, MotionError>) -> anyhow::Result<()> {
    let Err(error) = outcome else {
        bail!("nothing happened");
    };
    for line in error.to_string().lines() {
        println!("   {line}");
    }
    if let Some(diagnosis) = error.diagnose() {
        for line in diagnosis.to_string().lines() {
            println!("   | {line}");
        }
    }
    Ok(())
}
