//! A client session and a server session in one thread: every message goes through its bytes.

use franka_proto::framing::{MAX_REQUEST_SIZE, Message, next_message, next_message_within};
use franka_proto::{
    Architecture, Command, CommandId, ConnectStatus, DecodeError, Filters, IncompatibleVersion,
    LibraryStatus, ModelStatus, MoveControllerMode, MoveGeneratorMode, MoveRequest, MoveStatus,
    Outgoing, RecoveryStatus, Refusal, Reply, ReplyError, Request, RequestError, RobotMode,
    SetterStatus, StopStatus, System, Version, Violation, VirtualWall, client, server,
};

struct Pair {
    client: client::Session,
    server: server::Session,
}

impl Pair {
    /// Both sides of the same version, with the handshake done.
    fn connected(version: Version) -> Self {
        let mut pair = Self::new(version, version);
        let hello = pair.client.connect(4711);
        let event = pair.deliver(&hello).unwrap();
        let server::Event::Connect {
            id,
            udp_port,
            reply,
        } = event
        else {
            panic!("{event:?}");
        };
        assert_eq!((id, udp_port), (CommandId(0), 4711));
        let event = pair.client.on_message(message(&reply)).unwrap();
        assert_eq!(event, client::Event::Connected { version });
        assert!(pair.client.is_connected() && pair.server.is_connected());
        pair
    }

    fn new(client: Version, server: Version) -> Self {
        Self {
            client: client::Session::new(client),
            server: server::Session::new(server),
        }
    }

    fn deliver(&mut self, outgoing: &Outgoing) -> Result<server::Event, Violation> {
        let received = next_message_within(outgoing.as_bytes(), MAX_REQUEST_SIZE);
        self.server.on_message(received.unwrap().unwrap())
    }

    /// Sends a request and checks that the robot reads the same.
    fn request(&mut self, request: &Request) -> CommandId {
        let outgoing = self.client.request(request).unwrap();
        let id = outgoing.id();
        let event = self.deliver(&outgoing).unwrap();
        let request = *request;
        assert_eq!(event, server::Event::Request { id, request });
        id
    }

    /// Answers a request and checks that the client reads the same.
    fn reply(&mut self, id: CommandId, reply: Reply<'_>) {
        let outgoing = self.server.reply(id, reply).unwrap();
        match self.client.on_message(message(&outgoing)).unwrap() {
            client::Event::Reply {
                id: got_id,
                reply: got,
                ..
            } => assert_eq!((got_id, got), (id, reply)),
            event => panic!("{event:?}"),
        }
    }
}

fn message(outgoing: &Outgoing) -> Message<'_> {
    let message = next_message(outgoing.as_bytes()).unwrap().unwrap();
    assert_eq!(message.size(), outgoing.as_bytes().len());
    message
}

fn joint_motion() -> Request {
    Request::Move(MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointPosition,
    ))
}

/// A reply of the robot as bytes, without a session that would refuse to make it.
fn raw_reply(id: u32, payload: &[u8]) -> Vec<u8> {
    let size = 12 + payload.len() as u32;
    let mut bytes: Vec<u8> = [1, id, size].iter().flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend(payload);
    bytes
}

#[test]
fn a_motion_is_answered_twice_under_one_id() {
    for version in Version::ALL {
        let mut pair = Pair::connected(version);
        let id = pair.request(&joint_motion());
        assert_eq!(id, CommandId(1));
        pair.reply(id, Reply::Move(MoveStatus::MotionStarted));
        assert_eq!(pair.client.pending(), 1);
        pair.reply(id, Reply::Move(MoveStatus::Success));
        assert_eq!(pair.client.pending(), 0);
        let error = pair.server.reply(id, Reply::Move(MoveStatus::Success));
        assert_eq!(error.unwrap_err(), ReplyError::NotPending { id });
    }
}

#[test]
fn a_stop_and_the_motion_it_ends_are_answered_in_any_order() {
    for version in Version::ALL {
        for stop_first in [false, true] {
            let mut pair = Pair::connected(version);
            let motion = pair.request(&joint_motion());
            pair.reply(motion, Reply::Move(MoveStatus::MotionStarted));
            let stop = pair.request(&Request::StopMove);
            let replies = [
                (motion, Reply::Move(MoveStatus::Preempted)),
                (stop, Reply::StopMove(StopStatus::Success)),
            ];
            let order = if stop_first { [1, 0] } else { [0, 1] };
            for index in order {
                let (id, reply) = replies[index];
                pair.reply(id, reply);
            }
            assert_eq!(pair.client.pending(), 0);
        }
    }
}

#[test]
fn a_motion_refused_at_once_has_one_answer() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&joint_motion());
    let reply = Reply::Move(MoveStatus::CommandNotPossibleRejected);
    pair.reply(id, reply);
    assert_eq!(pair.client.pending(), 0);
    let refusal = Refusal::from_reply(Command::Move, &reply, RobotMode::Reflex).unwrap();
    assert_eq!(
        refusal.to_string(),
        r#"libfranka: Move command rejected: command not possible in the current mode ("Reflex")!"#
    );
}

#[test]
fn setters_and_recovery_work_in_every_version() {
    for version in Version::ALL {
        let mut pair = Pair::connected(version);
        let setters = [
            Request::SetJointImpedance([3000.0; 7]),
            Request::SetCartesianImpedance([300.0; 6]),
            Request::SetEEToK([1.0; 16]),
            Request::SetNEToEE([2.0; 16]),
            Request::SetGuidingMode {
                guiding_mode: [true, false, true, true, false, false],
                nullspace: true,
            },
        ];
        // All are open at once, and the answers come in reverse.
        let ids: Vec<_> = setters.iter().map(|setter| pair.request(setter)).collect();
        for id in ids.into_iter().rev() {
            pair.reply(id, Reply::Setter(SetterStatus::InvalidArgumentRejected));
        }
        let id = pair.request(&Request::AutomaticErrorRecovery);
        pair.reply(id, Reply::Recovery(RecoveryStatus::EmergencyAborted));
    }
}

#[test]
fn a_model_comes_whole_and_its_text_is_sent_behind_the_header() {
    let urdf = "<robot name=\"fr3\"/>".repeat(3000);
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::GetRobotModel);
    let header = pair.server.model_header(id, urdf.len()).unwrap();
    let mut stream = header.as_bytes().to_vec();
    assert_eq!(next_message(&stream), Ok(None));
    stream.extend(urdf.as_bytes());
    let message = next_message(&stream).unwrap().unwrap();
    let event = pair.client.on_message(message).unwrap();
    let expected = client::Event::Reply {
        id,
        command: Command::GetRobotModel,
        reply: Reply::Model {
            status: ModelStatus::Success,
            text: urdf.as_bytes(),
        },
    };
    assert_eq!(event, expected);
}

#[test]
fn a_model_text_never_goes_into_the_fixed_buffer() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::GetRobotModel);
    let (status, text) = (ModelStatus::Success, &b"<robot/>"[..]);
    let error = pair.server.reply(id, Reply::Model { status, text });
    assert_eq!(error.unwrap_err(), ReplyError::TextLength { len: 8 });
    let error = pair.server.model_header(id, usize::MAX).unwrap_err();
    assert_eq!(error, ReplyError::TextLength { len: usize::MAX });
    assert!(pair.server.model_header(id, 8).is_ok());
}

#[test]
fn another_version_is_told_and_can_be_followed() {
    let mut pair = Pair::new(Version::V10, Version::V5);
    let hello = pair.client.connect(1);
    let event = pair.deliver(&hello).unwrap();
    let server::Event::Incompatible { version, reply } = event else {
        panic!("{event:?}");
    };
    assert_eq!(version, 10);
    let event = pair.client.on_message(message(&reply)).unwrap();
    let incompatible = IncompatibleVersion {
        server_version: 5,
        library_version: Version::V10,
    };
    assert_eq!(event, client::Event::Incompatible(incompatible));
    assert!(!pair.client.is_connected() && !pair.server.is_connected());
    // A fresh connection with the robot's version.
    let version = Version::from_number(incompatible.server_version).unwrap();
    Pair::connected(version);
}

#[test]
fn a_robot_that_accepts_and_reports_another_version_is_a_violation() {
    let mut client = client::Session::new(Version::V10);
    client.connect(1);
    let bytes = raw_reply(0, &[0, 5, 0]);
    let error = client.on_message(next_message(&bytes).unwrap().unwrap());
    let expected = Violation::ForeignVersion {
        announced: 10,
        reported: 5,
    };
    assert_eq!(error, Err(expected));
    assert!(!client.is_connected());

    client.connect(1);
    let bytes = raw_reply(0, &[2, 10, 0]);
    let error = client.on_message(next_message(&bytes).unwrap().unwrap());
    assert_eq!(
        error.unwrap_err().to_string(),
        "libfranka: Protocol error during connection attempt"
    );
}

#[test]
fn requests_before_the_handshake_are_refused_on_both_sides() {
    let mut client = client::Session::new(Version::V10);
    let error = client.request(&Request::StopMove).unwrap_err();
    assert_eq!(error, RequestError::NotConnected);

    let stop = Request::StopMove
        .encode(Version::V10, CommandId(0))
        .unwrap();
    let mut pair = Pair::new(Version::V10, Version::V10);
    let got = Command::StopMove;
    assert_eq!(pair.deliver(&stop), Err(Violation::NotConnect { got }));
}

#[test]
fn what_a_version_lacks_is_refused_before_a_byte_is_made() {
    let mut pair = Pair::connected(Version::V5);
    let torques = Request::Move(MoveRequest::new(
        MoveControllerMode::ExternalController,
        MoveGeneratorMode::None,
    ));
    let mut asynchronous = MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointPosition,
    );
    asynchronous.asynchronous = Some([1.0; 7]);
    for request in [Request::GetRobotModel, torques, Request::Move(asynchronous)] {
        let error = pair.client.request(&request).unwrap_err();
        assert!(
            matches!(error, RequestError::Unsupported { version, .. } if version == Version::V5),
            "{error:?}"
        );
    }
    assert_eq!(pair.client.pending(), 0);
    // No id is lost.
    assert_eq!(pair.request(&Request::StopMove), CommandId(1));

    let mut pair = Pair::connected(Version::V10);
    for (request, name) in [
        (Request::GetCartesianLimit { id: 1 }, "Get Cartesian Limit"),
        (Request::SetFilters(Filters::uniform(1000.0)), "Set Filters"),
        (library(), "Load Model Library"),
    ] {
        let error = pair.client.request(&request).unwrap_err();
        let expected = format!("protocol 10 (Franka Research 3) has no {name}");
        assert_eq!(error.to_string(), expected);
    }
    assert_eq!(pair.request(&Request::StopMove), CommandId(1));
}

fn library() -> Request {
    Request::LoadModelLibrary {
        architecture: Architecture::Arm64,
        system: System::Linux,
    }
}

#[test]
fn walls_filters_and_libraries_exist_in_protocol_5() {
    let mut pair = Pair::connected(Version::V5);
    let filters = pair.request(&Request::SetFilters(Filters::uniform(100.0)));
    let limit = pair.request(&Request::GetCartesianLimit { id: -3 });
    let wall = VirtualWall {
        object_world_size: [1.0, 2.0, 3.0],
        object_frame: [0.5; 16],
        object_activation: true,
    };
    let status = SetterStatus::Success;
    pair.reply(limit, Reply::CartesianLimit { status, wall });
    pair.reply(filters, Reply::Setter(SetterStatus::Success));

    let id = pair.request(&library());
    let reply = Reply::ModelLibrary {
        status: LibraryStatus::Error,
        library: &[],
    };
    pair.reply(id, reply);
    let refusal = Refusal::from_reply(Command::LoadModelLibrary, &reply, RobotMode::Idle);
    assert!(refusal.is_some());

    let id = pair.request(&library());
    let file = [0x7f; 5000];
    let header = pair.server.library_header(id, file.len()).unwrap();
    let stream = [header.as_bytes(), &file].concat();
    let message = next_message(&stream).unwrap().unwrap();
    let event = pair.client.on_message(message).unwrap();
    let (status, library) = (LibraryStatus::Success, &file[..]);
    let expected = client::Event::Reply {
        id,
        command: Command::LoadModelLibrary,
        reply: Reply::ModelLibrary { status, library },
    };
    assert_eq!(event, expected);
}

#[test]
fn a_library_for_an_unknown_system_is_an_error_and_the_session_goes_on() {
    let mut pair = Pair::connected(Version::V5);
    let outgoing = pair.client.request(&library()).unwrap();
    let mut bytes = outgoing.as_bytes().to_vec();
    bytes[13] = 2;
    let event = pair
        .server
        .on_message(next_message(&bytes).unwrap().unwrap())
        .unwrap();
    let server::Event::Rejected { id, reply, .. } = event else {
        panic!("{event:?}");
    };
    let event = pair.client.on_message(message(&reply)).unwrap();
    let expected = Reply::ModelLibrary {
        status: LibraryStatus::Error,
        library: &[],
    };
    assert!(matches!(event, client::Event::Reply { reply, .. } if reply == expected));
    assert!(!pair.client.abandon(id));
    pair.request(&Request::StopMove);
}

#[test]
fn replies_that_nobody_waits_for_are_reported_and_change_nothing() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::StopMove);
    let bytes = raw_reply(99, &[0]);
    let event = pair
        .client
        .on_message(next_message(&bytes).unwrap().unwrap());
    let unmatched = |id| client::Event::Unmatched { id };
    assert_eq!(event, Ok(unmatched(CommandId(99))));
    assert_eq!(pair.client.pending(), 1);

    assert!(pair.client.abandon(id));
    assert!(!pair.client.abandon(id));
    let late = pair
        .server
        .reply(id, Reply::StopMove(StopStatus::Success))
        .unwrap();
    assert_eq!(pair.client.on_message(message(&late)), Ok(unmatched(id)));
}

#[test]
fn a_second_start_is_a_violation_and_the_motion_goes_on() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&joint_motion());
    pair.reply(id, Reply::Move(MoveStatus::MotionStarted));
    let again = pair
        .server
        .reply(id, Reply::Move(MoveStatus::MotionStarted));
    assert_eq!(again.unwrap_err(), ReplyError::AlreadyStarted { id });

    let bytes = raw_reply(id.0, &[1]);
    let error = pair
        .client
        .on_message(next_message(&bytes).unwrap().unwrap())
        .unwrap_err();
    assert_eq!(error, Violation::SecondMotionStarted { id });
    assert!(!error.is_fatal());
    assert_eq!(
        error.to_string(),
        "libfranka: Move received unexpected motion started message."
    );
    pair.reply(id, Reply::Move(MoveStatus::Success));
}

#[test]
fn an_unreadable_reply_ends_its_request_and_no_other() {
    let mut pair = Pair::connected(Version::V10);
    let motion = pair.request(&joint_motion());
    let setter = pair.request(&Request::SetLoad(Default::default()));
    let stop = pair.request(&Request::StopMove);

    let bytes = raw_reply(setter.0, &[77]);
    let error = pair
        .client
        .on_message(next_message(&bytes).unwrap().unwrap())
        .unwrap_err();
    assert_eq!((error.id(), error.is_fatal()), (Some(setter), false));
    assert_eq!(
        error.to_string(),
        "libfranka: Unexpected response while handling Set Load command!"
    );

    let bytes = raw_reply(motion.0, &[]);
    let error = pair
        .client
        .on_message(next_message(&bytes).unwrap().unwrap())
        .unwrap_err();
    let size = DecodeError::MessageSize {
        got: 12,
        expected: 13,
    };
    let expected = Violation::Reply {
        id: motion,
        error: size,
    };
    assert_eq!(error, expected);
    assert_eq!(error.to_string(), "libfranka: Incorrect TCP message size.");

    pair.reply(stop, Reply::StopMove(StopStatus::Success));
    assert_eq!(pair.client.pending(), 0);
}

#[test]
fn padded_replies_are_accepted() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::StopMove);
    let bytes = raw_reply(id.0, &[0, 0, 0, 0]);
    let event = pair
        .client
        .on_message(next_message(&bytes).unwrap().unwrap());
    assert!(
        matches!(event, Ok(client::Event::Reply { .. })),
        "{event:?}"
    );
}

#[test]
fn pending_requests_are_bounded_on_both_sides() {
    let limit = <client::Session>::PENDING_LIMIT;
    let mut pair = Pair::connected(Version::V10);
    for _ in 0..limit {
        pair.request(&Request::AutomaticErrorRecovery);
    }
    let error = pair.client.request(&Request::StopMove).unwrap_err();
    assert_eq!(error, RequestError::TooManyPending { limit });

    let id = CommandId(1000);
    let one_more = Request::StopMove.encode(Version::V10, id).unwrap();
    let limit = <server::Session>::PENDING_LIMIT;
    let error = pair.deliver(&one_more).unwrap_err();
    assert_eq!(error, Violation::TooManyPending { limit });
    // An answer makes room on both sides.
    pair.reply(CommandId(1), Reply::Recovery(RecoveryStatus::Success));
    pair.request(&Request::StopMove);
}

#[test]
fn a_move_with_an_unknown_mode_is_answered_as_an_invalid_argument() {
    for version in Version::ALL {
        let mut pair = Pair::connected(version);
        let outgoing = pair.client.request(&joint_motion()).unwrap();
        let mut bytes = outgoing.as_bytes().to_vec();
        bytes[16] = 9;
        let event = pair
            .server
            .on_message(next_message(&bytes).unwrap().unwrap())
            .unwrap();
        let server::Event::Rejected { id, error, reply } = event else {
            panic!("{event:?}");
        };
        let field = "motion_generator_mode";
        assert_eq!(error, DecodeError::UnknownValue { field, value: 9 });
        let event = pair.client.on_message(message(&reply)).unwrap();
        let expected = client::Event::Reply {
            id,
            command: Command::Move,
            reply: Reply::Move(MoveStatus::InvalidArgumentRejected),
        };
        assert_eq!(event, expected);
    }
}

#[test]
fn a_client_that_leaves_the_protocol_is_reported() {
    let mut pair = Pair::connected(Version::V10);
    let hello = client::Session::new(Version::V10).connect(1);
    assert_eq!(pair.deliver(&hello), Err(Violation::SecondConnect));

    let id = pair.request(&Request::StopMove);
    let again = Request::StopMove.encode(Version::V10, id).unwrap();
    assert_eq!(pair.deliver(&again), Err(Violation::RepeatedId { id }));

    let mut bytes = raw_reply(7, &[]);
    bytes[0] = 200;
    let error = pair
        .server
        .on_message(next_message(&bytes).unwrap().unwrap())
        .unwrap_err();
    assert!(error.is_fatal());
    assert_eq!(error.to_string(), "protocol 10 has no command 200");
}

#[test]
fn a_robot_answers_with_the_right_kind_of_reply_only() {
    let mut pair = Pair::connected(Version::V5);
    let id = pair.request(&Request::StopMove);
    let error = pair.server.reply(id, Reply::Setter(SetterStatus::Success));
    let command = Command::StopMove;
    assert_eq!(error.unwrap_err(), ReplyError::Mismatch { id, command });
    // Protocol 5 has no safety functions.
    let safety = StopStatus::CommandRejectedDueToActivatedSafetyFunctions;
    let error = pair.server.reply(id, Reply::StopMove(safety));
    let version = Version::V5;
    assert_eq!(error.unwrap_err(), ReplyError::Unsupported { version });
    pair.reply(id, Reply::StopMove(StopStatus::Success));
}

#[test]
fn connecting_again_starts_over() {
    let mut pair = Pair::connected(Version::V10);
    pair.request(&joint_motion());
    let hello = pair.client.connect(1);
    assert_eq!(hello.id(), CommandId(0));
    assert!(!pair.client.is_connected());
    let accepted = Reply::Connect {
        status: ConnectStatus::Success,
        version: 10,
    };
    assert!(accepted.suits(Command::Connect));
    let bytes = raw_reply(0, &[0, 10, 0]);
    let event = pair
        .client
        .on_message(next_message(&bytes).unwrap().unwrap());
    let version = Version::V10;
    assert_eq!(event, Ok(client::Event::Connected { version }));
    assert_eq!(pair.client.pending(), 0);
}
