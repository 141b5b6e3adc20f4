//! The client and the device of both end-effector protocols, in one thread.

use franka_proto::framing::{FrameError, MAX_REQUEST_SIZE};
use franka_proto::{
    CommandId, DecodeError, IncompatibleVersion, Outgoing, Protocol, ReplyError, RequestError,
    Violation, client, gripper, server, vacuum,
};
use gripper::{Reply, Status, next_message};

struct Pair<P: Protocol> {
    client: client::Session<P>,
    device: server::Session<P>,
}

impl<P> Pair<P>
where
    P: for<'a> Protocol<Reply<'a> = Reply>,
{
    fn connected(version: P) -> Self {
        let mut pair = Self {
            client: client::Session::new(version),
            device: server::Session::new(version),
        };
        let hello = pair.client.connect(4711);
        let Ok(server::Event::Connect {
            udp_port, reply, ..
        }) = pair.deliver(&hello)
        else {
            panic!("the handshake fails");
        };
        assert_eq!(udp_port, 4711);
        let event = pair.receive(reply.as_bytes()).unwrap();
        assert_eq!(event, client::Event::Connected { version });
        pair
    }

    fn deliver(&mut self, outgoing: &Outgoing) -> Result<server::Event<P>, Violation<P::Command>> {
        let message = next_message(outgoing.as_bytes()).unwrap().unwrap();
        self.device.on_message(message)
    }

    fn receive<'a>(
        &mut self,
        bytes: &'a [u8],
    ) -> Result<client::Event<'a, P>, Violation<P::Command>> {
        let message = next_message(bytes).unwrap().unwrap();
        assert_eq!(message.size(), bytes.len());
        self.client.on_message(message)
    }

    /// Sends a request and checks that the device decodes the same request.
    fn request(&mut self, request: P::Request) -> CommandId {
        let outgoing = self.client.request(&request).unwrap();
        let id = outgoing.id();
        let event = self.deliver(&outgoing).unwrap();
        assert_eq!(event, server::Event::Request { id, request });
        id
    }

    /// Answers a request and checks that the client decodes the same reply.
    fn reply(&mut self, id: CommandId, status: Status) {
        let outgoing = self.device.reply(id, Reply::Done(status)).unwrap();
        match self.receive(outgoing.as_bytes()).unwrap() {
            client::Event::Reply {
                id: got_id, reply, ..
            } => assert_eq!((got_id, reply), (id, Reply::Done(status))),
            event => panic!("{event:?}"),
        }
    }
}

fn hand() -> Pair<gripper::Version> {
    Pair::connected(gripper::Version::V3)
}

fn suction() -> Pair<vacuum::Version> {
    Pair::connected(vacuum::Version::V1)
}

#[test]
fn a_stop_overtakes_the_grasp_that_it_ends() {
    let mut pair = hand();
    let grasp = pair.request(gripper::Request::Grasp(gripper::Grasp::new(
        0.02, 0.1, 40.0,
    )));
    let stop = pair.request(gripper::Request::Stop);
    assert_ne!(grasp, stop);
    assert_eq!(pair.client.pending(), 2);
    pair.reply(stop, Status::Success);
    pair.reply(grasp, Status::Aborted);
    assert_eq!(pair.client.pending(), 0);
    // Each request has one reply: a second reply is refused.
    let again = pair.device.reply(grasp, Reply::Done(Status::Success));
    assert_eq!(
        again.unwrap_err(),
        ReplyError::<gripper::Command>::NotPending { id: grasp }
    );
}

#[test]
fn every_request_of_the_hand_comes_back_value_for_value() {
    let mut pair = hand();
    let (width, speed) = (0.04, 0.1);
    for request in [
        gripper::Request::Homing,
        gripper::Request::Move(gripper::Move { width, speed }),
        gripper::Request::Grasp(gripper::Grasp {
            epsilon_inner: 0.001,
            epsilon_outer: 0.002,
            ..gripper::Grasp::new(width, speed, 20.0)
        }),
        gripper::Request::Stop,
    ] {
        let id = pair.request(request);
        pair.reply(id, Status::Unsuccessful);
    }
}

#[test]
fn vacuum_gripper_requests_round_trip_value_for_value() {
    let mut pair = suction();
    for profile in 0..4 {
        let id = pair.request(vacuum::Request::Vacuum(vacuum::Vacuum {
            vacuum: 60,
            profile: vacuum::Profile::from_byte(profile).unwrap(),
            timeout: -1,
        }));
        pair.reply(id, Status::Fail);
    }
    let undefined = vacuum::Profile::from_byte(4).unwrap_err();
    assert_eq!(
        undefined.to_string(),
        "Vacuum Gripper: Vacuum profile not defined!"
    );
    pair.request(vacuum::Request::DropOff { timeout: i64::MAX });
    pair.request(vacuum::Request::Stop);
    assert_eq!(pair.client.pending(), 2);
}

#[test]
fn a_status_is_libfrankas_answer() {
    let grasp = gripper::Command::Grasp;
    assert_eq!(Status::Success.result(grasp), Ok(true));
    assert_eq!(Status::Unsuccessful.result(grasp), Ok(false));
    let text = |status: Status| status.result(grasp).unwrap_err().to_string();
    assert_eq!(text(Status::Fail), "libfranka gripper: Command failed!");
    assert_eq!(text(Status::Aborted), "libfranka gripper: Command aborted!");
    let text = |status: Status| status.result(vacuum::Command::Vacuum).unwrap_err();
    assert_eq!(
        text(Status::Fail).to_string(),
        "libfranka vacuum gripper: Command failed!"
    );
    assert_eq!(
        text(Status::Aborted).to_string(),
        "libfranka vacuum gripper: Command aborted!"
    );
}

#[test]
fn an_unknown_status_ends_its_request_with_libfrankas_text() {
    let mut pair = hand();
    let id = pair.request(gripper::Request::Homing);
    let error = pair
        .receive(&[1, 0, 1, 0, 0, 0, 12, 0, 0, 0, 4, 0])
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "libfranka gripper: Unexpected response while handling command!"
    );
    assert_eq!((error.id(), error.is_fatal()), (Some(id), false));
    assert_eq!(pair.client.pending(), 0);

    let mut pair = suction();
    pair.request(vacuum::Request::Stop);
    let error = pair
        .receive(&[3, 0, 1, 0, 0, 0, 12, 0, 0, 0, 0, 1])
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "libfranka vacuum gripper: Unexpected response while handling command!"
    );
}

#[test]
fn short_reply_tells_got_and_expected_size() {
    let mut pair = hand();
    let id = pair.request(gripper::Request::Homing);
    let error = pair.receive(&[1, 0, 1, 0, 0, 0, 11, 0, 0, 0, 0]);
    let (got, expected) = (11, 12);
    let error_expected = DecodeError::MessageSize { got, expected };
    let violation = Violation::Reply {
        id,
        error: error_expected,
    };
    assert_eq!(error, Err(violation));
}

#[test]
fn an_unknown_profile_fails_and_the_session_goes_on() {
    let mut pair = suction();
    let request = vacuum::Request::Vacuum(vacuum::Vacuum {
        vacuum: 10,
        profile: vacuum::Profile::P3,
        timeout: 1,
    });
    let outgoing = pair.client.request(&request).unwrap();
    let mut bytes = outgoing.as_bytes().to_vec();
    bytes[11] = 4;
    let message = next_message(&bytes).unwrap().unwrap();
    let Ok(server::Event::Rejected { error, reply, .. }) = pair.device.on_message(message) else {
        panic!("it is not rejected");
    };
    assert_eq!(error.to_string(), "profile 4 is not defined");
    let event = pair.receive(reply.as_bytes()).unwrap();
    let reply = Reply::Done(Status::Fail);
    let command = vacuum::Command::Vacuum;
    let id = outgoing.id();
    assert_eq!(event, client::Event::Reply { id, command, reply });
    pair.request(vacuum::Request::Stop);
}

#[test]
fn another_version_is_told() {
    let mut device = gripper::Server::new(gripper::Version::V3);
    let mut client = gripper::Client::new(gripper::Version::V3);
    let mut hello = client.connect(1).as_bytes().to_vec();
    hello[10] = 2;
    let event = device.on_message(next_message(&hello).unwrap().unwrap());
    assert!(matches!(
        event,
        Ok(server::Event::Incompatible { version: 2, .. })
    ));
    // The device now has version 2.
    let reply = [0, 0, 0, 0, 0, 0, 14, 0, 0, 0, 1, 0, 2, 0];
    let event = client.on_message(next_message(&reply).unwrap().unwrap());
    let incompatible = IncompatibleVersion {
        server_version: 2,
        library_version: gripper::Version::V3,
    };
    assert_eq!(event, Ok(client::Event::Incompatible(incompatible)));
    assert!(!client.is_connected() && !device.is_connected());
}

#[test]
fn protocol_violation_is_reported() {
    let mut client = gripper::Client::new(gripper::Version::V3);
    let error = client.request(&gripper::Request::Homing).unwrap_err();
    assert_eq!(error, RequestError::NotConnected);

    let mut pair = hand();
    let hello = gripper::Client::new(gripper::Version::V3).connect(1);
    assert_eq!(pair.deliver(&hello), Err(Violation::SecondConnect));
    let unknown = [5, 0, 9, 0, 0, 0, 10, 0, 0, 0];
    let message = next_message(&unknown).unwrap().unwrap();
    let error = pair.device.on_message(message).unwrap_err();
    assert_eq!(error.to_string(), "protocol 3 has no command 5");
    assert!(error.is_fatal());

    let mut device = vacuum::Server::new(vacuum::Version::V1);
    let stop = [3, 0, 0, 0, 0, 0, 10, 0, 0, 0];
    let error = device.on_message(next_message(&stop).unwrap().unwrap());
    assert_eq!(
        error.unwrap_err().to_string(),
        "the first message is Stop, expected Connect"
    );
}

#[test]
fn a_message_is_cut_at_its_ten_byte_header_and_bounded() {
    let mut bytes = vec![4, 0, 7, 0, 0, 0, 12, 0, 0, 0, 1];
    assert_eq!(next_message(&bytes), Ok(None));
    bytes.extend([2, 3]);
    let message = next_message(&bytes).unwrap().unwrap();
    assert_eq!((message.size(), message.payload), (12, &[1, 2][..]));
    assert_eq!((message.header.command, message.header.command_id), (4, 7));
    bytes[6] = 9;
    assert_eq!(next_message(&bytes), Err(FrameError::TooShort { got: 9 }));
    bytes[8] = 1;
    let (got, limit) = (65536 + 9, MAX_REQUEST_SIZE);
    assert_eq!(
        next_message(&bytes),
        Err(FrameError::TooLong { got, limit })
    );
}
