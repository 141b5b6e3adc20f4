use franka_model::{Frame, JointVector, Model, READY, RobotKind, limits::JointLimits};
use franka_proto::{
    Architecture, ControllerMode, Errors, Filters, LibraryStatus, MotionGeneratorMode,
    MoveControllerMode, MoveGeneratorMode, MoveStatus, Request, RobotCommand, RobotError as E,
    RobotMode, SetterStatus, Status, System, VirtualWall,
};
use franka_sim::{Config, Touch};

use crate::pair::{Pair, positions, ramp, stay, torques};

#[test]
fn a_stop_preempts_the_move_and_does_not_make_it_a_success() {
    let mut pair = Pair::fer();
    let id = pair.start_joints();
    pair.tick(Some(positions(&READY)));
    pair.request(&Request::StopMove);
    assert_eq!(pair.outcome(id), MoveStatus::Preempted);
}

/// A box around the ready pose of an FER, with 5 cm of space to each side.
fn wall() -> VirtualWall {
    let pose = Model::fer().pose(Frame::EndEffector, &READY, &Default::default());
    let mut object_frame = [0.0; 16];
    for i in 0..4 {
        object_frame[5 * i] = 1.0;
    }
    for axis in 0..3 {
        object_frame[12 + axis] = pose[(axis, 3)] - 0.05;
    }
    VirtualWall {
        object_world_size: [0.1; 3],
        object_frame,
        object_activation: true,
    }
}

fn walled(object_activation: bool) -> Pair {
    let wall = VirtualWall {
        object_activation,
        ..wall()
    };
    Pair::new(Config {
        kind: RobotKind::Fer,
        walls: vec![(3, wall)],
        ..Config::default()
    })
}

#[test]
fn get_cartesian_limit_tells_the_walls_that_there_are() {
    let mut pair = walled(true);
    let mut seen = Vec::new();
    for id in [3, 0] {
        let status = pair.ask(&Request::GetCartesianLimit { id });
        assert_eq!(status, Status::Setter(SetterStatus::Success));
        seen.push(pair.sizes[pair.sizes.len() - 1]);
    }
    // The header is followed by status, corner, frame and flag.
    assert_eq!(seen, [12 + 1 + 3 * 8 + 16 * 8 + 1; 2]);
    assert_eq!(pair.wall(3), wall());
    assert!(!pair.wall(0).object_activation);
}

#[test]
fn the_end_effector_stays_within_an_active_wall() {
    let rise = |mut pair: Pair, upwards: f64| {
        let id = pair.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::CartesianPosition,
        );
        let first = stay(&pair.state);
        for cycle in 0..2000 {
            let mut command = first;
            command.O_T_EE_c[14] += upwards * ramp(f64::from(cycle) * 1e-3, 1.8);
            pair.tick(Some(command));
            if pair.state.robot_mode != RobotMode::Move {
                break;
            }
        }
        (pair, id)
    };
    let (pair, _) = rise(walled(true), 0.04);
    assert_eq!(
        pair.state.robot_mode,
        RobotMode::Move,
        "{}",
        pair.state.errors
    );
    let (pair, _) = rise(walled(false), 0.1);
    assert_eq!(
        pair.state.robot_mode,
        RobotMode::Move,
        "{}",
        pair.state.errors
    );
    let (mut pair, id) = rise(walled(true), 0.1);
    pair.assert_reflex(id, &[E::CartesianPositionLimitsViolation]);
    pair.recover();
    // A motion back into the box is always possible.
    let (pair, _) = rise(pair, -0.05);
    assert_eq!(
        pair.state.robot_mode,
        RobotMode::Move,
        "{}",
        pair.state.errors
    );
}

#[test]
fn the_joints_themselves_are_watched() {
    let mut pair = Pair::fer();
    let id = pair.start_torques();
    let mut tau = JointVector::zeros();
    for _ in 0..2000 {
        tau[5] = (tau[5] + 0.01).min(3.0);
        pair.tick(Some(torques(&tau)));
        if pair.state.robot_mode != RobotMode::Move {
            break;
        }
    }
    pair.assert_reflex(id, &[E::JointVelocityViolation]);
    let limit = JointLimits::of(RobotKind::Fer).velocity[5];
    assert!(pair.robot.dq()[5] > limit);
}

#[test]
fn joint_1_follows_velocity_commands() {
    let mut pair = Pair::fer();
    pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    for cycle in 0..500 {
        let mut command = RobotCommand::default();
        command.dq_c[0] = 0.4 * ramp(f64::from(cycle) * 1e-3, 0.3);
        pair.tick(Some(command));
    }
    assert!(
        (pair.state.dq[0] - 0.4).abs() < 0.01,
        "{}",
        pair.state.dq[0]
    );
    assert!(pair.q()[0] > 0.1);
}

#[test]
fn o_t_ee_is_at_the_flange_and_not_at_the_last_joint() {
    let pair = Pair::fer();
    let flange = Model::fer().pose(Frame::Flange, &READY, &Default::default());
    let joint = Model::fer().pose(Frame::Joint7, &READY, &Default::default());
    assert!((pair.state.O_T_EE[14] - flange[(2, 3)]).abs() < 1e-9);
    assert!((pair.state.O_T_EE[14] - joint[(2, 3)]).abs() > 0.1);
}

#[test]
fn a_push_reads_right_beside_a_running_motion() {
    let mut pair = Pair::fer();
    pair.start_joints();
    pair.robot
        .touch(Touch::force(nalgebra::Vector3::new(0.0, 5.0, 0.0)));
    for _ in 0..100 {
        pair.tick(Some(positions(&READY)));
    }
    assert!((pair.state.O_F_ext_hat_K[1] + 5.0).abs() < 0.3);
}

fn finished(command: RobotCommand) -> RobotCommand {
    RobotCommand {
        motion_generation_finished: true,
        ..command
    }
}

#[test]
fn gravity_compensation_holds_arm_and_shows_no_contact() {
    let mut pair = Pair::fer();
    pair.idle(2000);
    assert!((pair.robot.q() - READY).amax() < 1e-9);
    let felt = JointVector::from(pair.state.tau_ext_hat_filtered);
    assert!(felt.amax() < 1e-6, "{felt}");
    assert!(pair.state.tau_J[3] > 15.0, "{:?}", pair.state.tau_J);
}

#[test]
fn torques_come_beside_a_generator_of_zero_velocities() {
    let mut pair = Pair::fer();
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
    // The protocol rounds no number.
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
    let mut pair = Pair::fer();
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

/// Accelerates joint `joint` of an arm of `kind` to the acceleration `ddq`, within its jerk limit.
/// Returns the errors that occur within 50 ms.
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
fn requests_of_protocol_5_are_answered() {
    let mut pair = Pair::fer();
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
fn model_library_is_served_if_it_fits_into_a_message() {
    for (size, status) in [(3, LibraryStatus::Success), (9 << 20, LibraryStatus::Error)] {
        let mut pair = Pair::new(Config {
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
