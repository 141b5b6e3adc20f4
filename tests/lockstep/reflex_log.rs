//! A reflex caused by a control function, and the log that shows the cause.

use crate::diagnosis::{begin, stepping};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_proto::{Errors, RobotError};
use franka_rt::control::{Callback, JointVelocities, Torques};
use franka_rt::driver::{ControlLog, LogEntry};
use franka_rt::lifecycle::ControlError;

/// Runs `callback` until a reflex ends it.
fn provoke(lockstep: &mut Lockstep, callback: Callback) -> ControlError {
    let work = begin(lockstep, callback);
    let error = lockstep.until_resolved(work, 1000).expect_err("a reflex");
    error.control().expect("ended by the robot").clone()
}

/// Asserts that the text names `cause`, and that the log is full. Only its last entry must have the
/// command that `stepped` recognises. The state of that entry, the first after the command, must be
/// the one with the error.
fn assert_shown(error: &ControlError, cause: RobotError, stepped: impl Fn(&LogEntry) -> bool) {
    let text = format!(
        "libfranka: Move command aborted: motion aborted by reflex! [\"{}\"]\n\
         control_command_success_rate: 1",
        cause.name()
    );
    assert_eq!(error.to_string(), text);
    let log = &error.log;
    assert_eq!(log.len(), ControlLog::DEFAULT_CAPACITY);
    let mut newest = log.iter().rev();
    let last = newest.next().expect("it is full");
    assert!(stepped(last), "{:?}", last.command);
    assert_eq!(last.state.reflex_reason, Errors::from(cause));
    assert_eq!(last.state.message_id, last.command.message_id + 1);
    for (before, after) in newest.zip(log.iter().rev()) {
        assert!(!stepped(before), "{:?}", before.command);
        assert_eq!(before.state.reflex_reason, Errors::default());
        assert_eq!(before.state.message_id + 1, after.state.message_id);
    }
    // The table, too: the newest cycle is its last row.
    let table = log.to_csv();
    let row = table.lines().last().expect("rows");
    assert!(
        row.starts_with(&format!("{},0,", last.state.message_id)),
        "{row}"
    );
}

#[test]
fn torque_step_is_in_the_log_beside_its_reflex() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut torques = stepping(0, 10.0);
        let callback = Callback::torques(lockstep.client.version(), move |_, _| Torques(torques()));
        let error = provoke(&mut lockstep, callback);
        let cause = RobotError::ControllerTorqueDiscontinuity;
        assert_shown(&error, cause, |entry| entry.command.tau_J_d[0] == 10.0);
    });
}

#[test]
fn velocity_step_is_in_the_log_beside_its_reflex() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut dq = stepping(3, 0.25);
        let callback =
            Callback::motion(lockstep.client.version(), move |_, _| JointVelocities(dq()));
        let error = provoke(&mut lockstep, callback);
        let cause = RobotError::JointMotionGeneratorAccelerationDiscontinuity;
        assert_shown(&error, cause, |entry| entry.command.dq_c[3] == 0.25);
    });
}

/// Losses in the last sample are in the text, and lower the rate.
#[test]
fn communication_reflex_tells_the_number_of_lost_packets() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let version = lockstep.client.version();
        let callback = Callback::torques(version, |_, _| Torques([0.0; 7]));
        let work = begin(&mut lockstep, callback);
        lockstep.run(200);
        lockstep.link.drop_states(30);
        let error = lockstep.until_resolved(work, 1000).expect_err("a reflex");
        let error = error.control().expect("ended by the robot");
        // Thirty of a hundred are lost: 1 - 30/100.
        assert_eq!(
            error.to_string(),
            "libfranka: Move command aborted: motion aborted by reflex! \
             [\"communication_constraints_violation\"]\n\
             control_command_success_rate: 0.7 packets lost in a row in the last sample: 30"
        );
    });
}
