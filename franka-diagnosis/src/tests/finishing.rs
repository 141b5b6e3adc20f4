//! Last commands of an arm in motion, and of an arm whose commands have jumped.

use franka_model::Model;
use franka_proto::MotionGeneratorMode as Generator;
use franka_proto::RobotError as E;

use super::*;
use crate::{Advice, Axis, Cause, Quantity, Subject};

#[test]
fn an_arm_that_has_not_followed_to_the_end_is_named() {
    let causes = |measured: f64| {
        let mut story = Story::of(Model::fr3(), Generator::JointVelocity);
        story.go(|_, _| {}, |state| state.dq[6] = measured);
        let error = E::JointMotionGeneratorVelocityDiscontinuity;
        let finish = |_: &RobotState, command: &mut RobotCommand| {
            command.motion_generation_finished = true;
        };
        let diagnosis = story.stop(&[error], finish, |_| {});
        assert_eq!(diagnosis.finding, None);
        (diagnosis.causes, diagnosis.advice)
    };
    let (following, advice) = causes(0.117);
    let [
        Cause::FinishedMoving {
            subject, velocity, ..
        },
    ] = following[..]
    else {
        panic!("{following:?}")
    };
    assert_eq!((subject, velocity), (Subject::Joint(7), 0.117));
    assert_eq!(advice, [Advice::FinishAtRest]);
    assert_eq!(causes(0.01).0, []);
}

/// Returns the diagnosis of a motion of joint 7 with this velocity, and then a last command.
fn finished(velocity: f64, last: impl Fn(&RobotState, &mut RobotCommand)) -> Diagnosis {
    let mut story = Story::of(Model::fr3(), Generator::JointPosition);
    story.go(|_, _| {}, |state| state.dq_d[6] = velocity);
    story.stop(
        &[E::JointMotionGeneratorVelocityDiscontinuity],
        |before, command| {
            last(before, command);
            command.torque_command_finished = true;
        },
        |_| {},
    )
}

#[test]
fn a_wrong_start_that_is_finished_at_once_is_a_wrong_start() {
    for error in [
        E::JointPositionMotionGeneratorStartPoseInvalid,
        E::JointMotionGeneratorAccelerationDiscontinuity,
    ] {
        let story = Story::unbegun(Model::fr3(), Generator::JointPosition);
        let off = |_: &RobotState, command: &mut RobotCommand| {
            command.q_c[0] += 0.2;
            command.motion_generation_finished = true;
        };
        let diagnosis = story.stop(&[error], off, |_| {});
        assert!(
            matches!(diagnosis.causes[..], [Cause::WrongStart { offset, .. }] if (offset - 0.2).abs() < 1e-9),
            "{diagnosis}"
        );
        assert_eq!(diagnosis.advice, [Advice::StartWhereItIs]);
    }
}

#[test]
fn a_last_command_that_stands_still_has_leapt_to_it() {
    // Another function has finished the motion, so the positions stop too.
    let diagnosis = finished(0.314, |_, command| command.q_c[6] += 2.8e-8);
    assert!(
        matches!(
            diagnosis.causes[..],
            [Cause::TargetStep { subject: Subject::Joint(7), quantity: Quantity::Position, size, .. }]
                if (size + 0.000_314).abs() < 1e-7
        ),
        "{diagnosis}"
    );
    assert_eq!(diagnosis.advice, [Advice::Smooth]);
}

#[test]
fn a_leap_with_the_last_command_is_a_leap() {
    let diagnosis = finished(0.01, |before, command| {
        command.q_c[6] = before.q_d[6] + 0.001
    });
    assert!(
        matches!(
            diagnosis.causes[..],
            [Cause::TargetStep { quantity: Quantity::Position, size, .. }] if (size - 0.00099).abs() < 1e-9
        ),
        "{diagnosis}"
    );
    // Nearly unchanged continuation is not a jump: the last command was still moving.
    let diagnosis = finished(0.3, |before, command| {
        command.q_c[6] = before.q_d[6] + 0.00025
    });
    assert!(
        matches!(
            diagnosis.causes[..],
            [Cause::FinishedMoving { subject: Subject::Joint(7), velocity, .. }] if (velocity - 0.25).abs() < 1e-9
        ),
        "{diagnosis}"
    );
}

#[test]
fn motion_finished_while_braking_ends_in_acceleration_step() {
    let mut story = Story::of(Model::fr3(), Generator::JointVelocity);
    story.go(
        |_, _| {},
        |state| (state.dq_d[6], state.ddq_d[6]) = (0.0095, -9.0),
    );
    let error = E::JointMotionGeneratorAccelerationDiscontinuity;
    let last = |_: &RobotState, command: &mut RobotCommand| {
        command.dq_c[6] = 0.0005;
        command.motion_generation_finished = true;
    };
    let diagnosis = story.stop(&[error], last, |_| {});
    assert!(
        matches!(
            diagnosis.causes[..],
            [Cause::TargetStep { subject: Subject::Joint(7), quantity: Quantity::Acceleration, size, .. }]
                if (size - 8.5).abs() < 1e-6
        ),
        "{diagnosis}"
    );
}

#[test]
fn a_pose_that_is_finished_at_speed_is_named_by_its_axis() {
    let mut story = Story::of(Model::fr3(), Generator::CartesianVelocity);
    story.go(|_, _| {}, |state| state.O_dP_EE_c[2] = 0.1);
    let error = E::CartesianMotionGeneratorAccelerationDiscontinuity;
    let last = |_: &RobotState, command: &mut RobotCommand| {
        command.O_dP_EE_c[2] = 0.1;
        command.motion_generation_finished = true;
    };
    let diagnosis = story.stop(&[error], last, |_| {});
    assert!(
        matches!(
            diagnosis.causes[..],
            [Cause::FinishedMoving { subject: Subject::Translation(Axis::Z), velocity, .. }]
                if (velocity - 0.1).abs() < 1e-9
        ),
        "{diagnosis}"
    );
    assert_eq!(diagnosis.advice, [Advice::FinishAtRest]);
}
