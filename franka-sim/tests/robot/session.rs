//! Connection, requests, stop, recovery, and peers that violate the protocol.

use franka_model::READY;
use franka_proto::framing::Header;
use franka_proto::{RecoveryStatus, SetterStatus, StopStatus};

use crate::pair::*;
use franka_sim::SessionError;

#[test]
fn the_first_state_is_consistent() {
    let pair = Pair::fr3();
    let state = &pair.state;
    assert_eq!(state.robot_mode, RobotMode::Idle);
    assert_eq!(state.O_ddP_O, [0.0, 0.0, f64::from(-9.81_f32)]);
    assert!((state.O_T_EE[12] - 0.306_890_566_593).abs() < 1e-7);
    assert!((state.O_T_EE[14] - 0.590_282_052_303).abs() < 1e-7);
    for i in 0..16 {
        assert!((state.O_T_EE_c[i] - state.O_T_EE[i]).abs() < 1e-6);
        assert!((state.O_T_EE_d[i] - state.O_T_EE[i]).abs() < 1e-6);
    }
    assert!((state.tau_J[3] - 18.958).abs() < 1e-3);
    for i in 0..7 {
        assert!((state.theta[i] - state.q[i]).abs() < 0.01);
        assert!(state.tau_ext_hat_filtered[i].abs() < 1e-6);
    }
    // Board 0 is horizontal, so gravity acts along its axis.
    assert_eq!(state.accelerometer_bottom[0], [0.0, 0.0, 9.81]);
}

#[test]
fn only_one_client_at_a_time() {
    let mut robot = Robot::new(Config::default());
    assert!(robot.connect());
    assert!(!robot.connect());
    robot.disconnect();
    assert!(robot.connect());
}

#[test]
fn garbage_disconnects() {
    for garbage in [vec![0xff; 64], vec![0; 64], {
        let header = Header {
            command: 99,
            command_id: 1,
            size: 12,
        };
        header.to_bytes().to_vec()
    }] {
        let mut robot = Robot::new(Config::default());
        robot.connect();
        assert!(robot.receive(&garbage).is_err());
        assert!(!robot.is_connected());
        assert!(robot.tick().is_none());
    }
    let mut pair = Pair::fr3();
    let id = pair.start_joints();
    pair.robot.command(&[0xff; 20]);
    pair.robot.command(&[0xff; 400]);
    pair.tick(None);
    assert_eq!(pair.statuses(id).len(), 1);
    assert!(matches!(
        pair.robot.receive(&[0xff; 12]),
        Err(SessionError::Frame(_))
    ));
}

#[test]
fn requests_may_arrive_byte_by_byte() {
    let mut pair = Pair::fr3();
    let message = pair.client.request(&Request::GetRobotModel).expect("room");
    for byte in message.as_bytes() {
        pair.send(&[*byte]);
    }
    assert_eq!(pair.statuses(message.id()).len(), 1);
}

#[test]
fn setters_are_echoed() {
    let mut pair = Pair::fr3();
    let mut ne_t_ee = pair.state.NE_T_EE;
    ne_t_ee[14] = 0.1;
    let z = pair.state.O_T_EE[14];
    let load = franka_proto::Load {
        m_load: 0.5,
        ..franka_proto::Load::default()
    };
    let id = pair.request(&Request::SetNEToEE(ne_t_ee));
    assert_eq!(pair.statuses(id), [Status::Setter(SetterStatus::Success)]);
    pair.request(&Request::SetEEToK(ne_t_ee));
    pair.request(&Request::SetLoad(load));
    pair.tick(None);
    assert_eq!(pair.state.F_T_EE[14], f64::from(0.1_f32));
    assert_eq!(pair.state.EE_T_K[14], f64::from(0.1_f32));
    assert_eq!(pair.state.m_load, 0.5);
    assert!((pair.state.O_T_EE[14] - (z - 0.1)).abs() < 1e-6);
    assert!((pair.state.O_T_EE_c[14] - (z - 0.1)).abs() < 1e-6);
}

#[test]
fn a_stop_preempts_the_motion_and_is_answered_at_rest() {
    let mut pair = Pair::fr3();
    let motion = pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    for cycle in 0..200 {
        let mut command = RobotCommand::default();
        command.dq_c[0] = 0.5 * ramp(f64::from(cycle) * 1e-3, 0.2);
        pair.tick(Some(command));
    }
    let stop = pair.request(&Request::StopMove);
    assert_eq!(pair.outcome(motion), MoveStatus::Preempted);
    assert_eq!(pair.statuses(stop), []);
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert_eq!(pair.state.motion_generator_mode, MotionGeneratorMode::Idle);
    let mut last = pair.state;
    while pair.statuses(stop).is_empty() {
        pair.tick(None);
        assert!((pair.state.ddq_d[0]).abs() <= 10.0);
        assert!((pair.state.q_d[0] - last.q_d[0]) < 0.6e-3);
        last = pair.state;
    }
    assert_eq!(pair.statuses(stop), [Status::StopMove(StopStatus::Success)]);
    assert_eq!(pair.state.dq_d, [0.0; 7]);
    assert!(pair.state.errors.is_empty() && pair.state.reflex_reason.is_empty());
}

#[test]
fn a_stop_without_a_motion_succeeds() {
    let mut pair = Pair::fr3();
    let stop = pair.request(&Request::StopMove);
    pair.tick(None);
    assert_eq!(pair.statuses(stop), [Status::StopMove(StopStatus::Success)]);
}

#[test]
fn move_sent_after_a_stop_begins_with_the_arm_at_rest() {
    let mut pair = Pair::fr3();
    pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    for cycle in 0..200 {
        let mut command = RobotCommand::default();
        command.dq_c[0] = 0.5 * ramp(f64::from(cycle) * 1e-3, 0.2);
        pair.tick(Some(command));
    }
    pair.request(&Request::StopMove);
    let request = MoveRequest::new(
        MoveControllerMode::ExternalController,
        MoveGeneratorMode::None,
    );
    let second = pair.request(&Request::Move(request));
    assert_eq!(pair.statuses(second), []);
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert!(pair.state.dq_d[0] > 0.4);
    while pair.state.robot_mode != RobotMode::Move {
        pair.tick(None);
    }
    assert!(pair.state.dq_d[0].abs() < 0.01);
    let started = Status::Move(MoveStatus::MotionStarted);
    assert_eq!(pair.statuses(second), [started]);
}

/// The client sends each asynchronous target only once, so this target must not be lost.
#[test]
fn first_state_of_a_motion_after_braking_can_be_answered() {
    let mut pair = Pair::fr3();
    let request = MoveRequest {
        asynchronous: Some([1.0; 7]),
        ..MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )
    };
    let home = pair.q_d();
    pair.begin(request);
    pair.tick(Some(positions(&home.add_scalar(0.2))));
    pair.idle(200);
    // The client finishes in the middle of the motion. The next motion waits until the arm has
    // stopped.
    pair.tick(Some(RobotCommand {
        motion_generation_finished: true,
        ..RobotCommand::default()
    }));
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert!(pair.state.dq_d[0] > 0.1);
    let second = pair.request(&Request::Move(request));
    assert_eq!(pair.statuses(second), []);
    while pair.state.robot_mode != RobotMode::Move {
        pair.tick(None);
    }
    pair.tick(Some(positions(&home)));
    pair.idle(1000);
    assert!((pair.q_d() - home).amax() < 1e-6, "{}", pair.q_d() - home);
}

#[test]
fn a_reflex_lasts_until_the_recovery() {
    let mut pair = Pair::fr3();
    let id = pair.start_joints();
    let mut q_c = READY;
    q_c[0] += 0.2;
    pair.tick(Some(positions(&q_c)));
    pair.assert_reflex(
        id,
        &[RobotError::JointPositionMotionGeneratorStartPoseInvalid],
    );

    let request = MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointPosition,
    );
    let refused = pair.request(&Request::Move(request));
    let not_possible = Status::Move(MoveStatus::CommandNotPossibleRejected);
    assert_eq!(pair.statuses(refused), [not_possible]);

    let recovery = pair.request(&Request::AutomaticErrorRecovery);
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::AutomaticErrorRecovery);
    while pair.statuses(recovery).is_empty() {
        pair.tick(None);
    }
    assert_eq!(
        pair.statuses(recovery),
        [Status::Recovery(RecoveryStatus::Success)]
    );
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert!(pair.state.errors.is_empty());
    assert!(!pair.state.reflex_reason.is_empty(), "history stays");
    pair.start_joints();
    assert!(pair.state.reflex_reason.is_empty(), "until the next motion");
}

#[test]
fn a_recovery_without_an_error_succeeds_at_once() {
    let mut pair = Pair::fr3();
    let recovery = pair.request(&Request::AutomaticErrorRecovery);
    assert_eq!(
        pair.statuses(recovery),
        [Status::Recovery(RecoveryStatus::Success)]
    );
}

#[test]
fn a_client_that_leaves_in_motion_leaves_a_braking_arm_behind() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let mut tau = JointVector::zeros();
    for _ in 0..200 {
        tau[0] = (tau[0] + 0.05).min(2.0);
        pair.tick(Some(torques(&tau)));
    }
    assert!(pair.robot.dq()[0] > 0.1);
    pair.robot.disconnect();
    for _ in 0..500 {
        assert!(pair.robot.tick().is_none());
    }
    assert!(pair.robot.dq().amax() < 1e-3);
    assert!(pair.robot.connect());
    assert_eq!(pair.robot.state().robot_mode, RobotMode::Idle);
}

#[test]
fn impossible_moves_are_refused() {
    use MoveControllerMode::{ExternalController, JointImpedance};
    let invalid = [Status::Move(MoveStatus::InvalidArgumentRejected)];
    let good = MoveRequest::new(JointImpedance, MoveGeneratorMode::JointPosition);
    let mut narrow = good;
    narrow.maximum_path_deviation.rotation = f64::NAN;
    let mut negative = good;
    negative.maximum_goal_pose_deviation.translation = -1.0;
    let mut still = good;
    still.asynchronous = Some([0.0; 7]);
    let mut hasty = good;
    hasty.asynchronous = Some([3.0; 7]);
    let mut external = good;
    external.controller = ExternalController;
    external.asynchronous = Some([0.5; 7]);
    let nothing = MoveRequest::new(JointImpedance, MoveGeneratorMode::None);
    for request in [narrow, negative, still, hasty, external, nothing] {
        let mut pair = Pair::fr3();
        let id = pair.request(&Request::Move(request));
        assert_eq!(pair.statuses(id), invalid, "{request:?}");
    }
}

#[test]
fn the_same_seed_and_input_give_the_same_states() {
    let run = |seed| {
        let mut pair = Pair::new(Config {
            arm: Some(noisy()),
            seed,
            ..Config::default()
        });
        pair.start_torques();
        for _ in 0..200 {
            pair.tick(Some(RobotCommand::default()));
        }
        pair.state
    };
    assert_eq!(run(7), run(7));
    let (state, other) = (run(7), run(8));
    assert_ne!(state, other);
    for i in 0..7 {
        assert!((state.q[i] - other.q[i]).abs() < 1e-4);
        assert!(state.dq[i] != 0.0 && state.dq[i].abs() < 0.02);
        assert!((state.tau_J[i] - other.tau_J[i]).abs() < 1.0);
    }
}

#[test]
fn a_second_motion_takes_the_place_of_the_first() {
    let mut pair = Pair::fr3();
    let first = pair.start_torques();
    pair.tick(Some(RobotCommand::default()));
    let request = MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointPosition,
    );
    let second = pair.request(&Request::Move(request));
    assert_eq!(pair.outcome(first), MoveStatus::Preempted);
    pair.idle(20);
    assert_eq!(
        pair.statuses(second),
        [Status::Move(MoveStatus::MotionStarted)]
    );
    assert_eq!(
        pair.state.motion_generator_mode,
        MotionGeneratorMode::JointPosition
    );
}

#[test]
fn an_error_during_the_recovery_ends_it() {
    let mut pair = Pair::fr3();
    pair.robot.trip(RobotError::JointReflex);
    let recovery = pair.request(&Request::AutomaticErrorRecovery);
    pair.idle(10);
    pair.robot.trip(RobotError::InstabilityDetected);
    pair.tick(None);
    let aborted = Status::Recovery(RecoveryStatus::ReflexAborted);
    assert_eq!(pair.statuses(recovery), [aborted]);
    assert_eq!(pair.state.robot_mode, RobotMode::Reflex);
    assert_eq!(pair.state.errors.len(), 2);
}
