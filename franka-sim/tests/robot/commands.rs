use franka_model::{JointVector, READY, elbow};
use franka_proto::{
    MoveControllerMode, MoveGeneratorMode, MoveRequest, MoveStatus, Request, RobotCommand,
    RobotError as E, RobotMode, Status,
};
use franka_sim::{Config, Touch};

use crate::pair::{Pair, finished, positions, ramp};

#[test]
fn limits_and_communication_are_enforced_unless_switched_off() {
    let outcome = |config: Config, jump: bool| {
        let mut pair = Pair::new(config);
        pair.start_joints();
        pair.tick(Some(positions(&READY)));
        if jump {
            let mut q = READY;
            q[0] += 0.05;
            pair.tick(Some(positions(&q)));
        }
        pair.idle(500);
        (pair.state.errors, pair.q()[0])
    };
    let strict = Config::default();
    assert!(!outcome(strict.clone(), true).0.is_empty());
    let (errors, _) = outcome(strict.clone(), false);
    assert!(errors.contains(E::CommunicationConstraintsViolation));
    let permissive = Config {
        enforce_limits: false,
        enforce_communication: false,
        ..strict
    };
    let (errors, q) = outcome(permissive, true);
    assert!(errors.is_empty(), "{errors}");
    assert!((q - 0.05).abs() < 1e-3, "{q}");
}

#[test]
fn one_abort_carries_every_error_of_its_cycle() {
    let mut pair = Pair::fr3();
    let id = pair.start_joints();
    pair.tick(Some(positions(&READY)));
    let mut q = READY;
    q[1] += 0.05;
    pair.tick(Some(positions(&q)));
    pair.assert_reflex(
        id,
        &[
            E::JointMotionGeneratorVelocityLimitsViolation,
            E::JointMotionGeneratorVelocityDiscontinuity,
            E::JointMotionGeneratorAccelerationDiscontinuity,
        ],
    );
    assert_eq!(pair.state.reflex_reason, pair.state.errors);
    // The command had no effect.
    let moved = JointVector::from(pair.state.q_d) - READY;
    assert!(moved.amax() < 1e-6, "{moved}");
}

#[test]
fn joint_position_error_is_named_by_robot_generation() {
    for (mut pair, expected, other) in [
        (
            Pair::fr3(),
            E::JointPositionLimitsViolation,
            E::JointMotionGeneratorPositionLimitsViolation,
        ),
        (
            Pair::fer(),
            E::JointMotionGeneratorPositionLimitsViolation,
            E::JointPositionLimitsViolation,
        ),
    ] {
        let limits = *pair.robot.model().joint_limits();
        let mut q = READY;
        q[0] = limits.hard_upper[0] - 1e-5;
        pair.robot.place(&q);
        pair.tick(None);
        // The position in the state may be rounded.
        q = JointVector::from(pair.state.q_d);
        pair.start_joints();
        pair.tick(Some(positions(&q)));
        q[0] += 2e-5;
        pair.tick(Some(positions(&q)));
        assert!(
            pair.state.errors.contains(expected),
            "{}",
            pair.state.errors
        );
        assert!(!pair.state.errors.contains(other), "{}", pair.state.errors);
    }
}

#[test]
fn the_path_and_goal_deviations_of_a_move_are_kept() {
    let pushed = |path: f64, goal: f64| {
        let mut pair = Pair::fr3();
        pair.request(&Request::SetJointImpedance([200.0; 7]));
        let mut request = MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        );
        request.maximum_path_deviation.translation = path;
        request.maximum_goal_pose_deviation.translation = goal;
        let id = pair.begin(request);
        let push = JointVector::from([10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        pair.robot.touch(Touch::torque(push));
        for _ in 0..500 {
            pair.tick(Some(positions(&READY)));
        }
        if pair.state.robot_mode == RobotMode::Move {
            pair.tick(Some(finished(positions(&READY))));
        }
        (pair.outcome(id), pair.state.errors)
    };
    assert_eq!(
        pushed(0.01, 10.0).1,
        E::MaxPathPoseDeviationViolation.into()
    );
    assert_eq!(
        pushed(10.0, 0.01).1,
        E::MaxGoalPoseDeviationViolation.into()
    );
    assert_eq!(pushed(10.0, 10.0).0, MoveStatus::Success);
}

#[test]
fn asynchronous_target_is_the_newest_of_its_millisecond() {
    let mut pair = Pair::fr3();
    pair.begin(MoveRequest {
        asynchronous: Some([0.3; 7]),
        ..MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )
    });
    let at = |offset: f64| {
        let mut q = READY;
        q[0] += offset;
        positions(&q)
    };
    for offset in [-0.1, 0.1] {
        pair.datagram(&RobotCommand {
            message_id: pair.state.message_id,
            ..at(offset)
        });
    }
    pair.idle(1000);
    assert!((pair.q()[0] - 0.1).abs() < 1e-3, "{}", pair.q());
    // Commands after the end belong to no motion.
    for command in [finished(at(0.1)), at(-0.1)] {
        pair.datagram(&RobotCommand {
            message_id: pair.state.message_id,
            ..command
        });
    }
    pair.idle(1);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
}

#[test]
fn an_asynchronous_motion_keeps_the_velocities_of_its_move() {
    let mut pair = Pair::fr3();
    let velocity = [0.3, 0.3, 0.3, 0.3, 0.6, 0.6, 0.6];
    let id = pair.begin(MoveRequest {
        asynchronous: Some(velocity),
        ..MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )
    });
    let target = READY.add_scalar(0.15);
    pair.tick(Some(positions(&target)));
    let mut fastest = 0.0_f64;
    for _ in 0..1500 {
        // No command arrives in any of these cycles.
        pair.tick(None);
        fastest = fastest.max(pair.state.dq_d[0]);
    }
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    assert!(fastest > 0.15 && fastest <= 0.3 + 1e-6, "{fastest}");
    assert!((JointVector::from(pair.state.q_d) - target).amax() < 1e-6);
    // The last command of libfranka contains seven zeros, and comes late.
    let mut end = finished(RobotCommand::default());
    end.message_id = pair.state.message_id - 3;
    pair.datagram(&end);
    pair.tick(None);
    assert_eq!(pair.outcome(id), MoveStatus::Success);
    assert!((pair.q() - target).amax() < 1e-3);
}

#[test]
fn the_command_of_a_finished_datagram_is_checked_and_applied() {
    let drive = |q_last: f64, at_rest: bool| {
        let mut pair = Pair::fr3();
        let id = pair.start_joints();
        let mut q = READY;
        for cycle in 0..600 {
            let t = f64::from(cycle) * 1e-3;
            q[0] = 0.1 * ramp(t, 0.5);
            if !at_rest && cycle == 250 {
                break;
            }
            pair.tick(Some(positions(&q)));
        }
        q[0] += q_last;
        pair.tick(Some(finished(positions(&q))));
        (pair, id, q)
    };
    let (pair, id, q) = drive(1e-6, true);
    assert_eq!(pair.outcome(id), MoveStatus::Success);
    let echoed = pair.state.q_d[0];
    assert!((echoed - q[0]).abs() < 1e-7, "applied: {echoed}");

    let (pair, id, _) = drive(0.0, false);
    assert_eq!(pair.outcome(id), MoveStatus::ReflexAborted);
    assert!(
        pair.state
            .errors
            .contains(E::JointMotionGeneratorVelocityDiscontinuity)
    );
    let (pair, id, _) = drive(0.05, true);
    assert_eq!(pair.outcome(id), MoveStatus::ReflexAborted, "checked");
}

#[test]
fn the_elbow_sign_is_that_of_the_flip_angle_and_not_of_joint_4() {
    for (q4, sign) in [(-0.40, 1.0), (-0.47, -1.0), (-2.0, -1.0)] {
        let mut q = READY;
        q[3] = q4;
        let pair = Pair::new(Config {
            q,
            ..Config::default()
        });
        assert_eq!(pair.state.elbow, [f64::from(q[2] as f32), sign], "{q4}");
        assert_eq!(pair.state.elbow, elbow::elbow(&pair.q()));
    }
}

#[test]
fn singular_start_is_rejected_after_the_acceptance() {
    let q = JointVector::from([0.0, 1.28, 0.0, -0.5415, 0.0, 2.74, 0.0]);
    let mut pair = Pair::new(Config {
        q,
        ..Config::default()
    });
    let request = |generator| {
        Request::Move(MoveRequest::new(
            MoveControllerMode::JointImpedance,
            generator,
        ))
    };
    for generator in [
        MoveGeneratorMode::CartesianPosition,
        MoveGeneratorMode::CartesianVelocity,
    ] {
        let id = pair.request(&request(generator));
        pair.tick(None);
        assert_eq!(pair.outcome(id), MoveStatus::StartAtSingularPoseRejected);
    }
    let status = pair.ask(&request(MoveGeneratorMode::JointPosition));
    assert_eq!(status, Status::Move(MoveStatus::MotionStarted));
}
