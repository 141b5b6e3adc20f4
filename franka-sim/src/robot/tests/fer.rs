//! What is different about a Franka Emika Robot, and protocol 5.

use franka_model::limits::JointLimits;
use franka_model::{JointVector, READY, RobotKind};
use franka_proto::{
    Architecture, Filters, LibraryStatus, MotionGeneratorMode, Request, RobotError as E,
    SetterStatus, Status, System,
};

use super::*;

fn fer() -> Pair {
    Pair::of(RobotKind::Fer)
}

fn finished(command: RobotCommand) -> RobotCommand {
    RobotCommand {
        motion_generation_finished: true,
        ..command
    }
}

#[test]
fn its_own_gravity_compensation_holds_the_arm_and_nothing_seems_to_touch_it() {
    let mut pair = fer();
    pair.idle(2000);
    assert!((pair.robot.q() - READY).amax() < 1e-9);
    let felt = JointVector::from(pair.state.tau_ext_hat_filtered);
    assert!(felt.amax() < 1e-6, "{felt}");
    assert!(pair.state.tau_J[3] > 15.0, "{:?}", pair.state.tau_J);
}

#[test]
fn torques_come_beside_a_generator_of_zero_velocities() {
    let mut pair = fer();
    let id = pair.start_torques();
    let tau = JointVector::from([0.1, -0.2, 0.3, 0.4, -0.5, 0.05, 0.02]);
    pair.tick(Some(torques(&tau)));
    assert_eq!(
        pair.state.motion_generator_mode,
        MotionGeneratorMode::JointVelocity
    );
    assert_eq!(
        pair.state.controller_mode,
        ControllerMode::ExternalController
    );
    // No number is rounded on the way.
    assert_eq!(JointVector::from(pair.state.tau_J_d), tau);
    for _ in 0..100 {
        pair.tick(Some(torques(&tau)));
    }
    assert!(pair.robot.dq().norm() > 1e-3, "torques move the arm");
    assert_eq!(pair.q_d(), READY, "and the generator stands still");
    while pair.robot.dq().amax() > 0.05 {
        let brake = -JointVector::from(pair.state.dq) * 2.0;
        let last = JointVector::from(pair.state.tau_J_d);
        let tau = last + (brake - last).map(|d| d.clamp(-0.9, 0.9));
        pair.tick(Some(torques(&tau)));
    }
    let tau = JointVector::from(pair.state.tau_J_d);
    pair.tick(Some(finished(torques(&tau))));
    assert_eq!(pair.outcome(id), MoveStatus::Success);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    pair.idle(500);
    assert!(pair.robot.dq().amax() < 1e-3);
}

#[test]
fn states_carry_what_is_commanded_to_the_last_digit() {
    let mut pair = fer();
    let id = pair.start_joints();
    let offset = JointVector::from([0.1, -0.1, 0.1, 0.1, -0.1, 0.1, 0.2]) / 3.0;
    let mut q_c = READY;
    for cycle in 0..500 {
        q_c = READY + offset * ramp(f64::from(cycle) * 1e-3, 0.48);
        pair.tick(Some(positions(&q_c)));
        assert_eq!(pair.q_d(), q_c, "{cycle}");
    }
    pair.tick(Some(finished(positions(&q_c))));
    assert_eq!(pair.outcome(id), MoveStatus::Success);
}

/// Accelerates joint `joint` of an arm of `kind` at `ddq`, reached within its jerk limit, and tells
/// what that raises within 50 ms.
fn accelerate(kind: RobotKind, joint: usize, ddq: f64) -> Errors {
    let mut pair = Pair::of(kind);
    pair.start_joints();
    let (mut q, mut dq) = (READY, 0.0);
    for cycle in 1..=50 {
        dq += ddq * (f64::from(cycle) / 10.0).min(1.0) * 1e-3;
        q[joint] += dq * 1e-3;
        pair.tick(Some(positions(&q)));
        if pair.state.robot_mode != RobotMode::Move {
            break;
        }
    }
    pair.state.errors
}

#[test]
fn each_joint_has_an_acceleration_limit_of_its_own() {
    let discontinuity = Errors::from(E::JointMotionGeneratorVelocityDiscontinuity);
    for (joint, passes, fails) in [(0, 14.9, 15.1), (1, 7.4, 7.6), (6, 19.9, 20.1)] {
        assert_eq!(accelerate(RobotKind::Fer, joint, passes), Errors::NONE);
        assert_eq!(accelerate(RobotKind::Fer, joint, fails), discontinuity);
    }
    assert_eq!(accelerate(RobotKind::Fr3, 1, 9.9), Errors::NONE);
    assert_eq!(accelerate(RobotKind::Fr3, 0, 10.1), discontinuity);
}

#[test]
fn a_position_beyond_the_range_is_named_after_what_was_commanded() {
    let upper = JointLimits::of(RobotKind::Fer).hard_upper[0];
    let mut q = READY;
    q[0] = upper - 0.05;
    let mut pair = Pair::connected(Config {
        kind: RobotKind::Fer,
        q,
        ..Config::default()
    });
    let id = pair.start_joints();
    let mut t = 0.0;
    while pair.state.robot_mode == RobotMode::Move {
        t += 1e-3;
        q[0] = upper - 0.05 + 0.1 * ramp(t, 2.0);
        pair.tick(Some(positions(&q)));
    }
    pair.assert_reflex(id, &[E::JointMotionGeneratorPositionLimitsViolation]);
}

#[test]
fn requests_of_protocol_5_are_answered() {
    let mut pair = fer();
    let good = pair.request(&Request::SetFilters(Filters::uniform(100.0)));
    let bad = pair.request(&Request::SetFilters(Filters::uniform(1001.0)));
    let wall = pair.request(&Request::GetCartesianLimit { id: 0 });
    let library = pair.request(&Request::LoadModelLibrary {
        architecture: Architecture::X64,
        system: System::Linux,
    });
    let recovery = pair.request(&Request::AutomaticErrorRecovery);
    for (id, status) in [
        (good, Status::Setter(SetterStatus::Success)),
        (bad, Status::Setter(SetterStatus::InvalidArgumentRejected)),
        (wall, Status::Setter(SetterStatus::Success)),
        (library, Status::Library(LibraryStatus::Error)),
        (
            recovery,
            Status::Recovery(franka_proto::RecoveryStatus::Success),
        ),
    ] {
        assert_eq!(pair.statuses(id), [status]);
    }
    assert_eq!(pair.robot.description(), None);
    assert_eq!(pair.state.accelerometer_top, [[0.0; 3]; 6]);
}

#[test]
fn a_library_that_the_robot_was_given_is_served_if_it_fits_into_a_message() {
    for (size, status) in [(3, LibraryStatus::Success), (9 << 20, LibraryStatus::Error)] {
        let mut pair = Pair::connected(Config {
            kind: RobotKind::Fer,
            model_library: Some(vec![7; size].into()),
            ..Config::default()
        });
        let id = pair.request(&Request::LoadModelLibrary {
            architecture: Architecture::X64,
            system: System::Linux,
        });
        assert_eq!(pair.statuses(id), [Status::Library(status)]);
    }
}
