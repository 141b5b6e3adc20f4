//! Tests of control functions with artificial states.

use std::sync::mpsc::{Receiver, Sender, channel};

use franka_proto::MoveGeneratorMode;

use super::*;
use crate::control::{CartesianPose, CartesianVelocities, Finish, JointPositions, JointVelocities};
use crate::shaping::InvalidCommand;

fn at(message_id: u64) -> RobotState {
    RobotState {
        message_id,
        ..RobotState::default()
    }
}

/// Returns a shaper that leaves commands as they are.
fn plain(version: Version) -> Shaper {
    Shaper::new(version, false, 1000.0)
}

/// Returns two functions that record each call: name, time step in milliseconds, and cycle. They
/// finish in the given cycles, counted from one. The first function commands ten times the cycle,
/// the second commands the cycle.
fn both(
    version: Version,
    motion_ends: u32,
    torques_end: u32,
) -> (Callback, Receiver<(&'static str, u128)>) {
    let (calls, called) = channel();
    let motion_calls: Sender<_> = calls.clone();
    let (mut motion_cycle, mut torque_cycle) = (0, 0);
    let callback = Callback::motion::<JointVelocities, _>(version, move |_, step| {
        motion_cycle += 1;
        motion_calls
            .send(("motion", step.as_millis()))
            .expect("heard");
        let command = JointVelocities([f64::from(motion_cycle); 7]);
        if motion_cycle == motion_ends {
            command.finish()
        } else {
            command.into()
        }
    });
    let callback = callback.with_shaper(plain(version));
    let callback = callback.with_torques(move |_, step| {
        torque_cycle += 1;
        calls.send(("torques", step.as_millis())).expect("heard");
        let command = Torques([10.0 * f64::from(torque_cycle); 7]);
        if torque_cycle == torques_end {
            command.finish()
        } else {
            command.into()
        }
    });
    (callback, called)
}

/// Returns the command that is sent: `dq_c` and `tau_J_d` of the first joint, and true if it is the
/// last command.
fn step(callback: &mut Callback, message_id: u64) -> (f64, f64, bool) {
    let (command, finished) = callback.step(&at(message_id)).expect("good commands");
    let sent = command
        .datagram(message_id, finished)
        .expect("it is finite");
    assert_eq!(sent.motion_generation_finished, finished);
    (sent.dq_c[0], sent.tau_J_d[0], finished)
}

#[test]
fn the_order_of_two_functions_is_that_of_the_versions_client() {
    for (version, order) in [
        (Version::V5, ["motion", "torques"]),
        (Version::V10, ["torques", "motion"]),
    ] {
        let (mut callback, called) = both(version, 0, 0);
        assert_eq!(step(&mut callback, 10), (1.0, 10.0, false));
        assert_eq!(step(&mut callback, 12), (2.0, 20.0, false));
        let called: Vec<_> = called.try_iter().collect();
        let [first, second] = order;
        let expected = [(first, 0), (second, 0), (first, 2), (second, 2)];
        assert_eq!(called, expected, "protocol {version}");
    }
}

#[test]
fn finished_function_keeps_the_other_from_its_call() {
    // In the third cycle one function finishes. If the other function comes second, it is not
    // called, and its command of the second cycle is sent.
    for (version, motion_ends, torques_end, last) in [
        (Version::V5, 3, 0, (3.0, 20.0, true)),
        (Version::V5, 0, 3, (3.0, 30.0, true)),
        (Version::V5, 3, 3, (3.0, 20.0, true)),
        (Version::V10, 3, 0, (3.0, 30.0, true)),
        (Version::V10, 0, 3, (2.0, 30.0, true)),
        (Version::V10, 3, 3, (2.0, 30.0, true)),
    ] {
        let (mut callback, _called) = both(version, motion_ends, torques_end);
        assert_eq!(step(&mut callback, 1), (1.0, 10.0, false));
        assert_eq!(step(&mut callback, 2), (2.0, 20.0, false));
        let case = format!("protocol {version}, {motion_ends}, {torques_end}");
        assert_eq!(step(&mut callback, 3), last, "{case}");
    }
}

#[test]
fn a_function_that_was_never_called_commands_zeros() {
    let (mut callback, called) = both(Version::V10, 0, 1);
    assert_eq!(step(&mut callback, 7), (0.0, 10.0, true));
    assert_eq!(called.try_iter().count(), 1);
    let (mut callback, called) = both(Version::V5, 1, 0);
    assert_eq!(step(&mut callback, 7), (1.0, 0.0, true));
    assert_eq!(called.try_iter().count(), 1);
}

#[test]
fn each_kind_of_command_asks_for_its_generator() {
    use MoveControllerMode::{CartesianImpedance, ExternalController};
    let version = Version::V10;
    let positions = Callback::motion(version, |_, _| JointPositions([0.0; 7]));
    let velocities = Callback::motion(version, |_, _| JointVelocities([0.0; 7]));
    let pose = Callback::motion(version, |_, _| CartesianPose::ZERO);
    let twist = Callback::motion(version, |_, _| CartesianVelocities::ZERO);
    for (callback, generator) in [
        (positions, MoveGeneratorMode::JointPosition),
        (velocities, MoveGeneratorMode::JointVelocity),
        (pose, MoveGeneratorMode::CartesianPosition),
        (twist, MoveGeneratorMode::CartesianVelocity),
    ] {
        let asked = callback.request(version, CartesianImpedance);
        assert_eq!(asked, MoveRequest::new(CartesianImpedance, generator));
        let asked = callback
            .with_torques(|_, _| NO_TORQUES)
            .request(version, CartesianImpedance);
        assert_eq!(asked, MoveRequest::new(ExternalController, generator));
    }
    for version in Version::ALL {
        let torques = Callback::torques(version, |_, _| NO_TORQUES);
        let asked = torques.request(version, CartesianImpedance);
        let expected = MoveRequest::new(ExternalController, version.torque_generator());
        assert_eq!(asked, expected);
    }
}

#[test]
fn torques_alone_come_with_a_still_motion_if_needed() {
    for version in Version::ALL {
        let callback = Callback::torques(version, |_, _| Torques([3.0; 7]).finish());
        let mut callback = callback.with_shaper(plain(version));
        let (command, finished) = callback.step(&at(1)).expect("good commands");
        assert!(finished);
        assert_eq!(command, Command::torques(version, Torques([3.0; 7])));
    }
}

#[test]
fn the_first_command_is_shaped_as_the_first() {
    // Protocol 10 filters the first position against itself, and later positions against the state.
    let state = RobotState {
        q_d: [1.0; 7],
        ..at(5)
    };
    let version = Version::V10;
    let callback = Callback::motion(version, |_, _| JointPositions([2.0; 7]));
    let mut callback = callback.with_shaper(Shaper::new(version, false, 100.0));
    let mut q = |message_id| {
        let state = RobotState {
            message_id,
            ..state
        };
        let (command, _) = callback.step(&state).expect("good commands");
        command
            .datagram(message_id, false)
            .expect("it is finite")
            .q_c[0]
    };
    assert_eq!(q(5), 2.0);
    let second = q(6);
    assert!(1.0 < second && second < 1.5, "{second}");
}

#[test]
fn a_bad_command_or_a_panic_fails_the_step() {
    let version = Version::V10;
    let callback = Callback::torques(version, |_, _| Torques([f64::NAN; 7]));
    let failure = callback.with_shaper(plain(version)).step(&at(1));
    assert!(matches!(
        failure,
        Err(Failure::Invalid(InvalidCommand::NotFinite))
    ));
    let callback = Callback::torques(version, |_, _| -> Torques { panic!("no more ideas") });
    let failure = callback.with_shaper(plain(version)).step(&at(1));
    let Err(Failure::Panicked(payload)) = failure else {
        panic!("{failure:?}")
    };
    assert_eq!(payload.downcast_ref(), Some(&"no more ideas"));
}
