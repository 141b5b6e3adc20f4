//! Motions of about a second with every motion generator.

use franka_model::{READY, Wrench, rotation, transform};
use nalgebra::Vector3;

use crate::pair::*;

const CONTROLLERS: [MoveControllerMode; 2] = [
    MoveControllerMode::JointImpedance,
    MoveControllerMode::CartesianImpedance,
];

fn kinds_and_controllers() -> impl Iterator<Item = (RobotKind, MoveControllerMode)> {
    RobotKind::ALL
        .into_iter()
        .flat_map(|kind| CONTROLLERS.map(|controller| (kind, controller)))
}

fn finished(command: RobotCommand) -> RobotCommand {
    RobotCommand {
        motion_generation_finished: true,
        ..command
    }
}

#[test]
fn joint_positions_are_followed_and_echoed() {
    for (kind, controller) in kinds_and_controllers() {
        let mut pair = Pair::of(kind);
        let id = pair.start(controller, MoveGeneratorMode::JointPosition);
        let offset = JointVector::from([0.1, -0.1, 0.1, 0.1, -0.1, 0.1, 0.2]);
        let mut q_c = READY;
        for cycle in 0..1000 {
            q_c = READY + offset * ramp(f64::from(cycle) * 1e-3, 0.95);
            pair.tick(Some(positions(&q_c)));
            assert_eq!(pair.state.robot_mode, RobotMode::Move, "{cycle}");
            assert!((pair.q_d() - q_c).amax() < 2e-7);
            assert!((pair.q() - q_c).amax() < 2e-3, "{controller:?} {cycle}");
        }
        pair.tick(Some(finished(positions(&q_c))));
        assert_eq!(pair.outcome(id), MoveStatus::Success);
        assert_eq!(pair.state.robot_mode, RobotMode::Idle);
        pair.idle(300);
        assert!((pair.robot.q() - READY - offset).amax() < 1e-3);
        assert_eq!(pair.state.dq_d, [0.0; 7]);
    }
}

#[test]
fn joint_velocities_integrate() {
    let mut pair = Pair::fr3();
    let id = pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    let mut sum = 0.0;
    let mut command = RobotCommand::default();
    for cycle in 0..1000 {
        let t = f64::from(cycle) * 1e-3;
        command.dq_c[3] = 0.15 * (1.0 - (core::f64::consts::TAU * t).cos());
        sum += command.dq_c[3] * 1e-3;
        pair.tick(Some(command));
        assert_eq!(pair.state.robot_mode, RobotMode::Move, "{cycle}");
        assert!((pair.state.dq_d[3] - command.dq_c[3]).abs() < 1e-7);
    }
    assert!((pair.q_d()[3] - READY[3] - sum).abs() < 1e-6);
    assert!((pair.q()[3] - pair.q_d()[3]).abs() < 1e-3);
    command.dq_c[3] = 0.0;
    pair.tick(Some(finished(command)));
    assert_eq!(pair.outcome(id), MoveStatus::Success);
}

#[test]
fn cartesian_poses_are_followed_and_echoed() {
    for (kind, controller) in kinds_and_controllers() {
        let mut pair = Pair::of(kind);
        let start = transform::isometry_from_array(&pair.state.O_T_EE_c).expect("a pose");
        let id = pair.start(controller, MoveGeneratorMode::CartesianPosition);
        let mut command = RobotCommand::default();
        for cycle in 0..1000 {
            let s = ramp(f64::from(cycle) * 1e-3, 0.95);
            let mut pose = start;
            pose.translation.vector += Vector3::new(0.05, -0.03, 0.04) * s;
            pose.rotation = rotation::exp(&(Vector3::new(0.0, 0.1, 0.2) * s)) * start.rotation;
            command.O_T_EE_c = transform::array(&pose);
            pair.tick(Some(command));
            assert_eq!(
                pair.state.robot_mode,
                RobotMode::Move,
                "{cycle} {:?}",
                pair.state.errors
            );
            for i in 0..16 {
                assert!((pair.state.O_T_EE_c[i] - command.O_T_EE_c[i]).abs() < 1e-7);
                assert!((pair.state.O_T_EE_d[i] - command.O_T_EE_c[i]).abs() < 1e-7);
                assert!(
                    (pair.state.O_T_EE[i] - command.O_T_EE_c[i]).abs() < 3e-3,
                    "{cycle}"
                );
            }
        }
        pair.tick(Some(finished(command)));
        assert_eq!(pair.outcome(id), MoveStatus::Success);
        pair.idle(500);
        assert!((pair.state.O_T_EE[12] - command.O_T_EE_c[12]).abs() < 1e-3);
    }
}

#[test]
fn cartesian_velocities_integrate_and_name_their_derivatives() {
    let mut pair = Pair::fr3();
    let start = pair.state.O_T_EE_c;
    let id = pair.start(
        MoveControllerMode::CartesianImpedance,
        MoveGeneratorMode::CartesianVelocity,
    );
    let mut command = RobotCommand::default();
    let mut sum = 0.0;
    for cycle in 0..1000 {
        let t = f64::from(cycle) * 1e-3;
        command.O_dP_EE_c[2] = 0.03 * (1.0 - (core::f64::consts::TAU * t).cos());
        command.O_dP_EE_c[5] = 2.0 * command.O_dP_EE_c[2];
        sum += command.O_dP_EE_c[2] * 1e-3;
        pair.tick(Some(command));
        assert_eq!(
            pair.state.robot_mode,
            RobotMode::Move,
            "{cycle} {:?}",
            pair.state.errors
        );
        assert!((pair.state.O_dP_EE_c[2] - command.O_dP_EE_c[2]).abs() < 1e-7);
        assert!((pair.state.O_dP_EE_d[2] - command.O_dP_EE_c[2]).abs() < 1e-3);
    }
    assert!((pair.state.O_T_EE_c[14] - start[14] - sum).abs() < 1e-6);
    assert!((pair.state.O_T_EE[14] - start[14] - sum).abs() < 1e-3);
    command.O_dP_EE_c = [0.0; 6];
    pair.tick(Some(finished(command)));
    assert_eq!(pair.outcome(id), MoveStatus::Success);
}

#[test]
fn the_elbow_moves_while_the_hand_stands() {
    let mut pair = Pair::fr3();
    let pose = pair.state.O_T_EE_c;
    let elbow = pair.state.elbow_c;
    assert_eq!(elbow, [0.0, -1.0]);
    pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::CartesianPosition,
    );
    for cycle in 0..1000 {
        let angle = 0.1 * ramp(f64::from(cycle) * 1e-3, 0.95);
        pair.tick(Some(RobotCommand {
            O_T_EE_c: pose,
            elbow_c: Some([angle, -1.0]),
            ..RobotCommand::default()
        }));
        assert_eq!(
            pair.state.robot_mode,
            RobotMode::Move,
            "{cycle} {:?}",
            pair.state.errors
        );
        assert!((pair.state.elbow_c[0] - angle).abs() < 1e-7);
    }
    assert!((pair.q()[2] - 0.1).abs() < 1e-3);
    for (actual, still) in pair.state.O_T_EE.iter().zip(pose) {
        assert!((actual - still).abs() < 1e-3);
    }
}

#[test]
fn a_soft_joint_gives_way_and_a_stiff_one_does_not() {
    let push = JointVector::from([5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for stiffness in [100.0, 14250.0] {
        let mut pair = Pair::fr3();
        pair.request(&Request::SetJointImpedance([stiffness; 7]));
        pair.start_joints();
        pair.robot.push_joints(push, 2000);
        for _ in 0..2000 {
            pair.tick(Some(positions(&READY)));
        }
        let expected = push[0] / stiffness;
        let yielded = pair.robot.q()[0];
        assert!(
            (yielded - expected).abs() < 0.03 * expected + 1e-5,
            "{yielded} {expected}"
        );
    }
}

#[test]
fn the_cartesian_stiffness_acts_at_the_stiffness_frame() {
    let mut pair = Pair::fr3();
    pair.request(&Request::SetCartesianImpedance([
        500.0, 500.0, 500.0, 50.0, 50.0, 50.0,
    ]));
    pair.start(
        MoveControllerMode::CartesianImpedance,
        MoveGeneratorMode::JointPosition,
    );
    let z = pair.state.O_T_EE[14];
    let down = Wrench::new(0.0, 0.0, -10.0, 0.0, 0.0, 0.0);
    pair.robot.push_end_effector(down, 3000);
    for _ in 0..3000 {
        pair.tick(Some(positions(&READY)));
    }
    let sunk = z - pair.state.O_T_EE[14];
    assert!((sunk - 0.02).abs() < 1e-3, "{sunk}");
}

#[test]
fn a_motion_follows_a_motion_on_one_connection() {
    let mut pair = Pair::fr3();
    for _ in 0..3 {
        let id = pair.start_joints();
        for _ in 0..20 {
            pair.tick(Some(positions(&READY)));
        }
        pair.tick(Some(finished(positions(&READY))));
        assert_eq!(pair.outcome(id), MoveStatus::Success);
    }
}
