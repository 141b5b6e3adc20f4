//! A custom joint impedance law. The robot's generator converts a circle of the hand to joint
//! references, and a second control function converts these to torques, instead of the robot's own
//! controller.
//!
//! `cargo run --release --example joint_impedance -- [ADDRESS]`

use std::f64::consts::TAU;

use clap::Parser;
use franka_async::control::{CartesianPose, Finish, Torques};
use franka_async::model::JointVector;
use franka_examples::{Arguments, Ease, Summary};

/// Radius of the circle, `[m]`.
const RADIUS: f64 = 0.05;
/// Duration of one turn, `[s]`.
const DURATION: f64 = 5.0;

/// Stiffness of the joints, `[N m/rad]`: stiff enough for errors of some millimetres at the hand,
/// and soft enough to push the arm aside.
const STIFFNESS: [f64; 7] = [400.0, 400.0, 400.0, 400.0, 150.0, 100.0, 40.0];
/// Damping of the joints, `[N m s/rad]`: about critical for each joint's own inertia.
const DAMPING: [f64; 7] = [40.0, 40.0, 40.0, 35.0, 12.0, 8.0, 4.0];

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let connection = Arguments::parse().connection;
    let what = "leads its hand once around a circle of 10 cm, upright";
    let (robot, _sim) = connection.open_ready(what).await?;
    let start = robot.pose();

    let (mut time, mut first) = (0.0, None);
    let circle = robot.control_cartesian_pose(move |state, step| {
        time += step.as_secs_f64();
        let angle = TAU * Ease::over(DURATION, time).value;
        let mut pose = *first.get_or_insert(state.O_T_EE_c);
        pose[13] += RADIUS * angle.sin();
        pose[14] += RADIUS * (1.0 - angle.cos());
        let command = CartesianPose {
            O_T_EE: pose,
            elbow: None,
        };
        command.finish_if(time >= DURATION)
    });

    let model = robot.state_model();
    let circle = circle.with_torques(move |state, _| {
        let coriolis = model.dynamics(state).coriolis;
        // The robot compensates gravity and friction; the commanded torques are added to that.
        let torques = JointVector::from_fn(|i, _| {
            STIFFNESS[i] * (state.q_d[i] - state.q[i]) + DAMPING[i] * (state.dq_d[i] - state.dq[i])
        });
        Torques((torques + coriolis).into())
    });

    let report = circle.limit_rate(true).await?;
    let moved = robot.pose().translation.vector - start.translation.vector;
    robot.shutdown().await;
    println!("{}", Summary(&report));
    println!("the hand is back within {:.2} mm", moved.norm() * 1e3);
    Ok(())
}
