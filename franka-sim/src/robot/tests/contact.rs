//! What the robot makes of being pushed.

use franka_model::{Load, READY, Wrench};
use nalgebra::{Matrix3, Vector3};

use super::*;

#[test]
fn a_push_shows_in_the_estimate_with_the_robots_sign() {
    let mut pair = Pair::fr3();
    let push = Wrench::new(3.0, -2.0, 5.0, 0.1, 0.2, -0.3);
    pair.robot.push_end_effector(push, 500);
    pair.idle(400);
    let estimate = Wrench::from(pair.state.O_F_ext_hat_K);
    assert!((estimate + push).amax() < 0.1, "{estimate}");
    pair.idle(400);
    assert!(Wrench::from(pair.state.O_F_ext_hat_K).amax() < 0.05);
}

#[test]
fn an_undeclared_load_is_felt_and_a_declared_one_is_not() {
    let mut pair = Pair::fr3();
    let load = Load {
        mass: 0.5,
        com: Vector3::new(0.0, 0.0, 0.05),
        inertia: Matrix3::identity() * 1e-3,
    };
    pair.robot.attach(load);
    pair.idle(1500);
    // The robot holds it up: it pushes upwards.
    assert!((pair.state.O_F_ext_hat_K[2] - 0.5 * 9.81).abs() < 0.1);
    let mut inertia = [0.0; 9];
    inertia.copy_from_slice(load.inertia.as_slice());
    pair.request(&Request::SetLoad(franka_proto::Load {
        m_load: load.mass,
        F_x_Cload: load.com.into(),
        I_load: inertia,
    }));
    pair.idle(1500);
    assert!(pair.state.O_F_ext_hat_K[2].abs() < 0.05);
}

#[test]
fn moving_fast_feels_like_nothing() {
    let mut pair = Pair::fr3();
    pair.start_joints();
    let offset = JointVector::from([0.4, 0.2, 0.2, 0.3, -0.4, 0.3, 0.5]);
    for cycle in 0..1000 {
        let q_c = READY + offset * ramp(f64::from(cycle) * 1e-3, 0.9);
        pair.tick(Some(positions(&q_c)));
        let felt = JointVector::from(pair.state.tau_ext_hat_filtered).amax();
        assert!(felt < 0.2, "{cycle}: {felt}");
    }
}

#[test]
fn contact_comes_and_goes_and_collision_stays_until_recovery() {
    let mut pair = Pair::fr3();
    let behavior =
        franka_proto::CollisionBehavior::uniform([18.0; 7], [36.0; 7], [500.0; 6], [500.0; 6]);
    pair.request(&Request::SetCollisionBehavior(behavior));
    let id = pair.start_torques();
    let push = JointVector::from([0.0, 0.0, 0.0, 25.0, 0.0, 0.0, 0.0]);
    pair.robot.push_joints(push, 2000);
    let mut contact = false;
    for _ in 0..500 {
        // A stiff hold, so that the push is felt and does not only move the arm.
        let error = READY - pair.q();
        let dq = JointVector::from(pair.state.dq);
        let wish = error * 400.0 - dq * 20.0;
        let last = JointVector::from(pair.state.tau_J_d);
        let tau = last + (wish - last).map(|d| d.clamp(-0.9, 0.9));
        pair.tick(Some(torques(&tau)));
        contact |= pair.state.joint_contact[3] == 1.0;
    }
    assert!(contact);
    assert_eq!(pair.state.joint_collision[3], 0.0);
    assert_eq!(pair.state.robot_mode, RobotMode::Move);

    let shove = JointVector::from([0.0, 0.0, 0.0, 25.0, 0.0, 0.0, 0.0]);
    pair.robot.push_joints(shove, 100);
    while pair.state.robot_mode == RobotMode::Move {
        let tau = JointVector::from(pair.state.tau_J_d);
        pair.tick(Some(torques(&tau)));
    }
    assert!(pair.state.errors.contains(RobotError::JointReflex));
    assert_eq!(pair.outcome(id), MoveStatus::ReflexAborted);
    assert_eq!(pair.state.joint_collision[3], 1.0);
    pair.robot.let_go();
    pair.idle(200);
    assert_eq!(pair.state.joint_contact[3], 0.0);
    assert_eq!(pair.state.joint_collision[3], 1.0);
    pair.request(&Request::AutomaticErrorRecovery);
    pair.idle(300);
    assert_eq!(pair.state.joint_collision[3], 0.0);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
}

#[test]
fn a_cartesian_threshold_gives_a_cartesian_reflex() {
    let mut pair = Pair::fr3();
    let behavior = franka_proto::CollisionBehavior::uniform(
        [100.0; 7],
        [100.0; 7],
        [5.0; 6],
        [10.0, 10.0, 10.0, 100.0, 100.0, 100.0],
    );
    pair.request(&Request::SetCollisionBehavior(behavior));
    let id = pair.start_joints();
    pair.robot
        .push_end_effector(Wrench::new(0.0, 0.0, -12.0, 0.0, 0.0, 0.0), 1000);
    for _ in 0..1000 {
        pair.tick(Some(positions(&READY)));
        if pair.state.robot_mode != RobotMode::Move {
            break;
        }
    }
    pair.assert_reflex(id, &[RobotError::CartesianReflex]);
    assert_eq!(pair.state.cartesian_collision[2], 1.0);
    assert_eq!(pair.state.cartesian_contact[2], 1.0);
}
