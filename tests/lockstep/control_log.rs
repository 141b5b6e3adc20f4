//! A reflex, and the information in libfranka's table and text about it.

use crate::diagnosis::{begin, stepping};
use franka_diagnosis::{Diagnose, Diagnosis};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_proto::Version;
use franka_record::control_log::ControlLogFile;
use franka_record::explain::Explanation;
use franka_rt::control::{
    Callback, CartesianPose, CartesianVelocities, JointPositions, JointVelocities, Torques,
};
use franka_rt::lifecycle::ControlError;

fn provoke(lockstep: &mut Lockstep, callback: Callback) -> ControlError {
    let work = begin(lockstep, callback);
    let error = lockstep.until_resolved(work, 1000).expect_err("a reflex");
    error.control().expect("ended by the robot").clone()
}

/// Content of a diagnosis: error, subject, quantity, origin, first cycle, and the causes' kinds.
fn told(diagnosis: &Diagnosis) -> String {
    let finding = diagnosis.finding.expect("it is visible");
    let causes = diagnosis.causes.iter().map(core::mem::discriminant);
    format!(
        "{:?} {:?} {:?} {:?} {} {:?}",
        finding.error,
        finding.subject,
        finding.quantity,
        finding.origin,
        finding.since,
        causes.collect::<Vec<_>>()
    )
}

#[test]
fn the_table_of_a_reflex_names_what_the_whole_log_names() {
    type Make = fn(Version) -> Callback;
    let motions: [Make; 6] = [
        |version| {
            let mut torques = stepping(4, -3.0);
            Callback::torques(version, move |_, _| Torques(torques()))
        },
        |version| {
            let (mut offset, mut start) = (stepping(3, 0.004), None);
            Callback::motion(version, move |state, _| {
                let q: [f64; 7] = *start.get_or_insert(state.q_d);
                let offset = offset();
                JointPositions(core::array::from_fn(|i| q[i] + offset[i]))
            })
        },
        |version| {
            let mut dq = stepping(6, 0.2);
            Callback::motion(version, move |_, _| JointVelocities(dq()))
        },
        // A jerk alone, from velocities that grow.
        |version| {
            let mut cycle = 0;
            Callback::motion(version, move |_, _| {
                cycle += 1;
                let grown = f64::from((cycle - 150).max(0));
                JointVelocities([0.0, 0.007 * grown, 0.0, 0.0, 0.0, 0.0, 0.0])
            })
        },
        |version| {
            let (mut offset, mut start) = (stepping(1, 0.01), None);
            Callback::motion(version, move |state, _| {
                let mut pose: [f64; 16] = *start.get_or_insert(state.O_T_EE_c);
                pose[13] += offset()[1];
                CartesianPose {
                    O_T_EE: pose,
                    elbow: None,
                }
            })
        },
        |version| {
            let mut speed = stepping(2, 0.1);
            Callback::motion(version, move |_, _| {
                let speed = speed();
                CartesianVelocities {
                    O_dP_EE: core::array::from_fn(|i| speed[i]),
                    elbow: None,
                }
            })
        },
    ];
    for_each_robot(|ready| {
        for motion in motions {
            let mut lockstep = ready();
            let callback = motion(lockstep.client.version());
            let error = provoke(&mut lockstep, callback);
            let model = lockstep.client.lifecycle.model();
            let whole = error.diagnose().expect("ended by the robot");
            let text = format!("{error}\n\n{}", error.log.to_csv());
            let file = ControlLogFile::parse(&text).expect("it can be read");
            assert_eq!(file.errors(), error.failure.reflex_reason);
            let message = file.message.as_ref().expect("it has a text");
            assert_eq!(message.success_rate, error.failure.success_rate);
            let explanation = Explanation::of_control_log(&file, model);
            println!("{explanation}\n");
            let cause = explanation.cause.expect("a cause");
            let read = cause.diagnosis.expect("a diagnosis");
            assert_eq!(told(&read), told(&whole), "{whole}\n{read}");
            assert_eq!((read.end, read.cycles), (whole.end, whole.cycles));
            assert_eq!(read.advice, whole.advice);
        }
    });
}

/// Positions of a quiet motion, which rounding to six digits makes jump: no finding.
#[test]
fn rounding_of_a_table_is_no_finding() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let (mut time, mut start) = (0.0, None);
        let callback = Callback::motion(lockstep.client.version(), move |state, _| {
            time += 1e-3;
            let start: [f64; 7] = *start.get_or_insert(state.q_d);
            let way = 0.05 * (1.0 - f64::cos(2.0 * time));
            JointPositions(start.map(|q| q + way))
        });
        let work = begin(&mut lockstep, callback);
        lockstep.run(900);
        lockstep
            .robot
            .trip(franka_proto::RobotError::JointMotionGeneratorVelocityDiscontinuity);
        let error = lockstep.until_resolved(work, 100).expect_err("a reflex");
        let error = error.control().expect("ended by the robot");
        let model = lockstep.client.lifecycle.model();
        let text = format!("{error}\n{}", error.log.to_csv());
        let file = ControlLogFile::parse(&text).expect("it can be read");
        let diagnosis = Diagnosis::of(&file.case(), model);
        assert_eq!(diagnosis.finding, None, "{diagnosis}");
        assert!(error.diagnose().is_some_and(|it| it.finding.is_none()));
    });
}
