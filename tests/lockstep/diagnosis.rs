//! Reflexes of the simulated robot, and what the error says of how they came about.

use franka_model::RobotKind;
use franka_proto::{CollisionBehavior, MoveControllerMode, Request, RobotError};
use franka_rt::control::{
    Callback, CartesianPose, CartesianVelocities, Finish, JointPositions, JointVelocities, Torques,
};
use franka_rt::diagnosis::{Advice, Axis, Bound, Cause, Diagnosis, Origin, Quantity, Subject};
use franka_rt::driver::Program;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalId, Target};
use franka_rt::shaping::Shaper;
use franka_sim::Touch;
use franka_tests::lockstep::{Lockstep, for_each_robot};

/// Cycles before something happens.
const QUIET: u32 = 150;

fn begin(lockstep: &mut Lockstep, callback: Callback) -> GoalId {
    let version = lockstep.client.version();
    let callback = callback.with_shaper(Shaper::new(version, false, 1000.0));
    let request = callback.request(version, MoveControllerMode::JointImpedance);
    let program = Program::Callback(Box::new(callback));
    lockstep.control(program, request).expect("nothing moves")
}

/// Runs until a reflex ends the motion; prints what is said of it, and checks its shape.
fn diagnosis(lockstep: &mut Lockstep, work: GoalId) -> Diagnosis {
    let error = lockstep.until_resolved(work, 8000).expect_err("a reflex");
    let diagnosis = error.diagnosis().expect("the robot's doing").clone();
    println!("{diagnosis}\n");
    let text = diagnosis.to_string();
    assert!(text.lines().count() <= 6, "{text}");
    assert_eq!(
        diagnosis.errors,
        error.control().unwrap().failure.reflex_reason
    );
    diagnosis
}

/// What was found: error, subject, quantity and origin.
fn found(diagnosis: &Diagnosis) -> (RobotError, Subject, Quantity, Origin) {
    let finding = diagnosis.finding.expect("it is visible");
    assert_eq!(diagnosis.error, Some(finding.error));
    (
        finding.error,
        finding.subject,
        finding.quantity,
        finding.origin,
    )
}

/// The limit that was exceeded, which the value has to be beyond.
fn limit(diagnosis: &Diagnosis) -> f64 {
    let finding = diagnosis.finding.expect("it is visible");
    let Some(limit) = finding.bound.limit() else {
        panic!("{finding:?} has no limit")
    };
    assert!(
        finding.excess().is_some_and(|excess| excess > 0.0),
        "{finding:?}"
    );
    limit
}

/// A function that returns zeros, and after [`QUIET`] cycles `value` for joint `index`.
fn stepping(index: usize, value: f64) -> impl FnMut() -> [f64; 7] + Send {
    let mut cycle = 0;
    move || {
        cycle += 1;
        let mut values = [0.0; 7];
        values[index] = if cycle > QUIET { value } else { 0.0 };
        values
    }
}

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
        assert_eq!(diagnosis.advice, [Advice::Smooth]);
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
fn a_velocity_that_steps_names_the_joint_and_what_it_was_asked_for() {
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
        let mut cycle = 0;
        // 0.007 rad/s more in every cycle are 7 rad/s², less than any joint may have, at once.
        let callback = Callback::motion(lockstep.client.version(), move |_, _| {
            cycle += 1;
            let mut dq = [0.0; 7];
            dq[1] = 0.007 * f64::from(cycle.max(QUIET) - QUIET);
            JointVelocities(dq)
        });
        let work = begin(&mut lockstep, callback);
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
fn a_motion_that_is_finished_at_speed_is_told_to_come_to_rest() {
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

fn starving(lockstep: &mut Lockstep, lose: impl FnOnce(&mut Lockstep)) -> Diagnosis {
    let version = lockstep.client.version();
    let work = begin(
        lockstep,
        Callback::torques(version, |_, _| Torques([0.0; 7])),
    );
    lockstep.run(200);
    lose(lockstep);
    let diagnosis = diagnosis(lockstep, work);
    let error = RobotError::CommunicationConstraintsViolation;
    let (found, subject, quantity, _) = found(&diagnosis);
    assert_eq!(
        (found, subject, quantity),
        (error, Subject::Arm, Quantity::LostCycles)
    );
    assert_eq!(diagnosis.finding.unwrap().bound, Bound::AtMost(19.0));
    assert_eq!(diagnosis.advice, [Advice::Network]);
    diagnosis
}

#[test]
fn lost_states_are_counted() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let diagnosis = starving(&mut lockstep, |lockstep| lockstep.link.drop_states(30));
        let end = diagnosis.end.unwrap();
        let lost = Cause::LostPackets {
            states: 30,
            commands: 0,
            unanswered: 0,
            longest_run: 30,
            first: end - 30,
            last: end - 1,
            success_rate: 1.0,
        };
        assert_eq!(diagnosis.causes, [lost]);
        assert_eq!(diagnosis.finding.unwrap().value, 30.0);
    });
}

#[test]
fn commands_that_did_not_arrive_are_counted() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let diagnosis = starving(&mut lockstep, |lockstep| lockstep.link.drop_commands(100));
        let end = diagnosis.end.unwrap();
        let [
            Cause::LostPackets {
                states: 0,
                commands: 20,
                unanswered: 0,
                longest_run: 20,
                first,
                last,
                ..
            },
        ] = diagnosis.causes[..]
        else {
            panic!("{:?}", diagnosis.causes)
        };
        assert_eq!((first, last), (end - 20, end - 1));
    });
}

#[test]
fn a_leap_after_a_loss_is_laid_to_the_loss() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut cycle = 0;
        // Accelerates, so that what the robot makes up for the lost cycles goes on accelerating; the function does not
        // know, and lets the velocity swing.
        let callback = Callback::motion(lockstep.client.version(), move |_, _| {
            cycle += 1;
            let mut dq = [0.0; 7];
            dq[0] = 0.2 * (0.03 * f64::from(cycle)).sin() * (f64::from(cycle) / 500.0).min(1.0);
            JointVelocities(dq)
        });
        let work = begin(&mut lockstep, callback);
        lockstep.run(700);
        lockstep.link.drop_commands(12);
        let diagnosis = diagnosis(&mut lockstep, work);
        assert_eq!(found(&diagnosis).1, Subject::Joint(1));
        // The robot has judged the first command after the loss, and none of those that were lost.
        assert_eq!(diagnosis.cycles_before_end(), Some(1));
        assert!(
            matches!(
                diagnosis.causes[..],
                [
                    Cause::LostPackets {
                        commands: 12,
                        longest_run: 12,
                        ..
                    },
                    Cause::TargetStep { .. }
                ]
            ),
            "{:?}",
            diagnosis.causes
        );
        assert_eq!(diagnosis.advice[0], Advice::Network);
    });
}

#[test]
fn a_push_names_axis_force_and_threshold() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let behavior = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [10.0; 6], [25.0; 6]);
        lockstep.request(&Request::SetCollisionBehavior(behavior));
        lockstep.run(5);
        let version = lockstep.client.version();
        let work = begin(
            &mut lockstep,
            Callback::motion(version, |_, _| JointVelocities([0.0; 7])),
        );
        lockstep.run(100);
        // The robot tells what it does to its surroundings: against a push in y, a force in -y. The hand points downwards,
        // so that y of the stiffness frame is the other way round.
        lockstep.robot.touch(Touch::over_time(|t| {
            franka_model::Wrench::new(0.0, (400.0 * t).min(60.0), 0.0, 0.0, 0.0, 0.0)
        }));
        let diagnosis = diagnosis(&mut lockstep, work);
        let subject = Subject::Translation(Axis::Y);
        let expected = (
            RobotError::CartesianReflex,
            subject,
            Quantity::ExternalLoad,
            Origin::Estimated,
        );
        assert_eq!(found(&diagnosis), expected);
        let finding = diagnosis.finding.unwrap();
        let Bound::Between(passed, stopped) = finding.bound else {
            panic!("{finding:?}")
        };
        assert!(
            passed < 25.0 && (25.0..30.0).contains(&stopped),
            "{finding:?}"
        );
        let Cause::Contact {
            subject: felt,
            value,
            since,
        } = diagnosis.causes[0]
        else {
            panic!("{:?}", diagnosis.causes)
        };
        assert_eq!((felt, value), (subject, finding.value));
        // From 10 N to 25 N by 0.4 N a millisecond, give or take the filter.
        let led = diagnosis.end.unwrap() - since;
        assert!((25..=45).contains(&led), "{led}");
        assert_eq!(diagnosis.advice, [Advice::Thresholds]);
    });
}

#[test]
fn a_push_on_a_joint_names_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let behavior = CollisionBehavior::uniform([5.0; 7], [12.0; 7], [500.0; 6], [500.0; 6]);
        lockstep.request(&Request::SetCollisionBehavior(behavior));
        lockstep.run(5);
        let mut target: [f64; 7] = franka_model::READY.into();
        target[0] += 1.0;
        let way = lockstep.begin(Target::Joints(target));
        lockstep.run(300);
        let mut torque = franka_model::JointVector::zeros();
        torque[1] = 20.0;
        lockstep.robot.touch(Touch::torque(torque));
        let outcome = lockstep.until_resolved(way, 3000);
        let Err(MotionError::Control(error)) = outcome else {
            panic!("{outcome:?}")
        };
        let diagnosis = error.diagnosis.expect("a reflex");
        println!("{diagnosis}\n");
        assert_eq!(found(&diagnosis).0, RobotError::JointReflex);
        assert_eq!(found(&diagnosis).1, Subject::Joint(2));
        assert!(matches!(
            diagnosis.finding.unwrap().bound,
            Bound::Between(passed, stopped) if passed < 12.0 && 12.0 <= stopped
        ));
    });
}

#[test]
fn a_way_into_the_stretched_arm_is_named_singular() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut time = 0.0;
        let callback = Callback::motion(
            lockstep.client.version(),
            move |_, step: std::time::Duration| {
                time += step.as_secs_f64();
                CartesianVelocities {
                    O_dP_EE: [0.2 * (time / 0.5).min(1.0), 0.0, 0.0, 0.0, 0.0, 0.0],
                    elbow: None,
                }
            },
        );
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let (_, subject, _, origin) = found(&diagnosis);
        assert!(matches!(subject, Subject::Joint(_)), "{subject}");
        assert_eq!(origin, Origin::Desired);
        // At the limit, as well as states of single precision tell.
        let finding = diagnosis.finding.unwrap();
        assert!(
            finding.times().is_some_and(|times| times > 0.95),
            "{finding:?}"
        );
        assert_eq!(diagnosis.cycles_before_end(), Some(1));
        assert!(
            diagnosis.causes.iter().any(
                |cause| matches!(cause, Cause::Singularity { smallest, .. } if *smallest < 0.1)
            ),
            "{:?}",
            diagnosis.causes
        );
        assert_eq!(diagnosis.advice[0], Advice::AvoidSingularity);
    });
}

#[test]
fn a_joint_that_runs_into_its_limit_is_named_with_what_was_left() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut cycle = 0;
        let callback = Callback::motion(lockstep.client.version(), move |_, _| {
            cycle += 1;
            let mut dq = [0.0; 7];
            dq[3] = 0.6 * (f64::from(cycle) / 500.0).min(1.0);
            JointVelocities(dq)
        });
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        assert_eq!(found(&diagnosis).1, Subject::Joint(4));
        let Some(Cause::Limit {
            joint: 4,
            upper: true,
            distance,
            ..
        }) = diagnosis.causes.last()
        else {
            panic!("{:?}", diagnosis.causes)
        };
        // The range ends in a wall on the one, and behind an envelope on the other.
        match lockstep.robot.config().kind {
            RobotKind::Fer => assert!(distance.abs() < 0.001, "{distance}"),
            _ => assert!((0.05..0.2).contains(distance), "{distance}"),
        }
        assert!(diagnosis.advice.contains(&Advice::StayInRange));
    });
}

#[test]
fn an_arm_that_is_driven_too_fast_by_torques_is_named_by_its_joint() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let patient = CollisionBehavior::uniform([500.0; 7], [500.0; 7], [500.0; 6], [500.0; 6]);
        lockstep.request(&Request::SetCollisionBehavior(patient));
        lockstep.run(5);
        let mut cycle = 0;
        let callback = Callback::torques(lockstep.client.version(), move |_, _| {
            cycle += 1;
            let mut tau = [0.0; 7];
            tau[6] = (f64::from(cycle) * 0.05).min(6.0);
            Torques(tau)
        });
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        let error = RobotError::JointVelocityViolation;
        let expected = (
            error,
            Subject::Joint(7),
            Quantity::Velocity,
            Origin::Measured,
        );
        assert_eq!(found(&diagnosis), expected);
        limit(&diagnosis);
        assert!(
            diagnosis
                .cycles_before_end()
                .is_some_and(|cycles| cycles < 45)
        );
    });
}

#[test]
fn without_a_log_the_diagnosis_says_so() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let lifecycle = std::mem::replace(
            &mut lockstep.client.lifecycle,
            franka_rt::lifecycle::Lifecycle::new(
                franka_model::Model::of(lockstep.robot.config().kind)
                    .clone()
                    .into(),
                lockstep.robot.version(),
            ),
        );
        lockstep.client.lifecycle = lifecycle.with_log_size(0);
        let mut torques = stepping(0, 10.0);
        let callback = Callback::torques(lockstep.client.version(), move |_, _| Torques(torques()));
        let work = begin(&mut lockstep, callback);
        let diagnosis = diagnosis(&mut lockstep, work);
        assert_eq!(
            diagnosis.error,
            Some(RobotError::ControllerTorqueDiscontinuity)
        );
        assert_eq!((diagnosis.finding, diagnosis.end), (None, None));
        assert!(diagnosis.causes.is_empty());
        assert!(diagnosis.to_string().contains("there is no log"));
    });
}
