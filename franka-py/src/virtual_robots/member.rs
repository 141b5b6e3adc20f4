//! One simulated robot and the client that moves it, in one thread.

use franka_model::{JointVector, Model, READY, RobotKind, Wrench};
use franka_proto::client::Session;
use franka_proto::framing::next_message;
use franka_proto::{
    MoveControllerMode, MoveGeneratorMode, MoveRequest, Request, RobotCommand, RobotMode,
    RobotState, Version,
};
use franka_sim::arm::{Arm, SystemLimits};
use franka_sim::{Config, Robot, Tool};

use super::control::{Control, Kind};

/// The common settings of robots.
pub(super) struct Settings {
    pub(super) kind: RobotKind,
    pub(super) control: Kind,
    pub(super) tool: Tool,
    /// Share of the largest velocity that motions use.
    pub(super) speed: f64,
}

impl Settings {
    pub(super) fn model(&self) -> &'static Model {
        Model::of(self.kind)
    }
}

/// A robot in motion, or a robot that has stopped itself.
pub(super) struct Member {
    robot: Robot,
    control: Control,
    command: [u8; RobotCommand::MAX_SIZE],
}

impl Member {
    /// Creates a robot at rest at `q`, the ready pose unless given, and begins a motion.
    ///
    /// # Errors
    /// The reason why the robot did not begin it.
    pub(super) fn new(
        settings: &Settings,
        arm: Arm,
        seed: u64,
        q: Option<JointVector>,
    ) -> Result<Self, String> {
        // The limits of actions, the same as in `Model.fr3()`.
        let arm = Arm {
            limits: SystemLimits::Before5_9,
            ..arm
        };
        let mut robot = Robot::new(Config {
            kind: settings.kind,
            q: q.unwrap_or(READY),
            tool: settings.tool,
            arm: Some(arm),
            seed,
            ..Config::default()
        });
        begin(&mut robot, settings.control)?;
        let lengths = *robot.model().lengths();
        let control = Control::new(settings, lengths, &robot.state().q_d.into());
        let command = [0; RobotCommand::MAX_SIZE];
        Ok(Self {
            robot,
            control,
            command,
        })
    }

    /// Sets an action and simulates `cycles` milliseconds. A stopped robot does not move.
    pub(super) fn run(&mut self, action: &[f64], cycles: u32) {
        if !self.is_running() {
            return;
        }
        self.control.act(action);
        for _ in 0..cycles {
            let command = RobotCommand {
                message_id: self.robot.state().message_id,
                ..self.control.command()
            };
            let version = self.robot.version();
            let length = command
                .encode(version, &mut self.command)
                .expect("every version has what is said here, and the buffer room for it");
            self.robot.command(&self.command[..length]);
            self.robot.tick();
            if !self.is_running() {
                break;
            }
        }
    }

    /// True if the motion continues.
    pub(super) fn is_running(&self) -> bool {
        self.robot.state().robot_mode == RobotMode::Move
    }

    pub(super) fn state(&self) -> &RobotState {
        self.robot.state()
    }

    pub(super) fn version(&self) -> Version {
        self.robot.version()
    }

    pub(super) fn push(&mut self, wrench: Wrench, duration: u64) {
        self.robot.push_end_effector(wrench, duration);
    }
}

/// Connects to a robot and begins a motion, like a client.
///
/// # Errors
/// The reason why it is not in motion.
fn begin(robot: &mut Robot, control: Kind) -> Result<(), String> {
    let version = robot.version();
    let (controller, generator) = match control {
        Kind::Torque => (
            MoveControllerMode::ExternalController,
            version.torque_generator(),
        ),
        _ => (
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        ),
    };
    let mut session = Session::new(version);
    robot.connect();
    let hello = session.connect(UDP_PORT);
    exchange(robot, &mut session, hello.as_bytes())?;
    let request = Request::Move(MoveRequest::new(controller, generator));
    let request = session.request(&request);
    let request = request.map_err(|error| error.to_string())?;
    exchange(robot, &mut session, request.as_bytes())?;
    robot.tick();
    match robot.state().robot_mode {
        RobotMode::Move => Ok(()),
        mode => Err(format!("the simulated robot is in the mode {mode:?}")),
    }
}

/// Sends a message to the robot and reads its immediate answer.
fn exchange(
    robot: &mut Robot,
    session: &mut Session<Version>,
    message: &[u8],
) -> Result<(), String> {
    robot.receive(message).map_err(|error| error.to_string())?;
    let mut answers = Vec::new();
    while let Some(bytes) = robot.take_reply() {
        answers.extend_from_slice(&bytes);
    }
    let mut rest = &answers[..];
    while let Some(message) = next_message(rest).map_err(|error| error.to_string())? {
        rest = &rest[message.size()..];
        let event = session.on_message(message);
        event.map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Port for states; nothing is sent.
const UDP_PORT: u16 = 5000;
