//! Properties that hold for any bytes, one function per fuzz target.
//!
//! The targets in `fuzz/` and the test in `mod.rs` call the same functions. A finding is a panic of
//! the crate, or a failed assertion in this file.
// The items are public in the library of `fuzz/`, which also compiles this file.
#![allow(unreachable_pub)]

use franka_proto::framing::{
    FrameError, MAX_REQUEST_SIZE, Message, next_message, next_message_within,
};
use franka_proto::{
    Architecture, CollisionBehavior, CommandId, Filters, MoveControllerMode, MoveGeneratorMode,
    MoveRequest, MoveStatus, Outgoing, Protocol, Reply, Request, RobotCommand, RobotState,
    SetterStatus, StopStatus, System, Version, client, gripper, server, vacuum,
};

/// A fuzz target: its name and its function.
pub type Target = (&'static str, fn(&[u8]));

/// All targets. The binaries in `fuzz/fuzz_targets/` have the same names.
pub const TARGETS: [Target; 7] = [
    ("stream", stream),
    ("robot_state", robot_state),
    ("robot_command", robot_command),
    ("client_replies", client_replies),
    ("server_requests", server_requests),
    ("gripper", gripper),
    ("vacuum", vacuum),
];

type Cut = fn(&[u8]) -> Result<Option<Message<'_>>, FrameError>;

fn next_request(received: &[u8]) -> Result<Option<Message<'_>>, FrameError> {
    next_message_within(received, MAX_REQUEST_SIZE)
}

/// Cuts a stream into messages, with both headers.
pub fn stream(bytes: &[u8]) {
    for (cut, header) in [(next_message as Cut, 12), (gripper::next_message, 10)] {
        let mut rest = bytes;
        while let Ok(Some(message)) = cut(rest) {
            assert_eq!(message.size(), header + message.payload.len());
            assert_eq!(&rest[header..message.size()], message.payload);
            // Without its last byte, the message is incomplete.
            assert_eq!(cut(&rest[..message.size() - 1]), Ok(None));
            rest = &rest[message.size()..];
        }
    }
}

/// Decodes the bytes as a state of every version, and encodes the state again.
pub fn robot_state(bytes: &[u8]) {
    for version in Version::ALL {
        let state = RobotState::decode(version, bytes);
        assert_eq!(state.is_ok(), bytes.len() >= version.state_size());
        let Ok(state) = state else { continue };
        let _ = state.total_load(version);
        // Decoding may lose bits (a flag of 7 becomes true), but a second pass loses no more.
        let write = |state: &RobotState| {
            let mut bytes = [0; RobotState::MAX_SIZE];
            state.encode(version, &mut bytes).expect("it was read");
            bytes
        };
        let once = write(&state);
        let again = RobotState::decode(version, &once).expect("it is long enough");
        assert_eq!(write(&again), once);
    }
}

/// Decodes the bytes as a command of every version, and encodes the command again.
pub fn robot_command(bytes: &[u8]) {
    for version in Version::ALL {
        let command = RobotCommand::decode(version, bytes);
        assert_eq!(command.is_ok(), bytes.len() >= version.command_size());
        let Ok(command) = command else { continue };
        let write = |command: &RobotCommand| {
            let mut bytes = [0; RobotCommand::MAX_SIZE];
            command.encode(version, &mut bytes).expect("it was read");
            bytes
        };
        let once = write(&command);
        let again = RobotCommand::decode(version, &once).expect("it is long enough");
        assert_eq!(write(&again), once);
    }
}

/// Feeds a stream of replies to a client of the robot. The first byte chooses the version.
pub fn client_replies(bytes: &[u8]) {
    let Some((&version, stream)) = bytes.split_first() else {
        return;
    };
    let version = Version::ALL[usize::from(version) % Version::ALL.len()];
    client(version, &requests(version), next_message, stream);
}

/// Feeds a stream of requests to a robot. The first byte chooses the version.
pub fn server_requests(bytes: &[u8]) {
    let Some((&version, stream)) = bytes.split_first() else {
        return;
    };
    let version = Version::ALL[usize::from(version) % Version::ALL.len()];
    let replies = [
        Reply::Move(MoveStatus::MotionStarted),
        Reply::Move(MoveStatus::Success),
        Reply::StopMove(StopStatus::Success),
        Reply::Setter(SetterStatus::Success),
    ];
    device(version, &replies, next_request, stream);
}

/// Feeds the bytes to a client of a Hand, to a Hand, and to the decoder of its states.
pub fn gripper(bytes: &[u8]) {
    let state = gripper::State::decode(bytes);
    assert_eq!(state.is_ok(), bytes.len() >= gripper::State::SIZE);
    if let Ok(state) = state {
        let once = state.encode();
        let again = gripper::State::decode(&once).expect("it is long enough");
        assert_eq!(again.encode(), once);
    }
    let requests = [
        gripper::Request::Homing,
        gripper::Request::Grasp(gripper::Grasp::new(0.02, 0.1, 10.0)),
        gripper::Request::Stop,
    ];
    let version = gripper::Version::V3;
    client(version, &requests, gripper::next_message, bytes);
    device(version, &DONE, gripper::next_message, bytes);
}

/// Feeds the bytes to a client of a vacuum gripper, to a vacuum gripper, and to the decoder of its
/// states.
pub fn vacuum(bytes: &[u8]) {
    let state = vacuum::State::decode(bytes);
    assert_eq!(state.is_ok(), bytes.len() >= vacuum::State::SIZE);
    if let Ok(state) = state {
        assert_eq!(vacuum::State::decode(&state.encode()), Ok(state));
    }
    let requests = [
        vacuum::Request::DropOff { timeout: 10 },
        vacuum::Request::Stop,
    ];
    let version = vacuum::Version::V1;
    client(version, &requests, vacuum::next_message, bytes);
    device(version, &DONE, vacuum::next_message, bytes);
}

const DONE: [gripper::Reply; 1] = [gripper::Reply::Done(gripper::Status::Unsuccessful)];

/// Returns one request of every kind that the version has.
fn requests(version: Version) -> Vec<Request> {
    let (torque, force) = ([1.0; 7], [1.0; 6]);
    let thresholds = CollisionBehavior::uniform(torque, torque, force, force);
    let mut requests = vec![
        Request::Move(MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )),
        Request::StopMove,
        Request::SetCollisionBehavior(thresholds),
        Request::AutomaticErrorRecovery,
        Request::GetRobotModel,
        Request::GetCartesianLimit { id: 1 },
        Request::SetFilters(Filters::uniform(100.0)),
        Request::LoadModelLibrary {
            architecture: Architecture::X64,
            system: System::Linux,
        },
    ];
    requests.retain(|request| version.supports(request.command()));
    requests
}

/// Returns a client and a device after the handshake.
fn connected<P: Protocol>(version: P, cut: Cut) -> (client::Session<P>, server::Session<P>) {
    let mut client = client::Session::new(version);
    let mut device = server::Session::new(version);
    let hello = client.connect(1);
    let event = device.on_message(whole(cut, &hello)).expect("a handshake");
    let server::Event::Connect { reply, .. } = event else {
        panic!("{event:?}");
    };
    client.on_message(whole(cut, &reply)).expect("a handshake");
    (client, device)
}

fn whole(cut: Cut, outgoing: &Outgoing) -> Message<'_> {
    let message = cut(outgoing.as_bytes()).expect("well-formed");
    message.expect("sent whole")
}

/// Feeds the stream to a client that waits for its handshake, and to a client that waits for
/// answers to `requests`.
fn client<P: Protocol>(version: P, requests: &[P::Request], cut: Cut, stream: &[u8]) {
    let mut connecting = client::Session::new(version);
    connecting.connect(1);
    let (mut open, _) = connected(version, cut);
    for request in requests {
        open.request(request).expect("the version has it");
    }
    for mut session in [connecting, open] {
        let mut rest = stream;
        while let Ok(Some(message)) = cut(rest) {
            let before = session.pending();
            let event = session.on_message(message);
            assert!(session.pending() <= before);
            if event.is_err_and(|violation| violation.is_fatal()) {
                break;
            }
            rest = &rest[message.size()..];
        }
    }
}

/// Feeds the stream to a device before its handshake, and to a device after its handshake. Every
/// request is answered with each of `replies`, matching or not.
fn device<P: Protocol>(version: P, replies: &[P::Reply<'_>], cut: Cut, stream: &[u8]) {
    let (_, open) = connected(version, cut);
    for mut session in [server::Session::new(version), open] {
        let mut rest = stream;
        while let Ok(Some(message)) = cut(rest) {
            match session.on_message(message) {
                Ok(server::Event::Request { id, request }) => {
                    assert_eq!(id, message.header.id());
                    comes_back(version, &request, id, cut);
                    for &reply in replies {
                        let _ = session.reply(id, reply);
                    }
                }
                Ok(_) => {}
                Err(violation) => {
                    assert!(violation.is_fatal());
                    break;
                }
            }
            rest = &rest[message.size()..];
        }
    }
}

/// Checks that a decoded request can be encoded, and that a second round trip yields the same
/// bytes. The test cannot compare values, because some are NaN.
fn comes_back<P: Protocol>(version: P, request: &P::Request, id: CommandId, cut: Cut) {
    let once = version.encode_request(request, id).expect("it was read");
    let again = version.decode_request(&whole(cut, &once));
    let again = again.expect("it was written");
    assert_eq!(version.encode_request(&again, id), Ok(once));
}
