//! A client session and a server session in one thread: every message is encoded and decoded.

mod commands;
mod errors;
mod handshake;
mod models;
mod motions;

use franka_proto::framing::{MAX_REQUEST_SIZE, Message, next_message, next_message_within};
use franka_proto::{
    Architecture, CommandId, MoveControllerMode, MoveGeneratorMode, MoveRequest, Outgoing, Reply,
    Request, System, Version, Violation, client, server,
};

struct Pair {
    client: client::Session,
    server: server::Session,
}

impl Pair {
    /// Returns both sides with the same version, after the handshake.
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
        self.deliver_bytes(outgoing.as_bytes())
    }

    /// Delivers a whole message to the robot.
    fn deliver_bytes(&mut self, bytes: &[u8]) -> Result<server::Event, Violation> {
        let received = next_message_within(bytes, MAX_REQUEST_SIZE);
        self.server.on_message(received.unwrap().unwrap())
    }

    /// Delivers a whole message to the client.
    fn receive<'a>(&mut self, bytes: &'a [u8]) -> Result<client::Event<'a>, Violation> {
        self.client
            .on_message(next_message(bytes).unwrap().unwrap())
    }

    /// Sends a request and checks that the robot decodes the same request.
    fn request(&mut self, request: &Request) -> CommandId {
        let outgoing = self.client.request(request).unwrap();
        let id = outgoing.id();
        let event = self.deliver(&outgoing).unwrap();
        let request = *request;
        assert_eq!(event, server::Event::Request { id, request });
        id
    }

    /// Answers a request and checks that the client decodes the same reply.
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

/// Returns a robot's reply as bytes, without a session, because a session would refuse to create
/// it.
fn raw_reply(id: u32, payload: &[u8]) -> Vec<u8> {
    let size = 12 + payload.len() as u32;
    let mut bytes: Vec<u8> = [1, id, size].iter().flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend(payload);
    bytes
}

fn library() -> Request {
    Request::LoadModelLibrary {
        architecture: Architecture::Arm64,
        system: System::Linux,
    }
}
