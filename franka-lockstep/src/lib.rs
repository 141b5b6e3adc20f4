//! The driver, the command session and the simulated robot in one thread, in virtual time. Runs
//! never wait, and can be repeated exactly.
//!
//! ```text
//!   Lifecycle --requests--> client::Session ~~bytes~~> Robot (simulated)
//!       ^  |                      |                      |
//!       |  +--orders--> Driver <~~~~~~~datagrams~~~~~~~~~+
//!       +------events------+ ~~~~~~~~~commands~~~~~~~~~~~^
//!   '-------------- DriverStack -------------'
//! ```
//!
//! All data that crosses `~~` is encoded for the wire, passes a [`Link`], and is decoded again.
//! Datagrams pass the simulator's network, whose seed determines delays and losses. One call of
//! [`Lockstep::tick`] is one millisecond, from one cycle of the robot to the next cycle. Datagrams
//! may arrive at any time within this millisecond. The harness checks each command of target
//! control against the robot's limits. Tests can also run a [`DriverStack`] with a scripted robot.

mod driver_stack;
mod engaged;
mod guard;
mod guarded;
mod link;
mod motions;
mod poses;
mod several;
mod supervised;
mod wander;

use std::time::Duration;

use franka_model::{Model, RobotKind};
use franka_proto::RobotCommand;
pub use franka_rt::control::{Callback, Shaper};
use franka_rt::control::{Command, WriteError};
pub use franka_rt::lifecycle::Outcome;
use franka_rt::session::Guard;
use franka_sim::{Config, Robot};

pub use driver_stack::DriverStack;
pub use guarded::{Guarded, Workload};
pub use link::Link;
pub use poses::{force_of, pose_of, self_distance, set_in_motion};
pub use several::{outcomes_of, turned};
pub use supervised::{Asked, Supervised, shows};
pub use wander::Wander;

use guard::CommandGuard;

/// A part of the control cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The driver's work from the datagram of a state to the datagram of its command.
    Answer,
    /// The driver's work after the command has been sent.
    Aftermath,
    /// The driver's preparation for the next state.
    Preparation,
}

/// The whole system, which advances by one millisecond at a time.
pub struct Lockstep {
    /// The simulated robot. A test can push it or raise its errors.
    pub robot: Robot,
    /// The network between robot and client.
    pub link: Link,
    /// The driver, without its sockets.
    pub client: DriverStack,
    /// The client's model of the robot, with the lengths and limits that the robot describes.
    model: Model,
    /// Check of commands. It is `None` once a program of the test has run, because such a program
    /// may send any command.
    guard: Option<CommandGuard>,
    /// True if the arm was ever frozen ([`Robot::freeze`]).
    frozen: bool,
    milliseconds: u64,
    heard: u64,
}

impl Lockstep {
    /// Returns a robot with this configuration, connected over a perfect link.
    ///
    /// # Panics
    /// Panics if the handshake fails or no state arrives.
    pub fn new(config: Config) -> Self {
        Self::with_robot(Robot::new(config))
    }

    /// Returns this robot, connected over a perfect link. The robot may have any plant (physics).
    ///
    /// # Panics
    /// Panics like [`Self::new`].
    pub fn with_robot(robot: Robot) -> Self {
        let robots = robot.model();
        let (lengths, limits) = (*robots.lengths(), *robots.joint_limits());
        let model = Model::of(robot.config().kind)
            .clone()
            .with_lengths(lengths)
            .with_joint_limits(limits);
        let version = robot.version();
        let mut this = Self {
            robot,
            link: Link::perfect(),
            client: DriverStack::new(&model, version),
            model,
            guard: Some(CommandGuard::new(limits)),
            frozen: false,
            milliseconds: 0,
            heard: 0,
        };
        this.connect();
        this
    }

    /// Returns a Franka Research 3 with a Hand in the ready pose. The robot enforces its limits.
    pub fn ready() -> Self {
        Self::ready_of(RobotKind::Fr3)
    }

    /// Returns a robot of this kind with a Hand in the ready pose. The robot enforces its limits.
    pub fn ready_of(kind: RobotKind) -> Self {
        Self::new(Self::config_of(kind))
    }

    /// Returns the configuration of [`Self::ready_of`].
    pub fn config_of(kind: RobotKind) -> Config {
        Config {
            kind,
            tool: franka_sim::Tool::hand(),
            ..Config::default()
        }
    }

    /// Replaces the number of cycles in the log of a motion.
    #[must_use]
    pub fn with_log_size(self, cycles: usize) -> Self {
        let client = self.client.with_log_size(cycles);
        Self { client, ..self }
    }

    /// Time since the start, `[ms]`.
    pub fn now(&self) -> u64 {
        self.milliseconds
    }

    /// Advances the whole system by one millisecond.
    ///
    /// # Panics
    /// Panics if a command violates a limit of the robot, or if the client's session cannot read a
    /// message.
    pub fn tick(&mut self) {
        self.tick_around(|_, work| work());
    }

    /// Like [`Self::tick`], but `around` runs each part of the control cycle. `around` can measure
    /// time or count allocations.
    ///
    /// # Panics
    /// Panics like [`Self::tick`], or if `around` does not run the function that it receives.
    pub fn tick_around(&mut self, mut around: impl FnMut(Part, &mut dyn FnMut())) {
        self.milliseconds += 1;
        self.client.now = Duration::from_millis(self.milliseconds);
        while !self.link.delayed
            && let Some(bytes) = self.client.take_message()
        {
            if self.link.requests {
                self.robot
                    .receive(&bytes)
                    .expect("the client's messages are well-formed");
            }
        }
        let now = self.client.now;
        self.frozen |= self.robot.is_frozen();
        if let Some(state) = self.robot.tick() {
            self.link.network.to_client.send(now, state.bytes);
        }
        let mut replies = Vec::new();
        while !self.link.delayed
            && let Some(reply) = self.robot.take_reply()
        {
            replies.extend_from_slice(&reply);
        }
        if !self.take_states(&mut around) {
            let silence = Duration::from_millis(self.milliseconds - self.heard);
            self.client.driver.on_silence(silence);
        }
        self.deliver_commands();
        if self.link.replies {
            self.client.on_bytes(&replies);
        }
        self.client.settle();
    }

    /// Passes the states that arrive before the robot's next cycle to the client. Returns true if a
    /// state arrived.
    fn take_states(&mut self, around: &mut impl FnMut(Part, &mut dyn FnMut())) -> bool {
        let end = self.next_cycle();
        let mut heard = false;
        while let Some(reception) =
            self.link
                .receive(self.client.free, end, self.client.state.message_id)
        {
            if heard {
                // Carries out the effects of the previous state.
                self.client.settle();
            }
            heard = true;
            self.heard = self.milliseconds;
            self.client.now = reception.at;
            self.client.free = reception.at + self.client.turnaround;
            if reception.skipped > 0 {
                self.client.driver.on_skipped(reception.skipped);
            }
            let mut answer = None;
            let mut command = [0; RobotCommand::MAX_SIZE];
            around(Part::Answer, &mut || {
                answer = Some(self.client.answer(&reception.datagram, &mut command));
            });
            let answer = answer.expect("the cycle has run");
            around(Part::Aftermath, &mut || {
                self.client.conclude(answer.is_some());
            });
            around(Part::Preparation, &mut || self.client.prepare());
            if let Some(size) = answer {
                self.pass_command(&command[..size]);
            }
        }
        heard
    }

    /// Passes the commands that arrive before the robot's next cycle to the robot.
    fn deliver_commands(&mut self) {
        let end = self.next_cycle();
        while let Some(command) = self.link.command(end) {
            self.robot.command(&command);
        }
    }

    /// The time of the robot's next cycle.
    fn next_cycle(&self) -> Duration {
        Duration::from_millis(self.milliseconds + 1)
    }

    /// Lets `milliseconds` pass without a state. The robot's own time does not advance.
    pub fn silence(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.milliseconds += 1;
            self.client.now = Duration::from_millis(self.milliseconds);
            let silence = Duration::from_millis(self.milliseconds - self.heard);
            self.client.driver.on_silence(silence);
            self.client.settle();
        }
    }

    /// Makes the client's clock jump, as on a host that was suspended. The client loses no state.
    pub fn jump(&mut self, milliseconds: u64) {
        self.milliseconds += milliseconds;
        self.heard += milliseconds;
        self.client.heard += Duration::from_millis(milliseconds);
        self.client.now = Duration::from_millis(self.milliseconds);
        self.client.settle();
    }

    /// Writes a command for the newest state of a motion under active control.
    ///
    /// # Errors
    /// Returns the errors of the driver.
    pub fn write(&mut self, command: &Command, finished: bool) -> Result<(), WriteError> {
        let sent = self.client.driver.write(command, finished)?;
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let size = sent.encode(self.client.version(), &mut bytes);
        self.pass_command(&bytes[..size.expect("it fits")]);
        self.deliver_commands();
        self.client.settle();
        Ok(())
    }

    /// Closes the connection, if open, and connects to the same robot again over a perfect link.
    ///
    /// # Panics
    /// Panics if the handshake fails.
    pub fn reconnect(&mut self) {
        self.robot.disconnect();
        self.link = Link::perfect();
        self.heard = self.milliseconds;
        self.client = DriverStack::new(&self.model, self.robot.version());
        self.connect();
    }

    fn connect(&mut self) {
        assert!(self.robot.connect(), "the robot takes a client");
        self.client.connect(40_000);
        self.run(5);
        assert!(self.client.is_connected(), "the handshake is done");
        assert!(self.client.state.message_id > 0, "states come");
    }

    /// Checks a command against the limits, and sends it.
    fn pass_command(&mut self, command: &[u8]) {
        let DriverStack { state, record, .. } = &self.client;
        let version = self.client.version();
        let decoded = RobotCommand::decode(version, command).expect("a command of this version");
        assert!(
            !record.bindings.contains(Guard::PlanFailure),
            "a goal that is accepted can be planned"
        );
        assert!(
            self.frozen || !record.bindings.contains(Guard::Unresponsive),
            "an arm that follows its commands is not reported as unresponsive"
        );
        if let Some(guard) = &mut self.guard {
            guard.check(&decoded, state, record);
        }
        let finishing = decoded.motion_generation_finished || decoded.torque_command_finished;
        let sent = self.client.now + self.client.turnaround;
        self.link.send(sent, command, finishing);
    }

    /// Advances by `milliseconds`.
    pub fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }
}

/// Runs `test` for every kind of robot. `test` receives a function that creates a robot: see
/// [`Lockstep::ready_of`].
pub fn for_each_robot(test: impl Fn(&dyn Fn() -> Lockstep)) {
    for kind in RobotKind::ALL {
        println!("{kind:?}");
        test(&|| Lockstep::ready_of(kind));
    }
}
