//! The state that counts, and the behaviour without a state.

use std::time::Duration;

use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest};
use franka_rt::control::{ActiveControl, Callback, Command, JointVelocities, Torques, WriteError};
use franka_rt::driver::Program;
use franka_rt::lifecycle::{CloseReason, MotionError};

use crate::for_each_version;
use crate::pair::Pair;

const TORQUES: Torques = Torques([0.5; 7]);

#[test]
fn scenario_1_the_newest_of_the_states_that_wait_counts() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        pair.robot.send(2);
        pair.cycle();
        for id in [1, 4, 2, 3] {
            pair.robot.send(id);
        }
        let reception = pair.cycle();
        assert!(reception.fresh);
        assert_eq!((reception.skipped, reception.stale), (0, 3));
        assert_eq!(pair.client.state.message_id, 4);
        assert_eq!(pair.client.record.skipped, 1, "there was none between");
    });
}

/// The text of libfranka is `libfranka: UDP receive: Timeout`; this driver adds how long it waited.
#[test]
fn scenario_2_a_second_without_a_state_loses_the_link() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let request = MoveRequest::new(
            MoveControllerMode::ExternalController,
            version.torque_generator(),
        );
        let motion = pair.begin(Program::Active(ActiveControl), request);
        pair.silence(1..=999);
        assert_eq!(pair.client.outcome(motion.work), None);
        pair.silence(1000..=1000);
        let error = pair.error(motion.work);
        let silence = Duration::from_secs(1);
        assert_eq!(error, MotionError::LinkLost { silence });
        assert_eq!(
            error.to_string(),
            "libfranka: UDP receive: Timeout (no robot state for 1000 ms)"
        );
        pair.robot.expect_stop();
        let written = pair.write(Command::torques(version, TORQUES), false);
        assert_eq!(written, Err(WriteError::NotRunning));
    });
}

/// After the loss of its connection, the driver refuses the torques of a motion with the text for
/// an ended motion; libfranka names the connection once more. `tests/live/ending.rs` closes real
/// sockets in every phase of a motion.
#[test]
fn scenario_2_closed_connection_ends_motion_and_torques() {
    let closed = "libfranka: server closed connection";
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let request = MoveRequest::new(
            MoveControllerMode::ExternalController,
            version.torque_generator(),
        );
        let motion = pair.begin(Program::Active(ActiveControl), request);
        assert!(
            pair.write(Command::torques(version, TORQUES), false)
                .is_ok()
        );
        pair.client.close(CloseReason::ClosedByPeer);
        let error = pair.error(motion.work);
        assert!(matches!(error, MotionError::ConnectionClosed { .. }));
        assert_eq!(error.to_string(), closed);

        let written = pair.write(Command::torques(version, TORQUES), false);
        assert_eq!(written, Err(WriteError::NotRunning));
        let again = pair
            .client
            .control(Program::Active(ActiveControl), request)
            .unwrap_err();
        assert_eq!(again.to_string(), closed);
    });
}

/// States may continue after the end of the stream. A control function, which can no longer be
/// stopped, gets none of them.
#[test]
fn scenario_2_control_function_gets_no_states_once_closed() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let callback = Callback::torques(version, |_, _| TORQUES);
        let request = callback.request(version, MoveControllerMode::JointImpedance);
        let motion = pair.begin(Program::Callback(Box::new(callback)), request);
        assert!(motion.first.is_some());
        pair.client.close(CloseReason::ClosedByPeer);
        for _ in 0..3 {
            assert_eq!(pair.step(), None);
        }
    });
}

#[test]
fn scenario_7_command_echoes_the_id_of_its_state() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let callback = Callback::motion(version, |_, _| JointVelocities([0.0; 7]));
        let request = MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointVelocity,
        );
        pair.begin(Program::Callback(Box::new(callback)), request);
        pair.robot.send(682);
        pair.cycle();
        // The robot is one cycle further when it checks for the answer.
        pair.robot.send(683);
        let command = pair.robot.take_command().expect("an answer");
        assert_eq!(command.message_id, 682);
        pair.cycle();
        assert_eq!(pair.client.state.message_id, 683);
        let command = pair.robot.take_command().expect("an answer");
        assert_eq!(command.message_id, 683);

        // With both states waiting there is one answer, to the newer.
        pair.robot.send(684);
        pair.robot.send(685);
        pair.cycle();
        let command = pair.robot.take_command().expect("an answer");
        assert_eq!(command.message_id, 685);
        assert_eq!(pair.robot.take_command(), None);
    });
}
