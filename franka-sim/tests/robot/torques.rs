//! Motions in which the client's torques drive the arm.

use franka_model::{READY, Twist, rotation};
use franka_proto::{MotionGeneratorMode, MoveGeneratorMode};

use crate::pair::*;

#[test]
fn zero_torque_holds_the_arm_for_two_seconds() {
    let mut pair = Pair::fr3();
    let id = pair.start_torques();
    for _ in 0..2000 {
        pair.tick(Some(RobotCommand::default()));
    }
    assert_eq!(pair.state.motion_generator_mode, MotionGeneratorMode::None);
    assert!((pair.robot.q() - READY).amax() < 1e-9);
    assert_eq!(pair.state.control_command_success_rate, 1.0);
    let finish = RobotCommand {
        torque_command_finished: true,
        ..RobotCommand::default()
    };
    pair.tick(Some(finish));
    assert_eq!(pair.outcome(id), MoveStatus::Success);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert_eq!(pair.state.control_command_success_rate, 0.0);
}

#[test]
fn torques_are_echoed_in_single_precision() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let tau = JointVector::from([0.1, -0.2, 0.3, 0.4, -0.5, 0.05, 0.02]);
    pair.tick(Some(torques(&tau)));
    let echo = JointVector::from(pair.state.tau_J_d);
    assert_eq!(echo, tau.map(|t| f64::from(t as f32)));
}

#[test]
fn impedance_of_750_n_per_m_ends_within_0_3_millimetres() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let model = franka_model::Model::fr3();
    let frames = franka_model::EndEffector::default();
    let start = pair.pose_at(&READY);
    let mut last = JointVector::zeros();
    for cycle in 0..4000 {
        let (q, dq) = (pair.q(), JointVector::from(pair.state.dq));
        let frame = franka_model::Frame::EndEffector;
        let jacobian = model.zero_jacobian(frame, &q, &frames);
        let pose = pair.pose_at(&q);
        let mut goal = start;
        goal.translation.vector.z += 0.05 * ramp(f64::from(cycle) * 1e-3, 1.0);
        let shift = (goal.translation.vector - pose.translation.vector) * 750.0;
        let turn = rotation::error(&goal.rotation, &pose.rotation) * 50.0;
        let spring = stack(&shift, &turn);
        let velocity = jacobian * dq;
        let damper = Twist::from_fn(|i, _| if i < 3 { 55.0 } else { 14.0 } * velocity[i]);
        let tau = jacobian.tr_mul(&(spring - damper));
        let step = (tau - last).map(|d| d.clamp(-0.99, 0.99));
        last += step;
        pair.tick(Some(torques(&last)));
    }
    let end = pair.pose_at(pair.robot.q());
    let error = end.translation.vector.z - start.translation.vector.z - 0.05;
    assert!(error.abs() < 0.3e-3, "{error}");
    assert!(pair.robot.dq().amax() < 1e-3);
}

#[test]
fn a_strong_damper_on_the_last_joint_is_stable() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let kick = JointVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    pair.robot.push_joints(kick, 50);
    for _ in 0..2000 {
        let mut tau = (READY - pair.q()) * 50.0;
        let dq = JointVector::from(pair.state.dq);
        tau[6] -= 15.0 * dq[6];
        pair.tick(Some(torques(&tau.map(|t| t.clamp(-0.5, 0.5)))));
    }
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    assert!(pair.robot.dq()[6].abs() < 1e-3, "{}", pair.robot.dq());
}

#[test]
fn torques_and_a_generator_run_side_by_side() {
    let mut pair = Pair::fr3();
    let id = pair.start(
        MoveControllerMode::ExternalController,
        MoveGeneratorMode::JointPosition,
    );
    for cycle in 0..1000 {
        let mut q_c = READY;
        q_c[0] += 0.1 * ramp(f64::from(cycle) * 1e-3, 0.9);
        let error = q_c - pair.q();
        let dq = JointVector::from(pair.state.dq);
        let tau = error * 200.0 - dq * 20.0;
        pair.tick(Some(RobotCommand {
            tau_J_d: tau.into(),
            ..positions(&q_c)
        }));
        assert_eq!(pair.state.robot_mode, RobotMode::Move, "{cycle}");
    }
    assert!((pair.q_d()[0] - 0.1).abs() < 1e-7);
    assert!((pair.q()[0] - 0.1).abs() < 1e-2);
    let mut last = READY;
    last[0] += 0.1;
    pair.tick(Some(RobotCommand {
        motion_generation_finished: true,
        ..positions(&last)
    }));
    assert_eq!(pair.outcome(id), MoveStatus::Success);
}

#[test]
fn a_torque_jump_is_refused_from_the_first_command_on() {
    for warm_up in [0, 5] {
        let mut pair = Pair::fr3();
        let id = pair.start_torques();
        for _ in 0..warm_up {
            pair.tick(Some(RobotCommand::default()));
        }
        let mut tau = JointVector::zeros();
        tau[2] = 1.0;
        pair.tick(Some(torques(&tau)));
        assert_eq!(pair.state.robot_mode, RobotMode::Move);
        tau[2] = 2.01;
        pair.tick(Some(torques(&tau)));
        pair.assert_reflex(id, &[RobotError::ControllerTorqueDiscontinuity]);
    }
}

#[test]
fn a_lost_torque_is_repeated() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let tau = JointVector::repeat(0.25);
    pair.tick(Some(torques(&tau)));
    pair.tick(None);
    assert_eq!(JointVector::from(pair.state.tau_J_d), tau);
    assert_eq!(pair.state.control_command_success_rate, 0.5);
}

#[test]
fn too_fast_a_joint_is_stopped() {
    let mut pair = Pair::fr3();
    let id = pair.start_torques();
    let mut tau = JointVector::zeros();
    for _ in 0..3000 {
        tau[5] = (tau[5] + 0.003).min(3.0);
        pair.tick(Some(torques(&tau)));
        if pair.state.robot_mode != RobotMode::Move {
            break;
        }
    }
    pair.assert_reflex(id, &[RobotError::JointVelocityViolation]);
    pair.idle(600);
    assert!(pair.robot.dq().amax() < 1e-3);
}
