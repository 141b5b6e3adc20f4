//! A robot that is scripted by a test.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};

use franka_proto::framing::next_message;
use franka_proto::server::{Event, Session};
use franka_proto::{
    CommandId, ControllerMode, MotionGeneratorMode, MoveRequest, MoveStatus, Reply, Request,
    RobotCommand, RobotMode, RobotState, StopStatus, Version,
};
use franka_record::cassette::Device;

use crate::tape::Tape;

/// The robot's side of the protocol, and a state that the test fills in.
pub(crate) struct ScriptedRobot {
    /// The next state; its id increases by one with every state sent.
    pub(crate) state: RobotState,
    session: Session,
    tape: Tape,
    udp: UdpSocket,
    client: Option<SocketAddr>,
    received: Vec<u8>,
    to_client: Vec<u8>,
    requests: VecDeque<(CommandId, Request)>,
}

impl ScriptedRobot {
    /// A robot at rest that waits for a client.
    pub(crate) fn new(version: Version) -> Self {
        let udp = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
        udp.set_nonblocking(true).expect("an option");
        let mut robot = Self {
            state: RobotState::default(),
            session: Session::new(version),
            tape: Tape::new(Device::Robot),
            udp,
            client: None,
            received: Vec::new(),
            to_client: Vec::new(),
            requests: VecDeque::new(),
        };
        robot.rest();
        robot
    }

    /// Processes bytes of the client's stream.
    pub(crate) fn on_bytes(&mut self, bytes: &[u8]) {
        self.tape.on_request(bytes);
        self.received.extend_from_slice(bytes);
        while let Some(message) = next_message(&self.received).expect("whole messages") {
            let size = message.size();
            match self.session.on_message(message).expect("a good client") {
                Event::Connect {
                    udp_port, reply, ..
                } => {
                    self.client = Some((Ipv4Addr::LOCALHOST, udp_port).into());
                    let reply = self.tape.reply(reply.as_bytes().to_vec());
                    self.to_client.extend(reply);
                }
                Event::Request { id, request } => self.requests.push_back((id, request)),
                other => panic!("{other:?}"),
            }
            self.received.drain(..size);
        }
    }

    /// The bytes to send to the client.
    pub(crate) fn take_bytes(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.to_client)
    }

    /// Answers a request.
    pub(crate) fn reply(&mut self, id: CommandId, reply: Reply<'_>) {
        let reply = self.session.reply(id, reply).expect("a fitting answer");
        let reply = self.tape.reply(reply.as_bytes().to_vec());
        self.to_client.extend(reply);
    }

    /// Answers a `Move`, or reports its end.
    pub(crate) fn reply_move(&mut self, id: CommandId, status: MoveStatus) {
        self.reply(id, Reply::Move(status));
    }

    /// Answers the client's request for the model.
    pub(crate) fn reply_model(&mut self, id: CommandId, text: &str) {
        let header = self.session.model_header(id, text.len());
        let header = header.expect("a fitting answer");
        let reply = [header.as_bytes(), text.as_bytes()].concat();
        self.to_client.extend(self.tape.reply(reply));
    }

    /// Returns the oldest unread request.
    pub(crate) fn take_request(&mut self) -> Option<(CommandId, Request)> {
        self.requests.pop_front()
    }

    /// Returns the `Move` that has to be the next request.
    pub(crate) fn expect_move(&mut self) -> (CommandId, MoveRequest) {
        match self.take_request() {
            Some((id, Request::Move(request))) => (id, request),
            other => panic!("expected Move, got {other:?}"),
        }
    }

    /// Returns the id of the `StopMove` that has to be the next request.
    pub(crate) fn expect_stop(&mut self) -> CommandId {
        match self.take_request() {
            Some((id, Request::StopMove)) => id,
            other => panic!("expected StopMove, got {other:?}"),
        }
    }

    /// Answers the `StopMove` that has to be the next request, and reports that it preempted the
    /// motion `id`; states show rest.
    pub(crate) fn obey_stop(&mut self, id: CommandId) {
        let stop = self.expect_stop();
        self.reply(stop, Reply::StopMove(StopStatus::Success));
        self.reply_move(id, MoveStatus::Preempted);
        self.rest();
    }

    /// Lets states show the modes of a motion from now on.
    pub(crate) fn run(&mut self, request: &MoveRequest) {
        self.state.motion_generator_mode = request.generator.in_state();
        self.state.controller_mode = request.controller.in_state();
        self.state.robot_mode = RobotMode::Move;
    }

    /// Lets states show a robot at rest from now on.
    pub(crate) fn rest(&mut self) {
        self.state.motion_generator_mode = MotionGeneratorMode::Idle;
        self.state.controller_mode = ControllerMode::JointImpedance;
        self.state.robot_mode = RobotMode::Idle;
    }

    /// Sends the state under the next id.
    pub(crate) fn send_next(&mut self) {
        self.send(self.state.message_id + 1);
    }

    /// Sends the state under this id.
    pub(crate) fn send(&mut self, message_id: u64) {
        self.state.message_id = message_id;
        let mut datagram = [0; RobotState::MAX_SIZE];
        let size = self.state.encode(self.session.version(), &mut datagram);
        let size = size.expect("it fits");
        let client = self.client.expect("a client has connected");
        let state = self.tape.send_state(&datagram[..size]);
        self.udp.send_to(&state, client).expect("loopback");
    }

    /// Returns the oldest unread command.
    pub(crate) fn take_command(&mut self) -> Option<RobotCommand> {
        let version = self.session.version();
        let mut datagram = [0; 2 * RobotCommand::MAX_SIZE];
        match self.udp.recv(&mut datagram) {
            Ok(size) => {
                assert_eq!(size, version.command_size());
                self.tape.on_command(&datagram[..size]);
                let command = RobotCommand::decode(version, &datagram[..size]);
                Some(command.expect("a command of this version"))
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => None,
            Err(error) => panic!("{error}"),
        }
    }
}
