//! A client of the robot that can violate the protocol within a session.

use std::net::{SocketAddr, UdpSocket};
use std::time::Instant;

use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message;
use franka_proto::{
    CommandId, MoveControllerMode, MoveGeneratorMode, MoveRequest, MoveStatus, Request,
    RobotCommand, RobotState, Status, Version,
};

use crate::binary::Binary;
use crate::port::{Connection, SOON, receive};

/// A client that answers every state, until a test changes this.
pub(crate) struct Client {
    pub(crate) connection: Connection,
    udp: UdpSocket,
    session: Session,
    version: Version,
    /// Address from which the states come.
    robot: SocketAddr,
    pub(crate) state: RobotState,
}

impl Client {
    pub(crate) fn connect(binary: &Binary) -> Self {
        let port = binary.robot();
        let (connection, udp) = port.shake_hands();
        let version = binary.version();
        let mut session = Session::new(version);
        session.connect(0);
        let greeting = port.message(0, 0, &[&[0], &port.version.to_le_bytes()[..]].concat());
        let message = next_message(&greeting).expect("whole").expect("complete");
        session.on_message(message).expect("a greeting");
        let robot = receive(&udp, &mut []).1;
        let state = RobotState::default();
        let mut client = Self {
            connection,
            udp,
            session,
            version,
            robot,
            state,
        };
        client.next_state();
        client
    }

    /// Destination and source address of commands.
    pub(crate) fn addresses(&self) -> (SocketAddr, SocketAddr) {
        (self.robot, self.udp.local_addr().expect("bound"))
    }

    /// Waits for a state. Returns the newest state if several have arrived.
    pub(crate) fn next_state(&mut self) -> &RobotState {
        let mut bytes = [0; RobotState::MAX_SIZE];
        let mut length = receive(&self.udp, &mut bytes).0;
        self.udp.set_nonblocking(true).expect("an option");
        while let Ok(newer) = self.udp.recv(&mut bytes) {
            length = newer;
        }
        self.udp.set_nonblocking(false).expect("an option");
        self.state = RobotState::decode(self.version, &bytes[..length]).expect("a state");
        &self.state
    }

    pub(crate) fn request(&mut self, request: &Request) -> CommandId {
        let message = self.session.request(request).expect("the version has it");
        self.connection.send(message.as_bytes());
        message.id()
    }

    /// Waits for the next answer to `id`.
    pub(crate) fn status(&mut self, id: CommandId) -> Status {
        loop {
            let mut bytes = self.connection.read(12).expect("an answer");
            let size: [u8; 4] = bytes[8..12].try_into().expect("four bytes");
            let rest = u32::from_le_bytes(size) as usize - bytes.len();
            bytes.extend(self.connection.read(rest).expect("a whole answer"));
            let message = next_message(&bytes).expect("whole").expect("complete");
            if let Event::Reply { id: got, reply, .. } =
                self.session.on_message(message).expect("an answer")
                && got == id
            {
                return reply.status().expect("an answer to a request");
            }
        }
    }

    pub(crate) fn send(&self, command: &RobotCommand) {
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let length = command.encode(self.version, &mut bytes).expect("room");
        self.send_bytes(&bytes[..length]);
    }

    pub(crate) fn send_from(&self, socket: &UdpSocket, command: &RobotCommand) {
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let length = command.encode(self.version, &mut bytes).expect("room");
        socket.send_to(&bytes[..length], self.robot).expect("sent");
    }

    pub(crate) fn send_bytes(&self, bytes: &[u8]) {
        self.udp.send_to(bytes, self.robot).expect("sent");
    }

    /// Returns the command that answers the newest state and holds the arm in place, for every
    /// generator.
    pub(crate) fn holding(&self) -> RobotCommand {
        RobotCommand {
            message_id: self.state.message_id,
            q_c: self.state.q_d,
            O_T_EE_c: self.state.O_T_EE_c,
            ..RobotCommand::default()
        }
    }

    /// Starts a motion that holds the arm still for some cycles.
    pub(crate) fn start(
        &mut self,
        controller: MoveControllerMode,
        generator: MoveGeneratorMode,
    ) -> CommandId {
        let id = self.request(&Request::Move(MoveRequest::new(controller, generator)));
        assert_eq!(self.status(id), Status::Move(MoveStatus::MotionStarted));
        let begun = Instant::now();
        let modes = (controller.in_state(), generator.in_state());
        while (self.state.controller_mode, self.state.motion_generator_mode) != modes {
            self.next_state();
            assert!(begun.elapsed() < SOON, "the motion does not begin");
        }
        for _ in 0..5 {
            self.send(&self.holding());
            self.next_state();
        }
        id
    }
}
