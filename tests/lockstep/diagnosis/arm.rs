//! Reflexes caused by pushes, limits and singular postures.

use super::{begin, diagnosis, found, limit, velocities};
use franka_diagnosis::{Advice, Axis, Bound, Cause, Diagnose, Origin, Quantity, Subject};
use franka_lockstep::for_each_robot;
use franka_model::RobotKind;
use franka_proto::{CollisionBehavior, Request, RobotError};
use franka_rt::control::{Callback, CartesianVelocities, JointVelocities, Torques};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::Target;
use franka_sim::Touch;

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
        // The robot reports the force that it exerts: against a push in y, a force in -y.
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
            passed < 25.0 && (25.0..30.0).contains(&stopped) && finding.value < 0.0,
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
        // From 10 N to 25 N by 0.4 N per millisecond, apart from the filter's delay.
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
        let diagnosis = error.diagnose().expect("a reflex");
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
fn a_path_into_the_stretched_arm_is_named_singular() {
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
        // At the limit, within the single precision of the states.
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
fn a_joint_that_runs_into_its_limit_is_named_with_its_margin() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let work = velocities(&mut lockstep, move |cycle| {
            let mut dq = [0.0; 7];
            dq[3] = 0.6 * (f64::from(cycle) / 500.0).min(1.0);
            dq
        });
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
        // An FER limits the position alone, an FR3 also the velocity towards the end of the range.
        match lockstep.robot.config().kind {
            RobotKind::Fer => assert!(distance.abs() < 0.001, "{distance}"),
            _ => assert!((0.05..0.2).contains(distance), "{distance}"),
        }
        assert!(diagnosis.advice.contains(&Advice::StayInRange));
    });
}

#[test]
fn torques_that_drive_a_joint_too_fast_name_the_joint() {
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
