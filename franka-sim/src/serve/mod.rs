//! The simulated robot on real sockets.
//!
//! ```text
//!  Tokio: listener ── bytes, jobs ──> queue ──> cycle thread: Robot, UDP socket, 1 kHz
//!            └──────── replies <───── queue <──────┘           (and Hand, VacuumGripper)
//! ```
//!
//! The cycle thread owns the robot and the UDP socket, and runs one cycle per millisecond. A
//! blocked Tokio runtime delays requests and replies, but it delays no state. The hand and the
//! vacuum gripper have separate listeners, queues and sockets. They use the robot's thread and
//! clock.
//!
//! | module | content |
//! |---|---|
//! | `clock` | the schedule of states, and the handling of a late host: [`Pace`] |
//! | `cycle` | the loop of the thread |
//! | `device_server` | a device on its sockets |
//! | `device` | the interface of a device to the server |
//! | `relay` | the simulated network between sockets and device |
//! | `sessions` | one client at a time, and the refusal of a second client |
//! | `pending` | connections before their handshake |
//! | `stream` | messages of a stream, and time limits for slow clients |
//! | `service` | the handle with which other tasks access a device |
//! | `priority` | the priority of the thread |

mod clock;
mod cycle;
mod device;
mod device_server;
mod in_step;
mod pending;
mod priority;
mod relay;
mod running;
mod service;
mod sessions;
mod speed;
mod stream;

pub use clock::Pace;
pub use running::Running;
pub use service::{Service, Stopped};
pub use speed::SpeedError;

use std::fmt;
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::Duration;

use franka_model::RobotKind;
use tokio::sync::watch;

use crate::arm::{Arm, StateGeometry, SystemLimits};
use crate::config::{Config, Tool};
use crate::end_effector::{Fingers, Hand, Suction, VacuumGripper};
use crate::network::Network;
use crate::plant::Plant;
use crate::robot::Robot;
use cycle::Cycle;
use in_step::InStep;
use speed::Speed;

/// Builder of a simulated robot. Configure it, then call [`start`](Self::start).
///
/// ```
/// # #[tokio::main(flavor = "current_thread")]
/// # async fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sim = franka_sim::Sim::fr3().start().await?;
/// println!("connect to {}", sim.addr());
/// sim.stop().await;
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Sim {
    /// On the heap, because builds without optimisation copy moved values, and stacks are small.
    config: Box<Config>,
    /// The physics; `None` for the rigid-body plant.
    plant: Option<Box<dyn Plant>>,
    bind: SocketAddr,
    hand: Option<(Fingers, u16)>,
    vacuum_gripper: Option<(Suction, u16)>,
    realtime: bool,
    strict_clock: bool,
    /// True if the client's answers drive the clock.
    virtual_time: bool,
    /// Longest time for which the robot waits for a late command.
    patience: Duration,
    /// Simulated network between socket and robot; `None` if only the host's network carries
    /// datagrams.
    network: Option<Network>,
    every_millisecond: Option<Hook>,
    after_each_state: Option<Hook>,
    in_step: Option<InStep>,
}

/// The function of [`Sim::every_millisecond`] or [`Sim::after_each_state`].
struct Hook(Box<dyn FnMut(&mut Robot) + Send>);

impl fmt::Debug for Hook {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Hook")
    }
}

impl Sim {
    /// Returns a builder of a Franka Research 3 with a [realistic](Arm::realistic) arm and a bare
    /// flange in the ready pose, on a free port of 127.0.0.1.
    pub fn fr3() -> Self {
        Self::realistic(RobotKind::Fr3)
    }

    /// Returns a builder of a Franka Emika Robot (Panda) with a [realistic](Arm::realistic) arm and
    /// a bare flange in the ready pose, on a free port of 127.0.0.1. Its states arrive with the
    /// delays of a real Panda.
    pub fn fer() -> Self {
        Self::realistic(RobotKind::Fer)
    }

    fn realistic(kind: RobotKind) -> Self {
        Self::new(Config {
            kind,
            arm: Some(Arm::realistic(kind)),
            ..Config::default()
        })
    }

    /// Returns a builder of a robot with this configuration, on a free port of 127.0.0.1. The arm
    /// is ideal if [`Config::arm`] is `None`.
    pub fn new(config: Config) -> Self {
        Self {
            config: Box::new(config),
            plant: None,
            bind: SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0),
            hand: None,
            vacuum_gripper: None,
            realtime: false,
            strict_clock: false,
            virtual_time: false,
            patience: Duration::ZERO,
            network: None,
            every_millisecond: None,
            after_each_state: None,
            in_step: None,
        }
    }

    /// Changes the configuration: any field of [`Config`].
    ///
    /// ```
    /// # use franka_sim::Sim;
    /// let sim = Sim::fer().configure(|config| {
    ///     config.seed = 7;
    ///     config.unpublished.power = 300.0;
    /// });
    /// ```
    pub fn configure(mut self, change: impl FnOnce(&mut Config)) -> Self {
        change(&mut self.config);
        self
    }

    /// Listens on `address`. Port 0 selects a free port. Real robots use port 1337.
    pub fn bind(mut self, address: SocketAddr) -> Self {
        self.bind = address;
        self
    }

    /// Replaces the rigid-body plant (the physics) by this plant: see [`Robot::with_plant`].
    pub fn plant(mut self, plant: impl Plant) -> Self {
        self.plant = Some(Box::new(plant));
        self
    }

    /// Simulates this arm: see [`Config::arm`].
    ///
    /// ```
    /// # use franka_model::RobotKind;
    /// # use franka_sim::arm::{Arm, Family};
    /// # use franka_sim::Sim;
    /// let sim = Sim::fr3().arm(Arm::sample(RobotKind::Fr3, 7, &Family::realistic()));
    /// ```
    pub fn arm(mut self, arm: Arm) -> Self {
        self.config.arm = Some(arm);
        self
    }

    /// Simulates the [ideal](Arm::ideal) arm, for tests that need exact results.
    pub fn ideal(self) -> Self {
        let kind = self.config.kind;
        self.arm(Arm::ideal(kind))
    }

    /// Enforces and serves the joint limits of this system version instead of the limits of the arm
    /// (Franka Research 3 only).
    pub fn limits(mut self, limits: SystemLimits) -> Self {
        let mut arm = self.config.chosen_arm();
        arm.limits = limits;
        self.config.arm = Some(arm);
        self
    }

    /// Computes the reported poses, the inverse kinematics and the served description with this
    /// geometry instead of the geometry of the arm.
    pub fn state_geometry(mut self, geometry: StateGeometry) -> Self {
        let mut arm = self.config.chosen_arm();
        arm.body.state_geometry = geometry;
        self.config.arm = Some(arm);
        self
    }

    /// Mounts a tool that the controllers' model includes.
    pub fn tool(mut self, tool: Tool) -> Self {
        self.config.tool = tool;
        self
    }

    /// Serves a Franka Hand in addition to the robot, on this TCP port. Port 0 selects a free port.
    ///
    /// Real hands use port 1338. To add the mass and the frame of the hand, mount [`Tool::hand`]
    /// with [`tool`](Self::tool). If the [plant](Self::plant) has fingers, the hand moves them.
    pub fn hand(mut self, fingers: Fingers, port: u16) -> Self {
        self.hand = Some((fingers, port));
        self
    }

    /// Serves a vacuum gripper in addition to the robot, on this TCP port. Port 0 selects a free
    /// port. Real vacuum grippers use port 1339.
    pub fn vacuum_gripper(mut self, suction: Suction, port: u16) -> Self {
        self.vacuum_gripper = Some((suction, port));
        self
    }

    /// Requests a real-time priority (SCHED_FIFO) for the simulator's thread. If the user lacks the
    /// right, or on systems other than Linux, the thread logs a warning and keeps its ordinary
    /// priority.
    pub fn realtime(mut self, realtime: bool) -> Self {
        self.realtime = realtime;
        self
    }

    /// Follows the wall clock even if the host delays the simulator. Due states then arrive in a
    /// burst, and late answers count as lost. By default, the clock instead falls behind the wall
    /// clock: see [`Pace`].
    pub fn strict_clock(mut self, strict: bool) -> Self {
        self.strict_clock = strict;
        self
    }

    /// Advances robot time as fast as the client answers, instead of with the wall clock. Use this
    /// method for tests and for programs that learn.
    ///
    /// * In a motion in which every state requires an answer, the next millisecond begins as soon
    ///   as the answer to the last state arrives. The robot waits for each command for up to
    ///   `patience`, and then counts it as lost. It therefore detects a silent client after 20
    ///   times `patience`. If the host delays the simulator, the delay hardly counts, unless the
    ///   client has received nothing for half a second. Half a second is a good choice for
    ///   `patience`: libfranka considers a connection lost after a second without a state. A client
    ///   that skips an answer waits for `patience` until it receives the next state.
    /// * In all other cases, the robot sends up to ten states per millisecond of the wall clock: at
    ///   rest, while it brakes, in a recovery, while a hand grasps, and in an asynchronous motion.
    ///   A client that is too slow misses some of these states.
    ///
    /// The delays of a [`network`](Self::network) are in robot time, in which the client needs no
    /// time to answer. A client that measures time with its own clock measures durations that
    /// differ from the robot's durations. [`Running::set_speed`] slows down or pauses robot time.
    pub fn virtual_time(mut self, patience: Duration) -> Self {
        self.virtual_time = true;
        self.patience = patience;
        self
    }

    /// Waits up to `patience` for each late command, and stops the clock during the wait. Use this
    /// method for clients on a busy machine, or on the simulator's machine. A device that requires
    /// no command follows the wall clock, and no device runs faster than the wall clock.
    pub fn wait_for_commands(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }

    /// Passes states and commands through this network, in addition to the real network between the
    /// sockets. The time of `network` begins when the robot starts.
    ///
    /// Datagrams arrive up to 0.2 ms later than the network prescribes, because the host's sleep is
    /// not exact. The thread checks the network ten times a millisecond. [Virtual
    /// time](Self::virtual_time) has no such delay. The command connections of the robot and of a
    /// hand are not affected.
    pub fn network(mut self, network: Network) -> Self {
        self.network = Some(network);
        self
    }

    /// Runs `job` on the robot before each millisecond of the robot, including the first. Use this
    /// method to observe or disturb the robot in robot time; it works with every clock. The
    /// simulator's thread runs `job`, so `job` must be short.
    pub fn every_millisecond(mut self, job: impl FnMut(&mut Robot) + Send + 'static) -> Self {
        self.every_millisecond = Some(Hook(Box::new(job)));
        self
    }

    /// Runs `job` on the robot each time a state has been passed to the kernel. Without a client,
    /// `job` runs at the time at which the state would be sent. Use this method to record the time.
    /// `job` runs on the same thread as in [`Self::every_millisecond`].
    pub fn after_each_state(mut self, job: impl FnMut(&mut Robot) + Send + 'static) -> Self {
        self.after_each_state = Some(Hook(Box::new(job)));
        self
    }

    /// Makes these robots begin each millisecond together; this works with every clock. If one
    /// robot waits for a command, all robots wait. Use this function for arms in one world, and for
    /// programs that compare robots. The robots do not wait for a robot that has stopped, or whose
    /// `Sim` was dropped.
    ///
    /// Start all robots before you connect to one or stop one. Their time does not advance until
    /// all have started.
    pub fn in_step<const N: usize>(mut sims: [Self; N]) -> [Self; N] {
        for (sim, part) in sims.iter_mut().zip(in_step::in_step::<N>()) {
            sim.in_step = Some(part);
        }
        sims
    }

    /// Starts the robot. Call this within a Tokio runtime with I/O and time enabled. Any number of
    /// robots may run in one process.
    ///
    /// # Errors
    /// Returns an error if a socket cannot be bound or the thread cannot be started. Also returns
    /// an error for virtual time with a `patience` of zero, because every command would be late.
    ///
    /// # Cancel safety
    /// Dropping the future before it completes closes all sockets and starts no robot.
    pub async fn start(self) -> io::Result<Running> {
        if self.virtual_time && self.patience.is_zero() {
            let what = "the patience of virtual time is 0 s, expected more than 0 s";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
        }
        let stalls = self.config.arm.as_ref().and_then(|arm| arm.stalls);
        let stalling = stalls.map(|stalls| Network::stalling(self.config.seed, stalls));
        let network = self.network.or(stalling);
        let robot = robot(self.config, self.plant);
        let (robot, robot_server) = service::open(self.bind, robot).await?;
        let beside = |port| {
            let mut address = self.bind;
            address.set_port(port);
            address
        };
        let (hand, hand_server) = match self.hand {
            Some((fingers, port)) => {
                let hand = Box::new(Hand::new(fingers));
                let (hand, server) = service::open(beside(port), hand).await?;
                (Some(hand), Some(server))
            }
            None => (None, None),
        };
        let (vacuum_gripper, vacuum_server) = match self.vacuum_gripper {
            Some((suction, port)) => {
                let gripper = Box::new(VacuumGripper::new(suction));
                let (gripper, server) = service::open(beside(port), gripper).await?;
                (Some(gripper), Some(server))
            }
            None => (None, None),
        };
        let cycle = Cycle {
            robot: robot_server.behind(network),
            hand: hand_server,
            vacuum: vacuum_server,
            every_millisecond: self.every_millisecond,
            after_each_state: self.after_each_state,
            in_step: self.in_step,
        };
        let (speed, patience) = (self.virtual_time.then(Speed::default), self.patience);
        let of_thread = speed.clone();
        let (realtime, strict) = (self.realtime, self.strict_clock);
        let (done, finished) = watch::channel(());
        std::thread::Builder::new()
            .name("franka-sim".into())
            .spawn(move || {
                if realtime && let Err(error) = priority::raise() {
                    tracing::warn!(%error, "no real-time priority");
                }
                match of_thread {
                    Some(speed) => cycle.run_on_answers(patience, speed),
                    None => cycle.run(strict, patience),
                }
                drop(done);
            })?;
        Ok(Running {
            robot,
            hand,
            vacuum_gripper,
            speed,
            finished,
        })
    }
}

/// Builds the robot of this configuration, with the rigid-body plant by default. This function is
/// not async, because the future of an async function would hold the robot.
fn robot(config: Box<Config>, plant: Option<Box<dyn Plant>>) -> Box<Robot> {
    Box::new(match plant {
        Some(plant) => Robot::with_plant(*config, plant),
        None => Robot::new(*config),
    })
}

#[cfg(test)]
mod tests;
