use franka_model::{EndEffector, Frame, JointVector, Load, Model, READY, RobotKind, Wrench};
use franka_proto::{
    CollisionBehavior, MoveStatus, Request, RobotCommand, RobotError as E, RobotMode, RobotState,
};
use franka_sim::{Config, Touch};
use nalgebra::{Matrix3, Vector3};

use crate::pair::{Pair, noisy, positions, ramp, torques};

const HIGH: f64 = 1e4;

fn thresholds(lower: f64, upper: f64) -> Request {
    Request::SetCollisionBehavior(CollisionBehavior::uniform(
        [HIGH; 7], [HIGH; 7], [lower; 6], [upper; 6],
    ))
}

fn half_kilogram() -> Load {
    Load {
        mass: 0.5,
        com: Vector3::new(0.0, 0.0, 0.05),
        inertia: Matrix3::identity() * 1e-3,
    }
}

fn declare(load: &Load) -> Request {
    let mut inertia = [0.0; 9];
    inertia.copy_from_slice(load.inertia.as_slice());
    Request::SetLoad(franka_proto::Load {
        m_load: load.mass,
        F_x_Cload: load.com.into(),
        I_load: inertia,
    })
}

fn felt(state: &RobotState) -> Vector3<f64> {
    let [x, y, z, ..] = state.O_F_ext_hat_K;
    // The state contains the force of the robot on the hand.
    -Vector3::new(x, y, z)
}

#[test]
fn the_thresholds_of_joints_give_a_joint_reflex() {
    let mut pair = Pair::fr3();
    let behavior = CollisionBehavior::uniform([6.0; 7], [12.0; 7], [HIGH; 6], [HIGH; 6]);
    pair.request(&Request::SetCollisionBehavior(behavior));
    let id = pair.start_joints();
    let lean = |torque: f64| Touch::torque(JointVector::repeat(0.0) + axis(3) * torque);
    pair.robot.touch(lean(9.0));
    for _ in 0..300 {
        pair.tick(Some(positions(&READY)));
    }
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    assert_eq!(
        pair.state.joint_contact,
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    );
    pair.robot.touch(lean(5.0));
    pair.run_out(positions(&READY), 300);
    pair.assert_reflex(id, &[E::JointReflex]);
    assert_eq!(pair.state.joint_collision[3], 1.0);
    pair.robot.let_go();
    pair.idle(200);
    assert_eq!(pair.state.joint_contact, [0.0; 7], "contact goes");
    assert_eq!(pair.state.joint_collision[3], 1.0, "collision stays");
    pair.recover();
    pair.tick(None);
    assert_eq!(pair.state.joint_collision, [0.0; 7]);
}

fn axis(joint: usize) -> JointVector {
    JointVector::from_fn(|i, _| if i == joint { 1.0 } else { 0.0 })
}

#[test]
fn acceleration_phases_have_thresholds_of_their_own() {
    let run = |acceleration: f64, nominal: f64, moves: bool| {
        let mut pair = Pair::fr3();
        let mut behavior =
            CollisionBehavior::uniform([HIGH; 7], [HIGH; 7], [HIGH; 6], [nominal; 6]);
        behavior.upper_force_thresholds_acceleration = [acceleration; 6];
        pair.request(&Request::SetCollisionBehavior(behavior));
        pair.start_joints();
        let push = Vector3::new(0.0, 0.0, -10.0);
        for cycle in 0..700 {
            let mut q = READY;
            if moves {
                // The acceleration exceeds 1 rad/s² from 0.1 s to 0.25 s.
                q[0] += 0.1 * ramp(f64::from(cycle) * 1e-3, 0.6);
            }
            if cycle == 100 {
                pair.robot.touch(Touch::force(push).lasting(100));
            }
            pair.tick(Some(positions(&q)));
        }
        pair.state.errors
    };
    assert!(run(5.0, HIGH, true).contains(E::CartesianReflex));
    assert!(run(HIGH, 5.0, true).is_empty());
    assert!(run(HIGH, 5.0, false).contains(E::CartesianReflex));
    assert!(run(5.0, HIGH, false).is_empty());
}

#[test]
fn equal_lower_and_upper_thresholds_are_legal() {
    let mut pair = Pair::fr3();
    pair.request(&thresholds(10.0, 10.0));
    let id = pair.start_joints();
    let push = Vector3::new(0.0, 0.0, -12.0);
    pair.robot.touch(Touch::force(push));
    pair.run_out(positions(&READY), 500);
    pair.assert_reflex(id, &[E::CartesianReflex]);
    assert_eq!(pair.state.cartesian_contact[2], 1.0);
}

#[test]
fn undeclared_load_seems_external_and_lowers_the_arm() {
    for declared in [false, true] {
        let load = half_kilogram();
        let mut pair = Pair::fr3();
        if declared {
            pair.request(&declare(&load));
            pair.idle(1000);
        }
        pair.robot.attach(load);
        let height = pair.position()[2];
        pair.start_torques();
        for _ in 0..700 {
            pair.tick(Some(RobotCommand::default()));
        }
        let (weight, sunk) = (pair.state.O_F_ext_hat_K[2], height - pair.position()[2]);
        if declared {
            assert!(weight.abs() < 0.1, "{weight}");
            assert!(sunk.abs() < 0.01, "{sunk}");
        } else {
            assert!((weight - 0.5 * 9.81).abs() < 1.0, "{weight}");
            assert!(sunk > 0.05, "{sunk}");
        }
    }
}

#[test]
fn a_declared_load_that_is_not_there_lifts_the_arm() {
    let mut pair = Pair::fr3();
    pair.request(&declare(&half_kilogram()));
    let height = pair.position()[2];
    pair.start_torques();
    for _ in 0..700 {
        pair.tick(Some(RobotCommand::default()));
    }
    assert!(pair.position()[2] - height > 0.05);
    assert!(pair.state.O_F_ext_hat_K[2] < -3.0);
}

#[test]
fn the_wrench_is_told_at_the_stiffness_frame() {
    let mut pair = Pair::fr3();
    let lever = 0.2;
    let mut ee_t_k = pair.state.EE_T_K;
    ee_t_k[14] = lever;
    pair.request(&Request::SetEEToK(ee_t_k));
    pair.robot
        .touch(Touch::wrench(Wrench::new(4.0, 0.0, 0.0, 0.0, 0.0, 0.0)));
    pair.idle(500);
    let seen = pair.state.wrench_at_stiffness_frame();
    assert!((seen[0] + 4.0).abs() < 0.1, "{seen:?}");
    // The tool points down. The force therefore acts above the frame's origin, with a torque about
    // y.
    assert!((seen[4] + 4.0 * lever).abs() < 0.05, "{seen:?}");
    // With every stiffness frame, the torque in base axes is about the base's origin, and the lever
    // is the position of the flange.
    let [x, y, z] = pair.position();
    let moment = Vector3::new(x, y, z).cross(&Vector3::new(-4.0, 0.0, 0.0));
    let about_base = Vector3::from_column_slice(&pair.state.O_F_ext_hat_K[3..]);
    assert!((about_base - moment).amax() < 0.05, "{about_base} {moment}");
}

#[test]
fn the_wrench_is_zero_near_a_singularity_of_either_robot() {
    for kind in RobotKind::ALL {
        // The smallest singular value of the flange's Jacobian is compared with the bound.
        let least = |q: &JointVector| {
            let jacobian = Model::of(kind).zero_jacobian(Frame::Flange, q, &EndEffector::default());
            let gram = jacobian * jacobian.transpose();
            gram.symmetric_eigenvalues().min().sqrt()
        };
        let mut stretched = READY;
        (stretched[1], stretched[3]) = (0.6, -0.65);
        for (q, is_near) in [(READY, false), (stretched, true)] {
            assert_eq!(least(&q) < 0.1, is_near, "{}", least(&q));
            let mut pair = Pair::new(Config {
                kind,
                q,
                ..Config::default()
            });
            let push = Wrench::new(0.0, 6.0, 0.0, 0.0, 0.0, 0.0);
            pair.robot.touch(Touch::wrench(push));
            pair.idle(400);
            let state = &pair.state;
            assert!(state.tau_ext_hat_filtered.iter().any(|tau| tau.abs() > 0.5));
            let is_zero = [state.O_F_ext_hat_K, state.K_F_ext_hat_K] == [[0.0; 6]; 2];
            assert_eq!(is_zero, is_near, "{:?}", state.O_F_ext_hat_K);
        }
    }
}

#[test]
fn noise_of_the_sensors_reaches_the_estimate() {
    let mut pair = Pair::new(Config {
        arm: Some(noisy()),
        ..Config::default()
    });
    let mut most = 0.0_f64;
    for _ in 0..500 {
        pair.tick(None);
        most = most.max(felt(&pair.state).norm());
    }
    assert!(most > 0.05 && most < 5.0, "{most}");
}

#[test]
fn a_push_shows_in_the_estimate_with_the_robots_sign() {
    let mut pair = Pair::fr3();
    let push = Wrench::new(3.0, -2.0, 5.0, 0.1, 0.2, -0.3);
    pair.robot.push_end_effector(push, 500);
    pair.idle(400);
    let estimate = Wrench::from(pair.state.wrench_at_stiffness_frame());
    assert!((estimate + push).amax() < 0.1, "{estimate}");
    pair.idle(400);
    assert!(Wrench::from(pair.state.O_F_ext_hat_K).amax() < 0.05);
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
        // The client holds the arm firmly. Otherwise the push would only move the arm.
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
    assert!(pair.state.errors.contains(E::JointReflex));
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
