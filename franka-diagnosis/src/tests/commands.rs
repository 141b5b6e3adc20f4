use franka_model::geometry::Lengths;
use franka_model::{EndEffector, Frame, JointVector, Model, READY, elbow, layout};
use franka_proto::MotionGeneratorMode as Generator;
use franka_proto::RobotError as E;

use super::*;
use crate::commanded::{Which, resulting_readings};
use crate::{Advice, Axis, Bound, Cause, Origin, Quantity, Subject};

#[test]
fn differences_after_lost_cycles_count_from_robot_values() {
    let mut story = Story::of(Model::fr3(), Generator::JointPosition);
    // Five states are lost; the robot has continued meanwhile, and its state shows it.
    story.go(
        |_, _| {},
        |state| {
            state.message_id += 5;
            state.q_d[1] += 0.01;
            state.dq_d[1] = 0.5;
            state.control_command_success_rate = 0.95;
        },
    );
    // An unchanged continuation from `q_d` is not a step, regardless of its distance from the last
    // command.
    story.go(
        |before, command| command.q_c[1] = before.q_d[1] + 0.0005,
        |_| {},
    );
    let diagnosis = story.stop(
        &[E::JointMotionGeneratorVelocityDiscontinuity],
        |before, command| command.q_c[1] = before.q_d[1] - 0.0005,
        |_| {},
    );
    let finding = finding(&diagnosis);
    assert_eq!(
        (finding.subject, finding.quantity),
        (Subject::Joint(2), Quantity::Acceleration)
    );
    assert_eq!(finding.bound, Bound::AtLeast(-10.0));
    assert!((finding.value + 1000.0).abs() < 1e-3, "{finding:?}");
    assert_eq!(finding.since, diagnosis.end.unwrap() - 1);
    let [lost, step] = diagnosis.causes[..] else {
        panic!("{:?}", diagnosis.causes)
    };
    let Cause::LostPackets {
        states: 5,
        commands: 0,
        longest_run: 5,
        first,
        last,
        ..
    } = lost
    else {
        panic!("{lost:?}")
    };
    assert_eq!((first, last), (BEGIN + 2, BEGIN + 6));
    let Cause::TargetStep {
        subject,
        quantity,
        size,
        ..
    } = step
    else {
        panic!("{step:?}")
    };
    assert_eq!((subject, quantity), (Subject::Joint(2), Quantity::Position));
    assert!((size + 0.001).abs() < 1e-9, "{size}");
    assert_eq!(diagnosis.advice, [Advice::Network, Advice::Smooth]);
}

/// The motion is a quintic from rest to rest, always within the jerk limit.
#[test]
fn a_smooth_motion_that_is_too_fast_is_no_step() {
    for (model, duration) in [
        (Model::fr3(), 0.3),
        (Model::fr3(), 0.5),
        (Model::fer(), 0.4),
    ] {
        let mut story = Story::of(model, Generator::JointPosition);
        let limit = model.joint_limits().acceleration[0];
        let at = |step: u32| {
            let s = f64::from(step) * 1e-3 / duration;
            READY[0] + 0.5 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
        };
        let acceleration = |step: u32| (at(step + 1) - 2.0 * at(step) + at(step - 1)) * 1e6;
        let mut step = 1;
        while acceleration(step) <= limit {
            story.go(|_, command| command.q_c[0] = at(step), |_| {});
            step += 1;
        }
        story.go(|_, command| command.q_c[0] = at(step), |_| {});
        let diagnosis = story.stop(
            &[E::JointMotionGeneratorVelocityDiscontinuity],
            |_, command| command.q_c[0] = at(step + 1),
            |_| {},
        );
        let finding = finding(&diagnosis);
        assert_eq!(finding.quantity, Quantity::Acceleration);
        assert_eq!(diagnosis.causes, []);
        assert_eq!(diagnosis.advice, [Advice::SlowDown]);
    }
}

#[test]
fn torques_of_a_first_command_are_compared_with_none() {
    let mut story = Story::unbegun(Model::fer(), Generator::JointVelocity);
    // The state of a stopped robot does not matter.
    story.entries[0].state.tau_J_d[2] = 4.0;
    let diagnosis = story.stop(
        &[E::ControllerTorqueDiscontinuity],
        |_, command| command.tau_J_d[2] = 5.0,
        |_| {},
    );
    assert_eq!(finding(&diagnosis).value, 5000.0);
    assert!(matches!(
        diagnosis.causes[..],
        [Cause::WrongStart {
            subject: Subject::Joint(3),
            quantity: Quantity::Torque,
            offset: 5.0,
            cycle: BEGIN
        }]
    ));
    assert_eq!(diagnosis.advice, [Advice::StartWhereItIs]);
}

#[test]
fn a_first_position_that_is_measured_is_no_start() {
    let story = Story::unbegun(Model::fr3(), Generator::JointPosition);
    let diagnosis = story.stop(
        &[E::JointMotionGeneratorAccelerationDiscontinuity],
        |_, command| command.q_c[1] -= 7e-5,
        |_| {},
    );
    let [
        Cause::WrongStart {
            subject,
            quantity,
            offset,
            ..
        },
    ] = diagnosis.causes[..]
    else {
        panic!("{:?}", diagnosis.causes)
    };
    assert_eq!((subject, quantity), (Subject::Joint(2), Quantity::Position));
    assert!((offset + 7e-5).abs() < 1e-9, "{offset}");
    assert_eq!(diagnosis.advice, [Advice::StartWhereItIs]);
}

#[test]
fn excessive_jerk_precedes_a_nearly_excessive_acceleration() {
    let mut story = Story::of(Model::fr3(), Generator::JointVelocity);
    story.entries.last_mut().unwrap().state.ddq_d[0] = -9.0;
    let diagnosis = story.stop(
        &[E::JointMotionGeneratorAccelerationDiscontinuity],
        |_, command| command.dq_c[0] = 0.0098,
        |_| {},
    );
    let finding = finding(&diagnosis);
    assert_eq!(finding.quantity, Quantity::Jerk);
    assert!((finding.value - 18_800.0).abs() < 1e-6);
}

#[test]
fn velocity_beyond_envelope_is_blamed_on_the_limit_ahead() {
    let mut story = Story::of(Model::fr3(), Generator::JointVelocity);
    // 0.1 rad before the end of joint 4's range.
    story.entries.last_mut().unwrap().state.q_d[3] = -0.2458;
    story.entries.last_mut().unwrap().state.dq_d[3] = 1.0;
    let diagnosis = story.stop(
        &[E::JointMotionGeneratorVelocityLimitsViolation],
        |_, command| command.dq_c[3] = 1.0,
        |_| {},
    );
    let finding = finding(&diagnosis);
    // sqrt(2 4.0 0.1) - 0.3
    let envelope = 0.8_f64.sqrt() - 0.3;
    assert!(matches!(finding.bound, Bound::AtMost(limit) if (limit - envelope).abs() < 1e-9));
    let [
        Cause::Limit {
            joint: 4,
            upper: true,
            distance,
            speed,
            ..
        },
    ] = diagnosis.causes[..]
    else {
        panic!("{:?}", diagnosis.causes)
    };
    assert!((distance - 0.1).abs() < 1e-9 && (speed - envelope).abs() < 1e-9);
    assert_eq!(diagnosis.advice[0], Advice::StayInRange);
}

#[test]
fn commanded_position_violation_precedes_measured_one() {
    for error in [
        E::JointMotionGeneratorPositionLimitsViolation,
        E::JointPositionLimitsViolation,
    ] {
        let mut story = Story::of(Model::fer(), Generator::JointPosition);
        story.entries.last_mut().unwrap().state.q_d[5] = 3.75;
        story.entries.last_mut().unwrap().state.dq_d[5] = 5.0;
        let diagnosis = story.stop(&[error], |_, command| command.q_c[5] = 3.755, |_| {});
        let finding = finding(&diagnosis);
        let expected = (Subject::Joint(6), Quantity::Position, Origin::Commanded);
        assert_eq!(
            (finding.subject, finding.quantity, finding.origin),
            expected
        );
        assert_eq!(finding.bound, Bound::AtMost(3.7525));
        assert!((finding.excess().unwrap() - 0.0025).abs() < 1e-12);
        assert!(diagnosis.advice.contains(&Advice::StayInRange));
    }
}

#[test]
fn the_zeros_that_finish_an_asynchronous_motion_are_no_target() {
    let story = Story::of(Model::fr3(), Generator::JointPosition);
    let diagnosis = story.stop(
        &[E::JointPositionLimitsViolation],
        |_, command| {
            command.q_c = [0.0; 7];
            command.motion_generation_finished = true;
        },
        |state| state.q[3] = 0.1,
    );
    assert_eq!(finding(&diagnosis).origin, Origin::Measured);
}

#[test]
fn a_rotation_that_leaps_is_named_by_its_axis() {
    let story = Story::of(Model::fr3(), Generator::CartesianVelocity);
    let diagnosis = story.stop(
        &[
            E::CartesianMotionGeneratorAccelerationDiscontinuity,
            E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
        ],
        |_, command| command.O_dP_EE_c[4] = 0.3,
        |_| {},
    );
    let finding = finding(&diagnosis);
    assert_eq!(finding.subject, Subject::Rotation(Axis::Y));
    assert_eq!(finding.bound, Bound::AtMost(17.0));
    assert!((finding.value - 300.0).abs() < 1e-9);
    assert!(matches!(
        diagnosis.causes[..],
        [Cause::TargetStep { subject: Subject::Rotation(Axis::Y), quantity: Quantity::Velocity, size, .. }]
            if (size - 0.3).abs() < 1e-9
    ));
    let text = diagnosis.to_string();
    let with = "other errors: cartesian_motion_generator_joint_acceleration_discontinuity";
    assert!(text.lines().any(|line| line == with), "{text}");
}

#[test]
fn the_elbow_has_limits_of_its_own() {
    let story = Story::of(Model::fr3(), Generator::CartesianPosition);
    let diagnosis = story.stop(
        &[E::CartesianMotionGeneratorElbowLimitViolation],
        |before, command| command.elbow_c = Some([before.elbow_c[0] + 0.002, -1.0]),
        |_| {},
    );
    let finding = finding(&diagnosis);
    // Velocity, acceleration and jerk all exceed their limits, the jerk by the largest factor.
    assert_eq!(
        (finding.subject, finding.quantity),
        (Subject::Elbow, Quantity::Jerk)
    );
    assert!(matches!(
        diagnosis.causes[..],
        [Cause::TargetStep { subject: Subject::Elbow, quantity: Quantity::Position, size, .. }]
            if (size - 0.002).abs() < 1e-9
    ));
}

#[test]
fn singular_pose_is_diagnosed_by_inverse_kinematics() {
    let mut story = Story::of(Model::fr3(), Generator::CartesianVelocity);
    let mut q = READY;
    q[1] = 0.2;
    q[3] = elbow::FLIP_ANGLE - 0.08;
    let pose = Model::fr3().pose(Frame::EndEffector, &q, &EndEffector::default());
    let state = &mut story.entries.last_mut().unwrap().state;
    (state.q, state.q_d, state.O_T_EE_c) = (q.into(), q.into(), layout::pose(&pose));
    // The joints of a motion at 0.3 m/s towards the wrist's singularity, some time ago.
    let out = JointVector::from(q) - READY;
    assert!(out.norm() > 0.5);
    state.O_dP_EE_c[0] = 0.3;
    let diagnosis = story.stop(
        &[E::CartesianMotionGeneratorJointAccelerationDiscontinuity],
        |_, command| command.O_dP_EE_c[0] = 0.3,
        |_| {},
    );
    let finding = finding(&diagnosis);
    assert_eq!(finding.origin, Origin::Desired);
    assert!(matches!(finding.subject, Subject::Joint(_)));
    let [
        Cause::Singularity {
            smallest, stretch, ..
        },
    ] = diagnosis.causes[..]
    else {
        panic!("{:?}", diagnosis.causes)
    };
    assert!(smallest < 0.1 && (stretch + 0.08).abs() < 1e-9);
    assert_eq!(diagnosis.advice[0], Advice::AvoidSingularity);
}

#[test]
fn a_start_pose_is_off_by_position_or_by_rotation() {
    for (index, subject) in [
        (13, Subject::Translation(Axis::Y)),
        (14, Subject::Translation(Axis::Z)),
    ] {
        let story = Story::unbegun(Model::fer(), Generator::CartesianPosition);
        let diagnosis = story.stop(
            &[E::CartesianPositionMotionGeneratorStartPoseInvalid],
            |_, command| command.O_T_EE_c[index] += 0.1,
            |_| {},
        );
        let finding = finding(&diagnosis);
        assert_eq!(
            (finding.subject, finding.quantity),
            (subject, Quantity::StartOffset)
        );
        assert!((finding.value - 0.1).abs() < 1e-9);
        assert_eq!(diagnosis.advice, [Advice::StartWhereItIs]);
    }
}

/// A robot has other lengths in its poses, and continues its motion. No joint limit is exceeded,
/// with the commanded fields filled in or zero.
#[test]
fn joints_of_a_pose_are_found_from_where_the_robot_reports_it() {
    let arm = Model::fr3().clone().with_lengths(Lengths::RECORDED_FR3);
    let pose = arm.pose(Frame::EndEffector, &READY, &EndEffector::default());
    for is_filled in [true, false] {
        for generator in [Generator::CartesianPosition, Generator::CartesianVelocity] {
            let mut story = Story::of(Model::fr3(), generator);
            let state = &mut story.entries.last_mut().unwrap().state;
            (state.O_T_EE, state.O_T_EE_d) = (layout::pose(&pose), layout::pose(&pose));
            state.elbow_d = state.elbow_c;
            (state.O_T_EE_c, state.elbow_c) = match is_filled {
                true => (state.O_T_EE_d, state.elbow_d),
                false => ([0.0; 16], [0.0; 2]),
            };
            let holding = layout::pose(&pose);
            story.go(|_, command| command.O_T_EE_c = holding, |_| {});
            let entries: Vec<_> = story.entries[1..].iter().collect();
            let evidence = Evidence {
                commander: story.commander,
                entries,
                model: story.model,
                statistics: None,
                rounded: false,
            };
            let readings = resulting_readings(&evidence, Which::Acceleration);
            assert!(!readings.is_empty(), "{generator:?}");
            for reading in readings {
                assert!(reading.score < 0.1, "{generator:?}: {reading:?}");
            }
        }
    }
}
