//! Commands that the motion accepts, and those that it refuses.

use franka_proto::framing::next_message;
use franka_proto::{
    MoveControllerMode, MoveGeneratorMode, MoveRequest, Request, RequestError, Version, client,
    server,
};
use franka_rt::control::{
    ActiveControl, Command, JointPositions, JointVelocities, Misfit, Modes, Torques, WriteError,
};
use franka_rt::driver::Program;

use crate::for_each_version;
use crate::pair::{Pair, Running};

const MOTION: JointPositions = JointPositions([0.25; 7]);
const TORQUES: Torques = Torques([0.5; 7]);

/// A motion command, torques, or both.
fn command(motion: bool, torques: bool) -> Command {
    Command {
        motion: motion.then_some(MOTION.into()),
        torques: torques.then_some(TORQUES),
    }
}

/// A motion under external commands.
fn active(
    version: Version,
    controller: MoveControllerMode,
    generator: MoveGeneratorMode,
) -> (Pair, Running, Modes) {
    let mut pair = Pair::connected(version);
    let request = MoveRequest::new(controller, generator);
    let motion = pair.begin(Program::Active(ActiveControl), request);
    assert_eq!(motion.first, None, "no command was written");
    (pair, motion, Modes::of(&request))
}

fn text<T: std::fmt::Debug, E: std::fmt::Display>(result: Result<T, E>) -> String {
    result.expect_err("it is refused").to_string()
}

const NO_CONTROLLER: &str =
    "libfranka robot: Trying to send control command, but no controller running!";
const PARTIAL: &str = "libfranka robot: Trying to send partial robot command!";

#[test]
fn scenario_4_robots_own_controller_refuses_torques() {
    for_each_version(|version| {
        for controller in [
            MoveControllerMode::JointImpedance,
            MoveControllerMode::CartesianImpedance,
        ] {
            let (mut pair, motion, modes) =
                active(version, controller, MoveGeneratorMode::JointPosition);
            assert_eq!(text(command(false, true).check(modes)), NO_CONTROLLER);
            assert_eq!(text(command(true, true).check(modes)), NO_CONTROLLER);
            assert_eq!(text(pair.write(command(false, true), false)), NO_CONTROLLER);
            assert_eq!(
                text(pair.write(command(true, true), false)),
                "Torques can only be commanded in kExternalController mode."
            );
            assert_eq!(
                text(pair.write(command(false, true), true)),
                "libfranka robot: Motion generator is still running! Can't stop external control"
            );

            let sent = pair.write(command(true, false), false).expect("it fits");
            assert_eq!(sent.message_id, pair.robot.state.message_id);
            assert_eq!((sent.q_c, sent.tau_J_d), (MOTION.0, [0.0; 7]));
            let last = pair.write(command(true, false), true).expect("it fits");
            assert!(last.motion_generation_finished);
            pair.succeed(&motion);
            assert_eq!(
                text(pair.write(command(true, false), false)),
                "writeOnce must not be called after the motion has finished."
            );
        }
    });
}

#[test]
fn scenario_4_a_command_of_another_kind_is_refused() {
    for_each_version(|version| {
        let (mut pair, ..) = active(
            version,
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::CartesianPosition,
        );
        let wrong = Command {
            motion: Some(JointVelocities([0.0; 7]).into()),
            torques: None,
        };
        assert_eq!(
            text(pair.write(wrong, false)),
            "Wrong writeOnce method called for currently active control!"
        );
    });
}

/// A motion command without its torques is refused with the text of `writeOnce`, which libfranka
/// checks first, too.
#[test]
fn scenario_5_a_generator_with_torques_needs_both_commands() {
    for_each_version(|version| {
        let (mut pair, motion, modes) = active(
            version,
            MoveControllerMode::ExternalController,
            MoveGeneratorMode::JointPosition,
        );
        assert_eq!(text(command(true, false).check(modes)), PARTIAL);
        assert_eq!(text(command(false, true).check(modes)), PARTIAL);
        assert_eq!(
            text(pair.write(command(true, false), false)),
            "Torque command missing, please use writeOnce(const MotionGeneratorType& \
             motion_generator_input, const Torques& control_input) for external controllers. \
             (here `write_motion_and_torques`)"
        );
        assert_eq!(text(pair.write(command(false, true), false)), PARTIAL);

        for _ in 0..2 {
            let sent = pair.write(command(true, true), false).expect("it fits");
            assert_eq!(sent.message_id, pair.robot.state.message_id);
            assert_eq!((sent.q_c, sent.tau_J_d), (MOTION.0, TORQUES.0));
            assert!(!sent.motion_generation_finished && !sent.torque_command_finished);
            assert_eq!(pair.step(), None);
        }
        let last = pair.write(command(true, true), true).expect("it fits");
        assert!(last.motion_generation_finished && !last.torque_command_finished);
        pair.succeed(&motion);
    });
}

#[test]
fn scenario_6_torques_alone() {
    let version = Version::V10;
    let (mut pair, motion, modes) = active(
        version,
        MoveControllerMode::ExternalController,
        MoveGeneratorMode::None,
    );
    assert!(!modes.has_generator() && modes.is_external());
    assert_eq!(
        text(pair.write(command(true, false), false)),
        "libfranka robot: Trying to send motion command, but no motion generator running!"
    );
    assert_eq!(
        pair.write(command(true, true), false),
        Err(WriteError::Misfit(Misfit::NoGenerator))
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut torques = [0.0; 7];
        torques[6] = bad;
        let torques = Command::torques(version, Torques(torques));
        assert_eq!(
            text(pair.write(torques, false)),
            "Commanding value is infinite or NaN."
        );
    }
    let sent = pair.write(command(false, true), false).expect("it fits");
    assert_eq!(sent.message_id, pair.robot.state.message_id);
    assert_eq!(sent.tau_J_d, TORQUES.0);
    let last = pair.write(command(false, true), true).expect("it fits");
    assert!(last.torque_command_finished && !last.motion_generation_finished);
    pair.succeed(&motion);
}

/// Protocol 5 has no such motion: it cannot be requested, and torques run together with a generator
/// at rest.
#[test]
fn scenario_6_lone_torques_run_with_a_still_generator() {
    let version = Version::V5;
    let alone = MoveRequest::new(
        MoveControllerMode::ExternalController,
        MoveGeneratorMode::None,
    );
    assert!(matches!(
        sent_by_a_session(version, alone),
        Err(RequestError::Unsupported { .. })
    ));

    let (mut pair, motion, modes) = active(
        version,
        MoveControllerMode::ExternalController,
        version.torque_generator(),
    );
    assert!(modes.has_generator() && modes.is_external());
    let sent = pair.write(Command::torques(version, TORQUES), false);
    let sent = sent.expect("it fits");
    assert_eq!((sent.dq_c, sent.tau_J_d), ([0.0; 7], TORQUES.0));
    let last = pair.write(Command::torques(version, TORQUES), true);
    assert!(last.expect("it fits").motion_generation_finished);
    pair.succeed(&motion);
}

/// Returns Ok if a connected session of this version sends `request`.
fn sent_by_a_session(version: Version, request: MoveRequest) -> Result<(), RequestError> {
    let mut session = client::Session::new(version);
    let hello = session.connect(40_000);
    let message = next_message(hello.as_bytes()).expect("well-formed");
    let event = server::Session::new(version).on_message(message.expect("whole"));
    let Ok(server::Event::Connect { reply, .. }) = event else {
        panic!("{event:?}")
    };
    let message = next_message(reply.as_bytes()).expect("well-formed");
    let connected = session.on_message(message.expect("whole"));
    assert!(matches!(connected, Ok(client::Event::Connected { .. })));
    session.request(&Request::Move(request)).map(drop)
}
