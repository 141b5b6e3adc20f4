//! The Hand and the vacuum gripper. They are the same on both robots.

use franka_proto::gripper::{self, Grasp, Reply, Status, next_message};
use franka_proto::vacuum::{self, Profile, Vacuum};
use franka_proto::{Outgoing, Protocol, ServiceCommand, client, server};
use franka_record::cassette::Device;

use crate::tape::{Tape, recorded_and_replayed};

/// Two sessions after their handshake, and the messages between them.
struct Connection<P: Protocol> {
    client: client::Session<P>,
    device: server::Session<P>,
    tape: Tape,
}

impl<P: for<'a> Protocol<Reply<'a> = Reply>> Connection<P> {
    fn open(version: P, device: Device) -> Self {
        let mut this = Self {
            client: client::Session::new(version),
            device: server::Session::new(version),
            tape: Tape::new(device),
        };
        let hello = this.client.connect(40_000);
        let event = this.at_device(&hello);
        let server::Event::Connect {
            udp_port, reply, ..
        } = event
        else {
            panic!("{event:?}")
        };
        assert_eq!(udp_port, 40_000);
        let reply = this.tape.reply(reply.as_bytes().to_vec());
        let event = at_client(&mut this.client, &reply);
        assert!(matches!(event, client::Event::Connected { .. }));
        this
    }

    fn at_device(&mut self, sent: &Outgoing) -> server::Event<P> {
        self.tape.on_request(sent.as_bytes());
        let message = next_message(sent.as_bytes()).expect("well-formed");
        let event = self.device.on_message(message.expect("whole"));
        event.expect("the client keeps to the protocol")
    }

    /// The result of a request that the device answers with `status`.
    fn answered(&mut self, request: &P::Request, status: Status) -> Result<bool, String> {
        let sent = self.client.request(request).expect("the session takes it");
        let event = self.at_device(&sent);
        let server::Event::Request { id, request: got } = event else {
            panic!("{event:?}")
        };
        assert_eq!((id, &got), (sent.id(), request));
        let reply = self.device.reply(id, Reply::Done(status));
        let reply = reply.expect("it is being waited for");
        let reply = self.tape.reply(reply.as_bytes().to_vec());
        let event = at_client(&mut self.client, &reply);
        let client::Event::Reply {
            id: answered,
            command,
            reply: Reply::Done(status),
        } = event
        else {
            panic!("{event:?}")
        };
        assert_eq!(answered, id);
        assert_eq!(self.client.pending(), 0);
        status
            .result(command)
            .map_err(|failure| failure.to_string())
    }

    fn check(version: P, device: Device, requests: &[P::Request]) {
        recorded_and_replayed(|| Self::open(version, device).check_all(requests));
    }

    fn check_all(mut self, requests: &[P::Request]) {
        let service = P::Command::SERVICE;
        for request in requests {
            for (status, expected) in [
                (Status::Success, Ok(true)),
                (Status::Unsuccessful, Ok(false)),
                (Status::Fail, Err(format!("{service}: Command failed!"))),
                (Status::Aborted, Err(format!("{service}: Command aborted!"))),
            ] {
                let result = self.answered(request, status);
                assert_eq!(result, expected, "{request:?}");
            }
        }
    }
}

fn at_client<'a, P: Protocol>(
    client: &mut client::Session<P>,
    sent: &'a [u8],
) -> client::Event<'a, P> {
    let message = next_message(sent).expect("well-formed");
    let event = client.on_message(message.expect("whole"));
    event.expect("the device keeps to the protocol")
}

/// `tests/live/hands.rs` tests the same of the async client, over sockets, and also an unknown
/// status.
#[test]
fn scenario_18_every_answer_to_every_command_of_the_hand() {
    assert_eq!(gripper::Command::SERVICE, "libfranka gripper");
    Connection::check(
        gripper::Version::V3,
        Device::Hand,
        &[
            gripper::Request::Homing,
            gripper::Request::Grasp(Grasp::new(0.05, 0.1, 20.0)),
            gripper::Request::Move(gripper::Move {
                width: 0.04,
                speed: 0.1,
            }),
            gripper::Request::Stop,
        ],
    );
}

#[test]
fn scenario_18_vacuum_gripper_answers_are_all_handled() {
    assert_eq!(vacuum::Command::SERVICE, "libfranka vacuum gripper");
    Connection::check(
        vacuum::Version::V1,
        Device::VacuumGripper,
        &[
            vacuum::Request::Vacuum(Vacuum {
                vacuum: 50,
                profile: Profile::P3,
                timeout: 1000,
            }),
            vacuum::Request::DropOff { timeout: 1000 },
            vacuum::Request::Stop,
        ],
    );
}
