//! A client session and a robot in one thread; time is a counter.

mod checks;
mod contact;
mod falling;
mod fer;
mod losing;
mod motions;
mod people;
mod plants;
mod pushes;
#[cfg(feature = "mujoco")]
mod scene;
mod session;
mod stiffest;
mod torques;

use franka_model::{JointVector, RobotKind};
use franka_proto::framing::next_message;
use franka_proto::{
    CommandId, ControllerMode, Errors, MotionGeneratorMode, MoveControllerMode, MoveGeneratorMode,
    MoveRequest, MoveStatus, Request, RobotCommand, RobotError, RobotMode, RobotState, Status,
    client,
};

use super::Robot;
use crate::config::Config;

const PORT: u16 = 5000;

/// Both ends of a session, and what the client has got so far.
struct Pair {
    robot: Robot,
    client: client::Session,
    stream: Vec<u8>,
    /// As decoded from the newest datagram.
    state: RobotState,
    /// All answers, with the clock of the state that the client had by then.
    answers: Vec<(u64, CommandId, Status)>,
}

impl Pair {
    fn connected(config: Config) -> Self {
        Self::with(Robot::new(config))
    }

    fn with(mut robot: Robot) -> Self {
        assert!(robot.connect());
        let mut pair = Self {
            client: client::Session::new(robot.version()),
            robot,
            stream: Vec::new(),
            state: RobotState::default(),
            answers: Vec::new(),
        };
        let hello = pair.client.connect(PORT);
        pair.send(hello.as_bytes());
        assert!(pair.client.is_connected());
        pair.tick(None);
        pair
    }

    fn fr3() -> Self {
        Self::of(RobotKind::Fr3)
    }

    fn of(kind: RobotKind) -> Self {
        Self::connected(Config {
            kind,
            ..Config::default()
        })
    }

    /// Sends stream bytes, and reads what the robot answers at once.
    fn send(&mut self, bytes: &[u8]) {
        self.robot.receive(bytes).expect("a conforming client");
        self.read();
    }

    fn read(&mut self) {
        while let Some(message) = self.robot.take_reply() {
            self.stream.extend_from_slice(&message);
        }
        while let Some(message) = next_message(&self.stream).expect("whole messages") {
            let size = message.size();
            match self.client.on_message(message).expect("a conforming robot") {
                client::Event::Reply { id, reply, .. } => {
                    let status = reply.status().expect("not a handshake");
                    self.answers.push((self.state.message_id, id, status));
                }
                client::Event::Connected { .. } => {}
                other => panic!("{other:?}"),
            }
            self.stream.drain(..size);
        }
    }

    fn request(&mut self, request: &Request) -> CommandId {
        let message = self.client.request(request).expect("room for a request");
        self.send(message.as_bytes());
        message.id()
    }

    /// One cycle: the command answers the newest state, then the next state comes.
    fn tick(&mut self, command: Option<RobotCommand>) {
        if let Some(command) = command {
            self.datagram(&RobotCommand {
                message_id: self.state.message_id,
                ..command
            });
        }
        let datagram = self.robot.tick().expect("a client is there");
        assert_eq!(datagram.port, PORT);
        let last = self.state.message_id;
        self.state = RobotState::decode(self.client.version(), datagram.bytes).expect("a state");
        assert!(last == 0 || self.state.message_id == last + 1);
        self.read();
    }

    fn datagram(&mut self, command: &RobotCommand) {
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let length = command
            .encode(self.client.version(), &mut bytes)
            .expect("room");
        self.robot.command(&bytes[..length]);
    }

    fn idle(&mut self, cycles: usize) {
        for _ in 0..cycles {
            self.tick(None);
        }
    }

    /// Starts a motion and waits for the state that shows it.
    fn start(&mut self, controller: MoveControllerMode, generator: MoveGeneratorMode) -> CommandId {
        self.begin(MoveRequest::new(controller, generator))
    }

    fn begin(&mut self, request: MoveRequest) -> CommandId {
        let id = self.request(&Request::Move(request));
        assert_eq!(self.statuses(id), [Status::Move(MoveStatus::MotionStarted)]);
        self.tick(None);
        assert_eq!(self.state.robot_mode, RobotMode::Move);
        assert_eq!(
            self.state.motion_generator_mode,
            request.generator.in_state()
        );
        assert_eq!(self.state.controller_mode, request.controller.in_state());
        assert_eq!(self.state.control_command_success_rate, 0.0);
        id
    }

    fn start_torques(&mut self) -> CommandId {
        let generator = self.client.version().torque_generator();
        self.start(MoveControllerMode::ExternalController, generator)
    }

    fn start_joints(&mut self) -> CommandId {
        self.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )
    }

    fn statuses(&self, id: CommandId) -> Vec<Status> {
        let of_id = |answer: &&(u64, CommandId, Status)| answer.1 == id;
        self.answers.iter().filter(of_id).map(|a| a.2).collect()
    }

    /// How a motion ended.
    fn outcome(&self, id: CommandId) -> MoveStatus {
        match self.statuses(id)[..] {
            [
                Status::Move(MoveStatus::MotionStarted),
                Status::Move(status),
            ] => status,
            ref other => panic!("{other:?}"),
        }
    }

    /// Asserts that the newest state is the first to show a reflex for exactly these reasons, and
    /// that the motion's final reply came after it.
    fn assert_reflex(&self, id: CommandId, reasons: &[RobotError]) {
        let reasons: Errors = reasons.iter().copied().collect();
        assert_eq!(self.state.reflex_reason, reasons);
        assert_eq!(self.state.errors, reasons);
        assert_eq!(self.state.robot_mode, RobotMode::Reflex);
        assert_eq!(self.state.motion_generator_mode, MotionGeneratorMode::Idle);
        assert_eq!(self.state.controller_mode, ControllerMode::Other);
        assert_eq!(self.state.control_command_success_rate, 0.0);
        assert_eq!(self.outcome(id), MoveStatus::ReflexAborted);
        let (seen, ..) = self.answers[self.answers.len() - 1];
        assert_eq!(seen, self.state.message_id, "the reply overtook its state");
    }

    fn q(&self) -> JointVector {
        JointVector::from(self.state.q)
    }

    fn q_d(&self) -> JointVector {
        JointVector::from(self.state.q_d)
    }
}

/// A path from 0 to 1 within `duration` seconds, smooth to the acceleration.
fn ramp(t: f64, duration: f64) -> f64 {
    let x = (t / duration).clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (-15.0 + 6.0 * x))
}

fn positions(q: &JointVector) -> RobotCommand {
    RobotCommand {
        q_c: (*q).into(),
        ..RobotCommand::default()
    }
}

fn torques(tau: &JointVector) -> RobotCommand {
    RobotCommand {
        tau_J_d: (*tau).into(),
        ..RobotCommand::default()
    }
}
