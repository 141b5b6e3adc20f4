//! The client and a scripted robot, in one thread.

use std::net::{IpAddr, Ipv4Addr};
use std::time::Duration;

use franka_lockstep::{DriverStack, Outcome};
use franka_model::{Model, RobotKind};
use franka_proto::{
    Command as ServiceCommand, CommandId, MoveRequest, MoveStatus, Request, RobotCommand, Version,
};
use franka_rt::control::{Command, WriteError};
use franka_rt::driver::{ControlLog, Program};
use franka_rt::exchange::{self, Exchange, Reception};
use franka_rt::lifecycle::{ControlError, MotionError};
use franka_rt::session::GoalId;

use crate::robot::ScriptedRobot;

/// The client, the robot, and the sockets between.
///
/// A datagram over loopback has arrived when the call that sends it returns, so nothing here waits.
/// [`Pair::cycle`] and [`Pair::silence`] count the time.
pub(crate) struct Pair {
    pub(crate) client: DriverStack,
    pub(crate) robot: ScriptedRobot,
    exchange: Exchange,
}

/// A motion that the robot has started.
pub(crate) struct Running {
    /// The id under which the motion resolves.
    pub(crate) work: GoalId,
    /// The id of the `Move` request.
    pub(crate) id: CommandId,
    /// The command that answered the first state with its modes.
    pub(crate) first: Option<RobotCommand>,
}

impl Pair {
    /// Returns a connected pair: after the handshake, a state with the id 1, and the robot's model
    /// if the version has one.
    pub(crate) fn connected(version: Version) -> Self {
        Self::with_log_size(version, ControlLog::DEFAULT_CAPACITY)
    }

    /// Like [`Self::connected`], with this many cycles in the log of a motion.
    pub(crate) fn with_log_size(version: Version, cycles: usize) -> Self {
        let robot = IpAddr::from(Ipv4Addr::LOCALHOST);
        let socket = exchange::bind(robot).expect("a free port");
        let port = socket.local_addr().expect("bound").port();
        let mut pair = Self {
            client: DriverStack::new(model(version), version).with_log_size(cycles),
            robot: ScriptedRobot::new(version),
            exchange: Exchange::new(socket, robot, version.state_size()).expect("options"),
        };
        pair.client.connect(port);
        pair.settle();
        assert!(pair.client.is_connected());
        assert_eq!(pair.step(), None);
        assert_eq!(pair.client.state.message_id, 1);
        if version.supports(ServiceCommand::GetRobotModel) {
            pair.client.request(&Request::GetRobotModel);
            pair.settle();
            let (id, _) = pair.robot.take_request().expect("the model is asked for");
            pair.robot.reply_model(id, "<robot name=\"fr3\"/>");
            pair.settle();
        }
        assert_eq!(pair.client.pending(), 0);
        pair
    }

    /// One wake-up of the control thread, which takes a millisecond and needs a waiting datagram.
    /// Then all messages over TCP arrive.
    pub(crate) fn cycle(&mut self) -> Reception {
        let reception = self.exchange.receive();
        if reception.fresh {
            let mut command = [0; RobotCommand::MAX_SIZE];
            self.client.driver.on_skipped(reception.skipped);
            let size = self.client.answer(self.exchange.state(), &mut command);
            if let Some(size) = size {
                self.exchange.send(&command[..size]).expect("loopback");
            }
            self.client.conclude(size.is_some());
        }
        self.client.now += Duration::from_millis(1);
        self.settle();
        reception
    }

    /// Sends the robot's next state, and returns the command that answers it.
    pub(crate) fn step(&mut self) -> Option<RobotCommand> {
        self.robot.send_next();
        self.cycle();
        let command = self.robot.take_command();
        assert_eq!(self.robot.take_command(), None, "one answer at most");
        command
    }

    /// Delivers all messages over TCP, in both directions, until there are no more.
    pub(crate) fn settle(&mut self) {
        loop {
            let mut silent = !self.client.settle();
            while let Some(message) = self.client.take_message() {
                self.robot.on_bytes(&message);
                silent = false;
            }
            let replies = self.robot.take_bytes();
            if silent && replies.is_empty() {
                return;
            }
            self.client.on_bytes(&replies);
        }
    }

    /// Lets these milliseconds pass without a state.
    pub(crate) fn silence(&mut self, milliseconds: std::ops::RangeInclusive<u64>) {
        for silent in milliseconds {
            self.client.now += Duration::from_millis(1);
            self.client.driver.on_silence(Duration::from_millis(silent));
            self.settle();
        }
    }

    /// Starts a motion: the robot confirms the start, and shows its modes in one state, which is
    /// answered.
    pub(crate) fn begin(&mut self, program: Program, request: MoveRequest) -> Running {
        let (work, id) = self.ask(program, request);
        self.robot.reply_move(id, MoveStatus::MotionStarted);
        self.settle();
        self.robot.run(&request);
        let first = self.step();
        Running { work, id, first }
    }

    /// Requests a motion; the robot has not answered yet.
    pub(crate) fn ask(&mut self, program: Program, request: MoveRequest) -> (GoalId, CommandId) {
        let begun = self.client.control(program, request);
        let work = begun.expect("nothing else controls the arm");
        self.settle();
        let (id, asked) = self.robot.expect_move();
        assert_eq!(asked, request);
        (work, id)
    }

    /// Writes a command from outside, and returns it as the robot received it.
    pub(crate) fn write(
        &mut self,
        command: Command,
        finished: bool,
    ) -> Result<RobotCommand, WriteError> {
        let written = self.client.driver.write(&command, finished);
        if let Ok(command) = &written {
            let mut datagram = [0; RobotCommand::MAX_SIZE];
            let size = command.encode(self.client.version(), &mut datagram);
            let size = size.expect("it fits");
            self.exchange.send(&datagram[..size]).expect("loopback");
        }
        let arrived = self.robot.take_command();
        assert_eq!(arrived.is_some(), written.is_ok(), "{written:?}");
        written.map(|_| arrived.expect("just so"))
    }

    /// Lets the robot end a motion with success: its states show rest, and it replies that the
    /// motion succeeded.
    pub(crate) fn succeed(&mut self, motion: &Running) {
        self.robot.rest();
        self.robot.reply_move(motion.id, MoveStatus::Success);
        assert_eq!(self.step(), None);
        assert!(self.outcome(motion.work).is_ok());
        self.assert_idle();
    }

    /// The outcome of work that has been resolved.
    pub(crate) fn outcome(&self, work: GoalId) -> Outcome {
        let outcome = self.client.outcome(work);
        outcome.expect("it has been resolved").clone()
    }

    /// The error of work that has failed.
    pub(crate) fn error(&self, work: GoalId) -> MotionError {
        self.outcome(work).expect_err("it has failed")
    }

    /// The error with which the robot ended a motion.
    pub(crate) fn control_error(&self, work: GoalId) -> ControlError {
        match self.error(work) {
            MotionError::Control(error) => *error,
            other => panic!("expected an end by the robot, got {other:?}"),
        }
    }

    /// Asserts that no motion is active, no work is pending, and no more requests were sent.
    pub(crate) fn assert_idle(&mut self) {
        assert!(self.client.lifecycle.is_idle());
        assert!(self.client.driver.is_watching());
        assert_eq!(self.client.pending(), 0, "every request has been answered");
        assert_eq!(self.robot.take_request(), None);
    }
}

/// The model of the robot with protocol `version`.
pub(crate) fn model(version: Version) -> &'static Model {
    Model::of(match version {
        Version::V5 => RobotKind::Fer,
        Version::V10 => RobotKind::Fr3,
    })
}
