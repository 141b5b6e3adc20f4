//! Lost packets, and a log without cycles.

use super::{begin, diagnosis, found, stepping, velocities};
use franka_diagnosis::{Advice, Bound, Cause, Diagnosis, Quantity, Subject};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_proto::RobotError;
use franka_rt::control::{Callback, Torques};

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
        // The twentieth ended the motion.
        assert_eq!(diagnosis.finding.unwrap().value, 20.0);
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
fn a_jump_after_a_loss_is_attributed_to_the_loss() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        // Accelerates, so that the robot's extrapolation over the lost cycles continues to
        // accelerate, while the function's velocity swings back.
        let work = velocities(&mut lockstep, move |cycle| {
            let mut dq = [0.0; 7];
            dq[0] = 0.2 * (0.03 * f64::from(cycle)).sin() * (f64::from(cycle) / 500.0).min(1.0);
            dq
        });
        lockstep.run(700);
        lockstep.link.drop_commands(12);
        let diagnosis = diagnosis(&mut lockstep, work);
        assert_eq!(found(&diagnosis).1, Subject::Joint(1));
        // The robot judges the first command after the loss, and none of the lost ones.
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
fn without_a_log_the_diagnosis_says_so() {
    for_each_robot(|ready| {
        let mut lockstep = ready().with_log_size(0);
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
        assert!(
            diagnosis
                .to_string()
                .contains("the log has no cycle of the motion")
        );
    });
}
