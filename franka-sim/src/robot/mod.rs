//! The whole simulated robot as a value without sockets. Bytes go in, bytes come out, and each
//! [`Robot::tick`] is one millisecond.
//!
//! ```text
//! TCP bytes ── receive() ──> session ──> requests ──┐                     ┌──> take_reply()
//!                                                   ├─> motion ─> control ┤
//! datagrams ── command() ──> the newest command ────┘    tick()   plant   └──> tick(): datagram
//! ```
//!
//! The robot has no clock, socket, thread or log. In each millisecond, the program that runs the
//! robot must do the following:
//!
//! 1. Call [`command`](Robot::command) for each datagram and [`receive`](Robot::receive) for bytes
//!    of the stream. After each `receive`, send the replies from [`take_reply`](Robot::take_reply).
//! 2. Call [`tick`](Robot::tick), and send its datagram **before** the replies that follow. A reply
//!    like `kReflexAborted` must not overtake the state that explains it.

mod boards;
mod control;
mod interaction;
mod interface;
mod motion;
mod operation;
mod publish;
mod ratchet;
mod recovery;
mod reflex;
mod robot_mode;
mod session;
mod shaking;
mod touch;
mod watch;

pub use crate::connection::{Datagram, SessionError};
pub use operation::Freeze;
pub(crate) use session::next_request;
pub use touch::{Touch, TouchId};

use std::collections::VecDeque;

use bytes::Bytes;
use franka_model::{AsBuilt, Dynamics, JointVector, Load, Model};
use franka_proto::{CommandId, Errors, MoveRequest, RobotCommand, RobotState, Version};

use crate::arm::Arm;
use crate::brake::Brake;
use crate::config::Config;
use crate::connection::Connection;
use crate::estimate::Estimate;
use crate::generator::{ArmModel, Desired};
use crate::kind::Description;
use crate::noise::Random;
use crate::observer::MomentumObserver;
use crate::plant::{DriveTrain, Plant, RigidArm};
use crate::settings::Settings;
use crate::signal::JointSignal;
use boards::Boards;
use control::Measurement;
use interface::TorqueInterface;
use motion::ActiveMotion;
pub(crate) use motion::Awaited;
use operation::{Frozen, Guidance, Lock};
use recovery::Recovery;
use touch::Touches;
use watch::Watch;

/// A simulated robot. The [module](self) describes how to run it.
pub struct Robot {
    config: Config,
    kind: &'static Description,
    model: Model,
    /// The configured arm, and the links and axes that result from it.
    arm: Arm,
    as_built: AsBuilt,
    train: DriveTrain,
    interface: TorqueInterface,
    plant: Box<dyn Plant>,
    /// Undeclared load on the flange in addition to the tool.
    load: Load,
    /// URDF text.
    description: Option<Bytes>,
    settings: Settings,

    client: Option<Connection<Version>>,
    replies: VecDeque<Bytes>,
    /// Command for the cycle that began with the last state, if it has arrived.
    command: Option<RobotCommand>,
    /// `message_id` of the last state.
    clock: u64,

    activity: Activity,
    /// A `Move` that begins as soon as the arm has stopped.
    waiting: Option<(CommandId, MoveRequest)>,
    /// Ids of the `StopMove` requests to answer as soon as the arm has stopped.
    stops: Vec<CommandId>,
    recovery: Option<Recovery>,
    lock: Lock,
    frozen: Option<Frozen>,
    errors: Errors,
    reflex_reason: Errors,

    desired: Desired,
    observer: MomentumObserver,
    estimate: Estimate,
    measurement: Measurement,
    /// Dynamics at the measured state, with the declared load.
    dynamics: Dynamics,
    boards: Boards,
    watch: Watch,
    touches: Touches,
    random: Random,

    state: RobotState,
    datagram: [u8; RobotState::MAX_SIZE],
}

// Only one value exists, so the size of its largest variant does not matter.
#[allow(clippy::large_enum_variant)]
enum Activity {
    /// The arm holds the desired position.
    Holding,
    /// The arm brakes until it is at rest.
    Braking(Brake),
    /// The arm follows a client.
    Moving(ActiveMotion),
    Guided(Guidance),
}

impl Robot {
    /// Returns a robot at rest, with the rigid-body plant.
    pub fn new(config: Config) -> Self {
        let plant = RigidArm::new(config.kind, &config.chosen_arm(), config.q, Load::NONE);
        Self::with_plant(config, Box::new(plant))
    }

    /// Returns a robot whose physics is `plant`. The controllers of the robot use the model of
    /// `config.kind`. The plant receives the configured arm, tool and payload, at rest in the
    /// configured position.
    pub fn with_plant(config: Config, mut plant: Box<dyn Plant>) -> Self {
        let arm = config.chosen_arm();
        plant.fit(config.kind, &arm);
        plant.attach(arm.body.load(&config.tool.load, &config.payload));
        let holding = plant.place(&config.q);
        let train = DriveTrain::new(&arm, &config.q, &holding);
        let kind = Description::of(config.kind);
        let model = arm.model(config.kind);
        let settings = Settings::new(config.tool, &config.unpublished);
        let q = *plant.q();
        let desired = Desired::resting(&ArmModel::new(kind, &model, &settings.frames, &config), q);
        let dynamics = model.dynamics(
            &q,
            plant.dq(),
            &settings.frames,
            &settings.declared_load(),
            &franka_model::GRAVITY_EARTH,
        );
        let mut robot = Self {
            kind,
            description: description(kind, &config, &model),
            client: None,
            replies: VecDeque::new(),
            command: None,
            clock: config.clock,
            activity: Activity::Holding,
            waiting: None,
            stops: Vec::new(),
            recovery: None,
            lock: Lock::default(),
            frozen: None,
            errors: Errors::NONE,
            reflex_reason: Errors::NONE,
            desired,
            estimate: Estimate::new(),
            observer: MomentumObserver::new(),
            measurement: Measurement::resting(&q, &holding, &arm.sensors),
            as_built: arm.body.as_built(config.kind),
            interface: TorqueInterface::new(&arm.drive),
            arm,
            train,
            load: config.payload,
            dynamics,
            boards: Boards::resting(&model, &q),
            watch: Watch::new(&config),
            touches: Touches::default(),
            random: Random::new(config.seed),
            state: RobotState::default(),
            datagram: [0; RobotState::MAX_SIZE],
            settings,
            plant,
            config,
            model,
        };
        robot.publish(&JointVector::zeros());
        robot
    }

    /// Accepts a UDP datagram of the client.
    ///
    /// The robot accepts a command if it is valid and the first answer to the newest state. The
    /// robot drops all other datagrams. It counts lost commands after the first command, even if
    /// the first command is late. In an asynchronous motion, targets need not answer the newest
    /// state, and the last target applies.
    pub fn command(&mut self, datagram: &[u8]) {
        let Ok(command) = RobotCommand::decode(self.version(), datagram) else {
            return;
        };
        let Activity::Moving(motion) = &mut self.activity else {
            return;
        };
        let replaces = match &self.command {
            None => true,
            Some(earlier) => motion.is_asynchronous() && !earlier.motion_generation_finished,
        };
        if replaces && motion.accepts(command.message_id, self.clock) {
            self.command = Some(command);
        } else {
            motion.refuse(command.message_id, self.clock);
        }
    }

    /// Kind of command that the newest state still requires.
    pub(crate) fn awaits(&self) -> Awaited {
        match &self.activity {
            Activity::Moving(motion) if self.command.is_none() => motion.awaits(),
            _ => Awaited::Nothing,
        }
    }

    /// Advances by one millisecond and returns the state to send, if a client is connected.
    pub fn tick(&mut self) -> Option<Datagram<'_>> {
        self.clock += 1;
        self.run_motion();
        let torque = self.control();
        self.supervise();
        self.settle();
        self.publish(&torque);
        let port = self.client.as_ref()?.udp_port()?;
        // The buffer is large enough for every version, and no state uses fields that its version
        // lacks.
        let version = self.version();
        let length = self.state.encode(version, &mut self.datagram).ok()?;
        Some(Datagram {
            port,
            bytes: &self.datagram[..length],
        })
    }

    /// UDP port that the client announced. The client receives states and sends commands on this
    /// port.
    pub fn udp_port(&self) -> Option<u16> {
        self.client.as_ref()?.udp_port()
    }

    /// The last state. The client sees the same state, rounded to the precision of the protocol.
    pub fn state(&self) -> &RobotState {
        &self.state
    }

    /// The configuration with which the robot started. It does not include an arm that was
    /// [fitted](Self::fit) later.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The plant (the physics of the arm). It can be downcast through `Any`:
    ///
    /// ```
    /// # use std::any::Any;
    /// # use franka_sim::{Config, Robot, plant::RigidArm};
    /// # let robot = Robot::new(Config::default());
    /// let plant: &dyn Any = robot.plant();
    /// assert!(plant.is::<RigidArm>());
    /// ```
    pub fn plant(&self) -> &dyn Plant {
        self.plant.as_ref()
    }

    /// Mutable reference to the plant (the physics of the arm), for example to change the arm's
    /// surroundings. If you change the motion of the arm itself, the controllers see the change as
    /// a disturbance.
    pub fn plant_mut(&mut self) -> &mut dyn Plant {
        self.plant.as_mut()
    }

    /// The model that the robot's controllers use, with the joint limits that the robot enforces.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The protocol version that the robot speaks.
    pub fn version(&self) -> Version {
        self.kind.version
    }

    /// URDF text that clients fetch; `None` if robots of this kind serve no description.
    pub fn description(&self) -> Option<&str> {
        std::str::from_utf8(self.description.as_ref()?).ok()
    }

    fn arm(&self) -> ArmModel<'_> {
        ArmModel::new(self.kind, &self.model, &self.settings.frames, &self.config)
    }

    fn is_moving(&self) -> bool {
        matches!(self.activity, Activity::Moving(_))
    }

    /// The desired joint signal that corresponds to the arm's motion.
    fn measured_signal(&self) -> JointSignal {
        JointSignal {
            dq: self.measurement.dq,
            ..JointSignal::resting(self.measurement.q)
        }
    }
}

fn description(kind: &Description, config: &Config, model: &Model) -> Option<Bytes> {
    let name = kind.urdf_name?;
    Some(match &config.urdf {
        Some(text) => text.clone().into(),
        None => crate::urdf::text(name, model).into(),
    })
}
