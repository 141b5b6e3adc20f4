//! Reflexes caused by steps in the commands.

use super::{QUIET, begin, diagnosis, found, limit, stepping, velocities};
use franka_diagnosis::{Advice, Axis, Cause, Origin, Quantity, Subject};
use franka_lockstep::for_each_robot;
use franka_proto::RobotError;
use franka_rt::control::{
    Callback, CartesianPose, Finish, JointPositions, JointVelocities, Torques,
};

#[test]
fn a_step_in_torque_names_the_joint_the_rate_and_the_cycle() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut torques = stepping(4, -3.0);
        let callback = Callback::torques(lockstep.client.version(), move |_, _| Torques(torques()));
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::ControllerTorqueDiscontinuity;
        let expected = (
            error,
            Subject::Joint(5),
            Quantity::TorqueRate,
            Origin::Commanded,
        );
        assert_eq!(found(&diagnosis), expected);
        assert_eq!(limit(&diagnosis), -1000.0);
        assert_eq!(diagnosis.finding.unwrap().value, -3000.0);
        let cycle = diagnosis.end.unwrap() - 1;
        assert_eq!(diagnosis.finding.unwrap().since, cycle);
        let step = Cause::TargetStep {
            subject: Subject::Joint(5),
            quantity: Quantity::Torque,
            size: -3.0,
            cycle,
        };
        assert_eq!(diagnosis.causes, [step]);
        assert_eq!(diagnosis.advice, [Advice::SmoothTorques]);
    });
}

#[test]
fn a_step_in_joint_positions_names_joint_acceleration_and_size() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut offset = stepping(3, 0.004);
        let mut start = None;
        let callback = Callback::motion(lockstep.client.version(), move |state, _| {
            let mut q: [f64; 7] = *start.get_or_insert(state.q_d);
            q.iter_mut()
                .zip(offset())
                .for_each(|(q, offset)| *q += offset);
            JointPositions(q)
        });
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::JointMotionGeneratorVelocityDiscontinuity;
        let expected = (
            error,
            Subject::Joint(4),
            Quantity::Acceleration,
            Origin::Commanded,
        );
        assert_eq!(found(&diagnosis), expected);
        let limits = lockstep.robot.config().kind;
        let limits = franka_model::limits::JointLimits::of(limits);
        assert_eq!(limit(&diagnosis), limits.acceleration[3]);
        let [
            Cause::TargetStep {
                subject,
                quantity,
                size,
                cycle,
            },
        ] = diagnosis.causes[..]
        else {
            panic!("{:?}", diagnosis.causes)
        };
        assert_eq!((subject, quantity), (Subject::Joint(4), Quantity::Position));
        assert!((size - 0.004).abs() < 1e-6, "{size}");
        assert_eq!(cycle + 1, diagnosis.end.unwrap());
    });
}

#[test]
fn velocity_step_is_diagnosed_by_joint_and_acceleration() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut dq = stepping(6, 0.2);
        let callback =
            Callback::motion(lockstep.client.version(), move |_, _| JointVelocities(dq()));
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::JointMotionGeneratorAccelerationDiscontinuity;
        let expected = (
            error,
            Subject::Joint(7),
            Quantity::Acceleration,
            Origin::Commanded,
        );
        assert_eq!(found(&diagnosis), expected);
        assert!((diagnosis.finding.unwrap().value - 200.0).abs() < 1e-9);
        assert!(
            matches!(
                diagnosis.causes[..],
                [Cause::TargetStep { quantity: Quantity::Velocity, size, .. }] if (size - 0.2).abs() < 1e-9
            ),
            "{:?}",
            diagnosis.causes
        );
    });
}

#[test]
fn a_jerk_alone_names_the_step_in_acceleration() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        // 0.007 rad/s more in every cycle are 7 rad/s² at once, less than the limit of any joint.
        let work = velocities(&mut lockstep, move |cycle| {
            let mut dq = [0.0; 7];
            dq[1] = 0.007 * f64::from(cycle.max(QUIET) - QUIET);
            dq
        });
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::JointMotionGeneratorAccelerationDiscontinuity;
        let expected = (error, Subject::Joint(2), Quantity::Jerk, Origin::Commanded);
        assert_eq!(found(&diagnosis), expected);
        limit(&diagnosis);
        assert!(matches!(
            diagnosis.causes[..],
            [Cause::TargetStep { quantity: Quantity::Acceleration, size, .. }] if (size - 7.0).abs() < 1e-6
        ));
    });
}

#[test]
fn a_pose_that_steps_names_the_axis() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut start = None;
        let mut offset = stepping(0, 0.002);
        let callback = Callback::motion(lockstep.client.version(), move |state, _| {
            let mut pose: [f64; 16] = *start.get_or_insert(state.O_T_EE_c);
            pose[14] -= offset()[0];
            CartesianPose {
                O_T_EE: pose,
                elbow: None,
            }
        });
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::CartesianMotionGeneratorVelocityDiscontinuity;
        let subject = Subject::Translation(Axis::Z);
        let expected = (error, subject, Quantity::Acceleration, Origin::Commanded);
        assert_eq!(found(&diagnosis), expected);
        let kind = lockstep.robot.config().kind;
        let limits = franka_model::limits::CartesianLimits::of(kind);
        assert_eq!(limit(&diagnosis), limits.translation.acceleration);
        let [
            Cause::TargetStep {
                subject,
                quantity,
                size,
                ..
            },
        ] = diagnosis.causes[..]
        else {
            panic!("{:?}", diagnosis.causes)
        };
        assert_eq!(
            (subject, quantity),
            (Subject::Translation(Axis::Z), Quantity::Position)
        );
        assert!((size - 0.002).abs() < 1e-6, "{size}");
    });
}

#[test]
fn a_first_command_elsewhere_is_named_as_such() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let callback = Callback::motion(lockstep.client.version(), |state, _| {
            let mut q = state.q_d;
            q[0] += 0.2;
            JointPositions(q)
        });
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::JointPositionMotionGeneratorStartPoseInvalid;
        let expected = (
            error,
            Subject::Joint(1),
            Quantity::StartOffset,
            Origin::Commanded,
        );
        assert_eq!(found(&diagnosis), expected);
        assert!(matches!(
            diagnosis.causes[..],
            [Cause::WrongStart { offset, .. }] if (offset - 0.2).abs() < 1e-6
        ));
        assert_eq!(diagnosis.advice, [Advice::StartWhereItIs]);
    });
}

#[test]
fn a_motion_finished_at_speed_is_advised_to_come_to_rest() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut cycle = 0;
        let callback =
            Callback::motion::<JointVelocities, _>(lockstep.client.version(), move |_, _| {
                cycle += 1;
                let mut dq = [0.0; 7];
                dq[5] = 0.1 * (f64::from(cycle) / 500.0).min(1.0);
                JointVelocities(dq).finish_if(cycle > 600)
            });
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::JointMotionGeneratorAccelerationDiscontinuity;
        let expected = (
            error,
            Subject::Joint(6),
            Quantity::Acceleration,
            Origin::Commanded,
        );
        assert_eq!(found(&diagnosis), expected);
        assert!(matches!(
            diagnosis.causes[..],
            [Cause::FinishedMoving { subject: Subject::Joint(6), velocity, .. }] if (velocity - 0.1).abs() < 1e-9
        ));
        assert_eq!(diagnosis.advice, [Advice::FinishAtRest]);
    });
}
