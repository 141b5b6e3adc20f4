//! Control functions.

use std::sync::mpsc;
use std::time::Duration;

use franka_proto::{MoveControllerMode, MoveRequest, RobotState, Version};
use franka_rt::control::{Callback, Finish, JointPositions, JointVelocities, Next, Torques};
use franka_rt::driver::{Activity, Program};
use franka_rt::lifecycle::{END_TIMEOUT, MotionError};
use franka_rt::shaping::InvalidCommand;

use crate::for_each_version;
use crate::pair::{Pair, Running};

/// A motion by torques alone.
fn torques<R: Into<Next<Torques>>>(
    version: Version,
    function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
) -> (Program, MoveRequest) {
    let callback = Callback::torques(version, function);
    let request = callback.request(version, MoveControllerMode::JointImpedance);
    (Program::Callback(Box::new(callback)), request)
}

/// A motion that stands still and ends with its first command.
fn one_command(version: Version) -> (Program, MoveRequest) {
    torques(version, |_, _| Torques([0.0; 7]).finish())
}

/// Asserts that a function that failed in the previous cycle gets no more states, and that the
/// robot is stopped. The motion must resolve when it has stopped, and the next motion must run.
fn assert_stopped(pair: &mut Pair, motion: &Running) -> MotionError {
    assert_eq!(pair.client.record.activity, Activity::Silent);
    assert_eq!(pair.step(), None);
    assert_eq!(pair.client.outcome(motion.work), None);
    pair.robot.obey_stop(motion.id);
    assert_eq!(pair.step(), None);
    let error = pair.error(motion.work);
    pair.assert_idle();

    let (program, request) = one_command(pair.client.version());
    let next = pair.begin(program, request);
    assert!(next.first.is_some());
    pair.succeed(&next);
    error
}

/// A panic itself cannot pass from the control thread to the caller; its message can.
#[test]
fn scenario_15_a_panic_in_a_control_function_stops_the_robot() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let mut cycle = 0;
        let (program, request) = torques(version, move |_, _| {
            cycle += 1;
            assert!(cycle < 3, "no more ideas");
            Torques([0.0; 7])
        });
        let motion = pair.begin(program, request);
        assert!(motion.first.is_some());
        assert!(pair.step().is_some());
        assert_eq!(pair.step(), None);
        let error = assert_stopped(&mut pair, &motion);
        let message = "no more ideas".to_owned();
        assert_eq!(error, MotionError::Panicked { message });
    });
}

#[test]
fn control_function_giving_up_stops_robot_with_its_code() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let mut cycle = 0;
        let (program, request) = torques(version, move |_, _| {
            cycle += 1;
            match cycle {
                3 => Next::GiveUp(-7),
                _ => Next::Continue(Torques([0.0; 7])),
            }
        });
        let motion = pair.begin(program, request);
        assert!(motion.first.is_some());
        assert!(pair.step().is_some());
        assert_eq!(pair.step(), None);
        let error = assert_stopped(&mut pair, &motion);
        assert_eq!(error, MotionError::GivenUp { code: -7 });
    });
}

/// The outcome is the panic, the cause of the other events.
#[test]
fn scenario_15_panic_is_reported_even_without_a_stop() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = torques(version, |_, _| -> Torques { panic!("no more ideas") });
        let motion = pair.begin(program, request);
        let patience = 2 * END_TIMEOUT.as_millis() as u64;
        for _ in 1..patience {
            assert_eq!(pair.step(), None);
            assert_eq!(pair.client.outcome(motion.work), None);
        }
        pair.step();
        pair.robot.expect_stop();
        pair.robot.expect_stop();
        let message = "no more ideas".to_owned();
        assert_eq!(pair.error(motion.work), MotionError::Panicked { message });
    });
}

/// The vendor's control loops throw this error, too.
#[test]
fn scenario_15_a_non_finite_command_stops_the_robot() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let callback = Callback::motion(version, |state, _| {
            let mut q = state.q_d;
            q[6] = f64::NAN;
            JointPositions(q)
        });
        let callback =
            callback.with_shaper(franka_rt::control::Shaper::new(version, false, 1000.0));
        let request = callback.request(version, MoveControllerMode::JointImpedance);
        let motion = pair.begin(Program::Callback(Box::new(callback)), request);
        assert_eq!(motion.first, None);
        let error = assert_stopped(&mut pair, &motion);
        assert_eq!(error, MotionError::Invalid(InvalidCommand::NotFinite));
        assert_eq!(error.to_string(), "Commanding value is infinite or NaN.");
    });
}

#[test]
fn scenario_15_a_motion_may_finish_with_its_first_command() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (calls, called) = mpsc::channel();
        let (program, request) = torques(version, move |state, _| {
            calls.send(state.message_id).expect("the test listens");
            Torques([0.0; 7]).finish()
        });
        let motion = pair.begin(program, request);
        let first = motion.first.expect("an answer");
        assert!(first.motion_generation_finished || first.torque_command_finished);
        // The function saw one state, although the command is repeated.
        let again = pair.step().expect("an answer");
        assert_eq!(again.message_id, first.message_id + 1);
        pair.succeed(&motion);
        assert_eq!(called.iter().collect::<Vec<_>>(), [first.message_id]);
    });
}

#[test]
fn scenario_15_the_time_step_is_the_robots() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (calls, called) = mpsc::channel();
        let twice = calls.clone();
        let callback = Callback::motion(version, move |state, step| {
            let call = ("motion", state.message_id, step.as_millis());
            calls.send(call).expect("the test listens");
            JointVelocities([0.0; 7])
        });
        let callback = callback.with_torques(move |state, step| {
            let call = ("torques", state.message_id, step.as_millis());
            twice.send(call).expect("the test listens");
            Torques([0.0; 7])
        });
        let request = callback.request(version, MoveControllerMode::JointImpedance);
        pair.robot.state.message_id = 9;
        pair.begin(Program::Callback(Box::new(callback)), request);
        pair.robot.state.message_id = 11;
        pair.step();
        let (first, second) = match version {
            Version::V5 => ("motion", "torques"),
            Version::V10 => ("torques", "motion"),
        };
        let called: Vec<_> = called.try_iter().collect();
        assert_eq!(
            called,
            [
                (first, 10, 0),
                (second, 10, 0),
                (first, 12, 2),
                (second, 12, 2)
            ]
        );
    });
}
