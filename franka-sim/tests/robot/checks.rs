//! Commands that a robot refuses, and the errors that it reports.

use franka_model::READY;
use franka_proto::RobotError as E;

use crate::pair::*;

fn joint_velocity() -> (Pair, CommandId) {
    let mut pair = Pair::fr3();
    let id = pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    (pair, id)
}

fn cartesian(generator: MoveGeneratorMode) -> (Pair, CommandId) {
    let mut pair = Pair::fr3();
    let id = pair.start(MoveControllerMode::JointImpedance, generator);
    (pair, id)
}

#[test]
fn a_small_kink_breaks_the_jerk_only() {
    let mut pair = Pair::fr3();
    let id = pair.start_joints();
    pair.tick(Some(positions(&READY)));
    let mut q_c = READY;
    q_c[0] += 6e-6; // 6 rad/s² within one cycle
    pair.tick(Some(positions(&q_c)));
    pair.assert_reflex(id, &[E::JointMotionGeneratorAccelerationDiscontinuity]);
}

#[test]
fn commands_at_the_nominal_bounds_pass_on_both_histories() {
    for published in [false, true] {
        let (mut pair, _) = joint_velocity();
        let (mut v, mut a) = (0.0, 0.0);
        for cycle in 0..150 {
            if published {
                (v, a) = (pair.state.dq_d[0], pair.state.ddq_d[0]);
            }
            // These are the limits of a client's limiter: nominal values minus its margin.
            a = (a + 4999.999e-3_f64).min(9.999);
            v += a * 1e-3;
            let mut command = RobotCommand::default();
            command.dq_c[0] = v;
            pair.tick(Some(command));
            assert_eq!(
                pair.state.robot_mode,
                RobotMode::Move,
                "{published} {cycle}"
            );
        }
    }
}

#[test]
fn joint_velocities_have_their_own_names() {
    let (mut pair, id) = joint_velocity();
    let mut command = RobotCommand::default();
    command.dq_c[0] = 0.011;
    pair.tick(Some(command));
    pair.assert_reflex(id, &[E::JointMotionGeneratorAccelerationDiscontinuity]);
}

#[test]
fn the_velocity_envelope_closes_towards_the_limit() {
    let mut q = READY;
    q[0] = 2.5;
    let mut pair = Pair::new(Config {
        q,
        ..Config::default()
    });
    let id = pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    let mut command = RobotCommand::default();
    while pair.state.robot_mode == RobotMode::Move {
        command.dq_c[0] += 0.005;
        pair.tick(Some(command));
    }
    // The velocity envelope at this position is sqrt(2 · 6 · 0.25) - 0.3 or less.
    assert!(command.dq_c[0] > 1.0 && command.dq_c[0] < 1.44);
    pair.assert_reflex(id, &[E::JointMotionGeneratorVelocityLimitsViolation]);
}

#[test]
fn a_pose_far_from_the_start_is_refused_by_one_name() {
    let (mut pair, id) = cartesian(MoveGeneratorMode::CartesianPosition);
    let mut command = RobotCommand {
        O_T_EE_c: pair.state.O_T_EE_c,
        ..RobotCommand::default()
    };
    command.O_T_EE_c[14] += 10.0;
    pair.tick(Some(command));
    pair.assert_reflex(id, &[E::CartesianPositionMotionGeneratorStartPoseInvalid]);
}

#[test]
fn a_jump_in_the_pose_breaks_cartesian_and_joint_bounds() {
    let (mut pair, id) = cartesian(MoveGeneratorMode::CartesianPosition);
    let mut command = RobotCommand {
        O_T_EE_c: pair.state.O_T_EE_c,
        ..RobotCommand::default()
    };
    pair.tick(Some(command));
    command.O_T_EE_c[12] += 0.01;
    pair.tick(Some(command));
    pair.assert_reflex(
        id,
        &[
            E::CartesianMotionGeneratorVelocityLimitsViolation,
            E::CartesianMotionGeneratorVelocityDiscontinuity,
            E::CartesianMotionGeneratorAccelerationDiscontinuity,
            E::CartesianMotionGeneratorJointVelocityLimitsViolation,
            E::CartesianMotionGeneratorJointVelocityDiscontinuity,
            E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
        ],
    );
}

#[test]
fn a_cartesian_ramp_may_be_too_fast_for_the_joints_alone() {
    let (mut pair, id) = cartesian(MoveGeneratorMode::CartesianVelocity);
    let mut command = RobotCommand::default();
    while pair.state.robot_mode == RobotMode::Move {
        // Cartesian limits permit this acceleration, but joint 2 must turn by 3.2 rad per metre.
        command.O_dP_EE_c[0] += 3.2e-3;
        pair.tick(Some(command));
    }
    assert_eq!(pair.outcome(id), MoveStatus::ReflexAborted);
    assert!(
        pair.state
            .errors
            .iter()
            .all(|e| (27..=30).contains(&e.index()) || e == E::JointVelocityViolation),
        "{}",
        pair.state.errors
    );
}

#[test]
fn mirrored_pose_and_nan_torque_are_refused() {
    let (mut pair, id) = cartesian(MoveGeneratorMode::CartesianPosition);
    let mut mirrored = pair.state.O_T_EE_c;
    mirrored[0] = -mirrored[0];
    pair.tick(Some(RobotCommand {
        O_T_EE_c: mirrored,
        ..RobotCommand::default()
    }));
    pair.assert_reflex(id, &[E::CartesianPositionMotionGeneratorInvalidFrameFlag]);

    let mut pair = Pair::fr3();
    let id = pair.start_torques();
    pair.tick(Some(torques(&JointVector::repeat(f64::NAN))));
    assert_eq!(pair.outcome(id), MoveStatus::InputErrorAborted);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert!(pair.robot.q().iter().all(|q| q.is_finite()));
}

#[test]
fn the_elbow_is_checked_at_the_start_and_on_the_way() {
    let start = |elbow_c| {
        let (mut pair, id) = cartesian(MoveGeneratorMode::CartesianPosition);
        pair.tick(Some(RobotCommand {
            O_T_EE_c: pair.state.O_T_EE_c,
            elbow_c: Some(elbow_c),
            ..RobotCommand::default()
        }));
        (pair, id)
    };
    for elbow_c in [[0.5, -1.0], [0.0, 1.0]] {
        let (pair, id) = start(elbow_c);
        pair.assert_reflex(id, &[E::CartesianMotionGeneratorStartElbowInvalid]);
    }
    let (mut pair, id) = start([0.0, -1.0]);
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    pair.tick(Some(RobotCommand {
        O_T_EE_c: pair.state.O_T_EE_c,
        elbow_c: Some([0.0, 1.0]),
        ..RobotCommand::default()
    }));
    pair.assert_reflex(id, &[E::CartesianMotionGeneratorElbowSignInconsistent]);

    let (mut pair, _) = start([0.0, -1.0]);
    pair.tick(Some(RobotCommand {
        O_T_EE_c: pair.state.O_T_EE_c,
        elbow_c: Some([1e-4, -1.0]),
        ..RobotCommand::default()
    }));
    assert!(
        pair.state
            .errors
            .contains(E::CartesianMotionGeneratorElbowLimitViolation)
    );
}

#[test]
fn finishing_at_speed_is_a_discontinuity() {
    let (mut pair, id) = joint_velocity();
    let mut command = RobotCommand::default();
    for cycle in 0..100 {
        command.dq_c[0] = 0.2 * ramp(f64::from(cycle) * 1e-3, 0.1);
        pair.tick(Some(command));
    }
    command.motion_generation_finished = true;
    pair.tick(Some(command));
    pair.assert_reflex(id, &[E::JointMotionGeneratorAccelerationDiscontinuity]);
}

#[test]
fn lost_commands_are_extrapolated_and_twenty_end_the_motion() {
    let mut pair = Pair::fr3();
    let id = pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    // No command counts as lost before the first command.
    pair.idle(50);
    let mut command = RobotCommand::default();
    for cycle in 1..=50 {
        command.dq_c[0] = 2e-3 * f64::from(cycle);
        pair.tick(Some(command));
    }
    let before = pair.state;
    pair.tick(None);
    let advanced = pair.state.dq_d[0] - before.dq_d[0];
    assert!((advanced - before.ddq_d[0] * 1e-3).abs() < 1e-7);
    assert!((pair.state.control_command_success_rate - 50.0 / 51.0).abs() < 1e-6);
    for _ in 0..18 {
        pair.tick(None);
    }
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    pair.tick(None);
    pair.assert_reflex(id, &[E::CommunicationConstraintsViolation]);
}

#[test]
fn command_sent_first_counts_for_its_cycle() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let message_id = pair.state.message_id;
    for value in [0.1, 0.5] {
        pair.datagram(&RobotCommand {
            message_id,
            ..torques(&JointVector::repeat(value))
        });
    }
    pair.tick(None);
    assert_eq!(pair.state.tau_J_d[0], f64::from(0.1_f32));
}

#[test]
fn a_leftover_finish_of_the_last_motion_does_not_end_the_next() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let finish = RobotCommand {
        torque_command_finished: true,
        ..RobotCommand::default()
    };
    pair.tick(Some(finish));
    let stale = RobotCommand {
        message_id: pair.state.message_id,
        ..finish
    };
    let request = MoveRequest::new(
        MoveControllerMode::ExternalController,
        MoveGeneratorMode::None,
    );
    // The arm stops within the cycle, so the motion begins before the datagram arrives.
    pair.tick(None);
    let id = pair.request(&Request::Move(request));
    pair.datagram(&RobotCommand {
        message_id: pair.state.message_id,
        ..stale
    });
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    assert_eq!(pair.statuses(id).len(), 1);
}

#[test]
fn a_fast_tip_of_a_long_tool_is_a_cartesian_violation() {
    let mut pair = Pair::fr3();
    let mut ne_t_ee = pair.state.NE_T_EE;
    ne_t_ee[12] = 1.5;
    pair.request(&Request::SetNEToEE(ne_t_ee));
    let id = pair.start_torques();
    let mut tau = JointVector::zeros();
    while pair.state.robot_mode == RobotMode::Move {
        tau[6] = (tau[6] + 0.01).min(2.0);
        pair.tick(Some(torques(&tau)));
    }
    pair.assert_reflex(id, &[E::CartesianVelocityViolation]);
}

#[test]
fn more_torque_than_a_sensor_reads_is_noticed() {
    let mut pair = Pair::fr3();
    let high = franka_proto::CollisionBehavior::uniform([1e3; 7], [1e3; 7], [1e4; 6], [1e4; 6]);
    pair.request(&Request::SetCollisionBehavior(high));
    let id = pair.start_joints();
    let mut shove = JointVector::zeros();
    shove[4] = 60.0;
    pair.robot.push_joints(shove, 100);
    while pair.state.robot_mode == RobotMode::Move {
        pair.tick(Some(positions(&READY)));
    }
    assert!(pair.state.errors.contains(E::TauJRangeViolation));
    assert_eq!(pair.outcome(id), MoveStatus::ReflexAborted);
}

#[test]
fn losses_right_after_the_first_command_leave_no_trace() {
    // Single precision rounds these positions.
    let q = READY + JointVector::repeat(0.123_456_789);
    for generator in [
        MoveGeneratorMode::JointPosition,
        MoveGeneratorMode::CartesianPosition,
    ] {
        let mut pair = Pair::new(Config {
            q,
            ..Config::default()
        });
        let command = RobotCommand {
            q_c: pair.state.q_d,
            O_T_EE_c: pair.state.O_T_EE_c,
            ..RobotCommand::default()
        };
        pair.start(MoveControllerMode::JointImpedance, generator);
        pair.tick(Some(command));
        pair.idle(19);
        assert!(JointVector::from(pair.state.dq_d).amax() < 1e-6);
        pair.tick(Some(command));
        assert_eq!(
            pair.state.robot_mode,
            RobotMode::Move,
            "{}",
            pair.state.errors
        );
        assert!((pair.q_d() - q).amax() < 1e-6);
    }
}
