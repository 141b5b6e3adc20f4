//! Uses the robot's four motion generators, each under a control function: a small motion there and
//! back, at rest at both ends.
//!
//! `cargo run --release --example generators -- joint-positions [ADDRESS]`, likewise
//! `joint-velocities`, `cartesian-pose` and `cartesian-velocities`

use clap::{Parser, ValueEnum};
use franka_async::Robot;
use franka_async::control::{
    CartesianPose, CartesianVelocities, Control, Finish, JointPositions, JointVelocities,
    MoveControllerMode,
};
use franka_examples::{Connection, Ease, Summary};

#[derive(Parser)]
struct Arguments {
    generator: Generator,
    #[command(flatten)]
    connection: Connection,
}

#[derive(ValueEnum, Clone, Copy)]
enum Generator {
    JointPositions,
    JointVelocities,
    CartesianPose,
    CartesianVelocities,
}

/// Duration of the motion there and back, `[s]`.
const DURATION: f64 = 4.0;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let (what, begin): (_, fn(&Robot) -> Control) = match arguments.generator {
        Generator::JointPositions => ("turns joints 4, 5 and 7 by 0.2 rad", joint_positions),
        Generator::JointVelocities => ("turns joints 4, 5 and 7 by 0.2 rad", joint_velocities),
        Generator::CartesianPose => ("lowers its hand by 6 cm", cartesian_pose),
        Generator::CartesianVelocities => ("moves its hand 6 cm to its left", cartesian_velocities),
    };
    let what = format!("{what}, and back");
    let (robot, _sim) = arguments.connection.open_ready(&what).await?;
    let start = robot.pose();
    // The robot extrapolates lost commands, and the next command can then be too far away: the
    // limiter moves it within the limits.
    let report = begin(&robot).limit_rate(true).await?;
    let moved = robot.pose().translation.vector - start.translation.vector;
    robot.shutdown().await;
    println!("{}", Summary(&report));
    println!("the hand is back within {:.2} mm", moved.norm() * 1e3);
    Ok(())
}

fn joint_positions(robot: &Robot) -> Control {
    let (mut time, mut start) = (0.0, None);
    robot.control_joint_positions(move |state, step| {
        time += step.as_secs_f64(); // zero with the first state
        // The motion begins at the robot's own reference, not at the measured joint positions.
        let mut q = *start.get_or_insert(state.q_d);
        for joint in [3, 4, 6] {
            q[joint] += 0.2 * Ease::there_and_back(DURATION, time).value;
        }
        JointPositions(q).finish_if(time >= DURATION)
    })
}

fn joint_velocities(robot: &Robot) -> Control {
    let mut time = 0.0;
    robot.control_joint_velocities(move |_, step| {
        time += step.as_secs_f64();
        let mut dq = [0.0; 7];
        for joint in [3, 4, 6] {
            dq[joint] = 0.2 * Ease::there_and_back(DURATION, time).rate;
        }
        JointVelocities(dq).finish_if(time >= DURATION)
    })
}

fn cartesian_pose(robot: &Robot) -> Control {
    let (mut time, mut start) = (0.0, None);
    let control = robot.control_cartesian_pose(move |state, step| {
        time += step.as_secs_f64();
        let mut pose = *start.get_or_insert(state.O_T_EE_c);
        pose[14] -= 0.06 * Ease::there_and_back(DURATION, time).value; // z of the column-major matrix
        let command = CartesianPose {
            O_T_EE: pose,
            elbow: None,
        };
        command.finish_if(time >= DURATION)
    });
    // Every generator can run with either controller of the robot; here with Cartesian impedance.
    control.controller(MoveControllerMode::CartesianImpedance)
}

fn cartesian_velocities(robot: &Robot) -> Control {
    let mut time = 0.0;
    robot.control_cartesian_velocities(move |_, step| {
        time += step.as_secs_f64();
        let mut twist = [0.0; 6];
        twist[1] = 0.06 * Ease::there_and_back(DURATION, time).rate;
        let command = CartesianVelocities {
            O_dP_EE: twist,
            elbow: None,
        };
        command.finish_if(time >= DURATION)
    })
}
