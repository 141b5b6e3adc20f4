//! A client and a robot in one thread. A counter represents time.

pub(crate) use franka_model::{JointVector, RobotKind};
pub(crate) use franka_proto::{
    CommandId, ControllerMode, Errors, MotionGeneratorMode, MoveControllerMode, MoveGeneratorMode,
    MoveRequest, MoveStatus, Request, RobotCommand, RobotError, RobotMode, RobotState, Status,
    client,
};
pub(crate) use franka_sim::{Config, Robot};

use franka_model::{Frame, Model, Twist, transform};
use franka_proto::framing::next_message;
use franka_proto::{Reply, VirtualWall};
use franka_sim::arm::{Arm, Sensors};
use nalgebra::{Isometry3, Vector3};

pub(crate) const PORT: u16 = 5000;

/// An ideal arm with noisy sensors.
pub(crate) fn noisy() -> Arm {
    Arm {
        sensors: Sensors::NOISY,
        ..Arm::ideal(RobotKind::Fr3)
    }
}

/// Both ends of a session, and the data that the client has received so far.
pub(crate) struct Pair {
    pub(crate) robot: Robot,
    pub(crate) state: RobotState,
    pub(crate) client: client::Session,
    stream: Vec<u8>,
    /// All answers so far, each with the `message_id` of the newest state at that time.
    answers: Vec<(u64, CommandId, Status)>,
    wall: VirtualWall,
    /// Sizes of all replies so far, in bytes.
    pub(crate) sizes: Vec<usize>,
}

impl Pair {
    pub(crate) fn new(config: Config) -> Self {
        Self::with(Robot::new(config))
    }

    pub(crate) fn with(mut robot: Robot) -> Self {
        assert!(robot.connect());
        let mut pair = Self {
            client: client::Session::new(robot.version()),
            robot,
            state: RobotState::default(),
            stream: Vec::new(),
            answers: Vec::new(),
            wall: VirtualWall::default(),
            sizes: Vec::new(),
        };
        let hello = pair.client.connect(PORT);
        pair.send(hello.as_bytes());
        assert!(pair.client.is_connected());
        pair.tick(None);
        pair
    }

    pub(crate) fn of(kind: RobotKind) -> Self {
        Self::new(Config {
            kind,
            ..Config::default()
        })
    }

    pub(crate) fn fr3() -> Self {
        Self::of(RobotKind::Fr3)
    }

    pub(crate) fn fer() -> Self {
        Self::of(RobotKind::Fer)
    }

    /// Sends bytes of the stream, and reads the robot's immediate answers.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.robot.receive(bytes).expect("a conforming client");
        self.read();
    }

    fn read(&mut self) {
        while let Some(message) = self.robot.take_reply() {
            self.stream.extend_from_slice(&message);
        }
        while let Some(message) = next_message(&self.stream).expect("whole messages") {
            let size = message.size();
            self.sizes.push(size);
            if let client::Event::Reply { id, reply, .. } =
                self.client.on_message(message).expect("a conforming robot")
            {
                if let Reply::CartesianLimit { wall, .. } = reply {
                    self.wall = wall;
                }
                let status = reply.status().expect("not a handshake");
                self.answers.push((self.state.message_id, id, status));
            }
            self.stream.drain(..size);
        }
    }

    pub(crate) fn request(&mut self, request: &Request) -> CommandId {
        let message = self.client.request(request).expect("room for a request");
        self.send(message.as_bytes());
        message.id()
    }

    /// Returns the answers to a request so far.
    pub(crate) fn statuses(&self, id: CommandId) -> Vec<Status> {
        let of_id = |answer: &&(u64, CommandId, Status)| answer.1 == id;
        self.answers.iter().filter(of_id).map(|a| a.2).collect()
    }

    /// Sends a request, and returns its only answer, which must come immediately.
    pub(crate) fn ask(&mut self, request: &Request) -> Status {
        let id = self.request(request);
        match self.statuses(id)[..] {
            [status] => status,
            ref other => panic!("{other:?}"),
        }
    }

    /// Returns the virtual wall with this number (protocol 5).
    pub(crate) fn wall(&mut self, id: i32) -> VirtualWall {
        self.ask(&Request::GetCartesianLimit { id });
        self.wall
    }

    /// Runs one cycle: the command answers the newest state, and then the next state arrives.
    pub(crate) fn tick(&mut self, command: Option<RobotCommand>) {
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

    pub(crate) fn datagram(&mut self, command: &RobotCommand) {
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let length = command.encode(self.client.version(), &mut bytes);
        self.robot.command(&bytes[..length.expect("room")]);
    }

    pub(crate) fn idle(&mut self, cycles: usize) {
        for _ in 0..cycles {
            self.tick(None);
        }
    }

    /// Starts a motion and waits for the state that shows it.
    pub(crate) fn begin(&mut self, request: MoveRequest) -> CommandId {
        let id = self.request(&Request::Move(request));
        assert_eq!(self.statuses(id), [Status::Move(MoveStatus::MotionStarted)]);
        self.tick(None);
        let state = &self.state;
        assert_eq!(state.robot_mode, RobotMode::Move);
        assert_eq!(state.motion_generator_mode, request.generator.in_state());
        assert_eq!(state.controller_mode, request.controller.in_state());
        assert_eq!(state.control_command_success_rate, 0.0);
        id
    }

    pub(crate) fn start(
        &mut self,
        controller: MoveControllerMode,
        generator: MoveGeneratorMode,
    ) -> CommandId {
        self.begin(MoveRequest::new(controller, generator))
    }

    /// Starts a motion with joint positions under the internal joint impedance controller.
    pub(crate) fn start_joints(&mut self) -> CommandId {
        self.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )
    }

    pub(crate) fn start_torques(&mut self) -> CommandId {
        let generator = self.client.version().torque_generator();
        self.start(MoveControllerMode::ExternalController, generator)
    }

    /// Requests a torque motion, and returns the answer to `Move`.
    pub(crate) fn ask_to_move(&mut self) -> Status {
        let generator = self.client.version().torque_generator();
        let controller = MoveControllerMode::ExternalController;
        self.ask(&Request::Move(MoveRequest::new(controller, generator)))
    }

    pub(crate) fn outcome(&self, id: CommandId) -> MoveStatus {
        match self.statuses(id)[..] {
            [
                Status::Move(MoveStatus::MotionStarted),
                Status::Move(status),
            ] => status,
            ref other => panic!("{other:?}"),
        }
    }

    /// Repeats a command until the motion has ended, which takes at most `cycles` cycles.
    pub(crate) fn run_out(&mut self, command: RobotCommand, cycles: usize) {
        for _ in 0..cycles {
            self.tick(Some(command));
            if self.state.robot_mode != RobotMode::Move {
                return;
            }
        }
        panic!("the motion goes on");
    }

    /// Recovers, and returns the number of cycles that this took.
    pub(crate) fn recover(&mut self) -> usize {
        let id = self.request(&Request::AutomaticErrorRecovery);
        let mut cycles = 0;
        while self.statuses(id).is_empty() {
            self.tick(None);
            cycles += 1;
            assert!(cycles < 10_000, "no answer to the recovery");
        }
        let success = franka_proto::RecoveryStatus::Success;
        assert_eq!(self.statuses(id), [Status::Recovery(success)]);
        cycles
    }

    /// Asserts that the newest state shows a reflex for exactly these reasons. Also asserts that
    /// the final reply to the motion came after the first state that showed the reflex.
    pub(crate) fn assert_reflex(&self, id: CommandId, reasons: &[RobotError]) {
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

    pub(crate) fn model(&self) -> &'static Model {
        Model::physically_consistent(self.robot.config().kind)
    }

    /// Returns the pose of the end effector at `q`, with the default frames of a bare flange.
    pub(crate) fn pose_at(&self, q: &JointVector) -> Isometry3<f64> {
        let pose = self
            .model()
            .pose(Frame::EndEffector, q, &Default::default());
        transform::isometry(&pose).expect("a rigid transform")
    }

    pub(crate) fn q(&self) -> JointVector {
        JointVector::from(self.state.q)
    }

    pub(crate) fn q_d(&self) -> JointVector {
        JointVector::from(self.state.q_d)
    }

    /// Returns the position of the end effector, `[m]`.
    pub(crate) fn position(&self) -> [f64; 3] {
        let pose = &self.state.O_T_EE;
        [pose[12], pose[13], pose[14]]
    }
}

/// Returns the vector `[linear; angular]` from its two halves.
pub(crate) fn stack(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Twist {
    Twist::from_fn(|i, _| if i < 3 { linear[i] } else { angular[i - 3] })
}

/// Returns the value at `t` of a path from 0 to 1 within `duration` seconds, smooth up to the
/// acceleration.
pub(crate) fn ramp(t: f64, duration: f64) -> f64 {
    let x = (t / duration).clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (-15.0 + 6.0 * x))
}

pub(crate) fn positions(q: &JointVector) -> RobotCommand {
    RobotCommand {
        q_c: (*q).into(),
        ..RobotCommand::default()
    }
}

pub(crate) fn torques(tau: &JointVector) -> RobotCommand {
    RobotCommand {
        tau_J_d: (*tau).into(),
        ..RobotCommand::default()
    }
}

/// Returns a command that keeps the commanded values.
pub(crate) fn stay(state: &RobotState) -> RobotCommand {
    RobotCommand {
        q_c: state.q_d,
        O_T_EE_c: state.O_T_EE_c,
        ..RobotCommand::default()
    }
}

pub(crate) fn finished(command: RobotCommand) -> RobotCommand {
    RobotCommand {
        motion_generation_finished: true,
        torque_command_finished: true,
        ..command
    }
}
