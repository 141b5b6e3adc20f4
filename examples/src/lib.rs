//! The shared parts of the examples: a robot at the given address, or a simulated one in this
//! process; smooth references; targets of input devices; motions as jobs; the shutdown of a
//! service.
#![doc = include_str!("../README.md")]

mod ease;
#[cfg(feature = "http")]
mod job;
#[cfg(any(feature = "grpc", feature = "http"))]
mod service;
mod teleoperation;

pub use ease::Ease;
#[cfg(feature = "http")]
pub use job::{Job, Progress, Stage};
#[cfg(feature = "http")]
pub use service::admit;
#[cfg(any(feature = "grpc", feature = "http"))]
pub use service::{Serving, seconds, serve_until_told};
pub use teleoperation::{clutched, moved};

use std::fmt;
use std::io::{BufRead, Write};
use std::time::Duration;

use anyhow::{Context, ensure};
use clap::{Args, Parser, ValueEnum};
use franka_async::connection::Builder;
use franka_async::gripper::Gripper;
use franka_async::model::Wrench;
use franka_async::realtime::Scheduling;
use franka_async::settings::CollisionBehavior;
use franka_async::{MotionReport, READY, Robot};
use franka_sim::{Fingers, Running, Sim, Tool};
use tokio::task::JoinHandle;

/// Options of every example.
#[derive(Args, Clone, Debug)]
#[command(about = None)]
pub struct Connection {
    /// Address of a robot or simulator, `host` or `host:port`; without it a simulator starts in
    /// this process.
    pub address: Option<String>,
    /// The robot to simulate. A real robot reports its own kind.
    #[arg(long, value_enum, default_value_t = Simulated::Fr3, conflicts_with = "address")]
    pub sim: Simulated,
    /// Real-time scheduling of the control thread; always optional for a simulator in this process.
    #[arg(long, value_enum, default_value_t = Realtime::Enforce)]
    pub realtime: Realtime,
    /// Move at once, without asking for confirmation.
    #[arg(long)]
    pub yes: bool,
}

/// Action if the host does not grant real-time scheduling, see [`franka_async::Realtime`].
#[derive(ValueEnum, Clone, Copy, Debug)]
pub enum Realtime {
    /// Do not connect
    Enforce,
    /// Connect anyway: sufficient for a simulator
    Ignore,
}

impl From<Realtime> for franka_async::Realtime {
    fn from(realtime: Realtime) -> Self {
        match realtime {
            Realtime::Enforce => Self::Enforce,
            Realtime::Ignore => Self::Ignore,
        }
    }
}

/// The robots that can be simulated.
#[derive(ValueEnum, Clone, Copy, Debug)]
pub enum Simulated {
    /// Franka Research 3
    Fr3,
    /// Franka Emika Robot, known as Panda
    Fer,
}

/// Command line of the examples without their own options.
#[derive(Debug, Parser)]
pub struct Arguments {
    /// The robot.
    #[command(flatten)]
    pub connection: Connection,
}

impl Connection {
    /// Connects. Keep the second value: dropping it ends the simulator, if there is one.
    ///
    /// # Errors
    /// If no robot answers at the address, or the simulator cannot start.
    pub async fn open(&self) -> anyhow::Result<(Robot, Option<Running>)> {
        self.open_with(|builder| builder).await
    }

    /// Connects like [`Self::open`], with further options.
    ///
    /// # Errors
    /// The errors of [`Self::open`].
    pub async fn open_with(
        &self,
        options: impl FnOnce(Builder) -> Builder,
    ) -> anyhow::Result<(Robot, Option<Running>)> {
        if let Some(address) = &self.address {
            let builder = Robot::builder(address).realtime(self.scheduling().realtime);
            let robot = options(builder).connect().await;
            let robot = robot.with_context(|| match self.realtime {
                Realtime::Enforce => format!(
                    "connecting to {address} (a simulator needs no real-time kernel: --realtime ignore)"
                ),
                Realtime::Ignore => format!("connecting to {address}"),
            })?;
            return Ok((robot, None));
        }
        let sim = self.simulate().await?;
        let builder = Robot::builder(sim.addr()).realtime(self.scheduling().realtime);
        let robot = options(builder).connect().await?;
        Ok((robot, Some(sim)))
    }

    /// Connects to the Hand alone. Keep the second value, as with [`Self::open`].
    ///
    /// # Errors
    /// If no Hand answers at the address, or the simulator cannot start.
    pub async fn open_hand(&self) -> anyhow::Result<(Gripper, Option<Running>)> {
        if let Some(address) = &self.address {
            let gripper = Gripper::connect(address).await;
            let gripper =
                gripper.with_context(|| format!("connecting to the hand at {address}"))?;
            return Ok((gripper, None));
        }
        let sim = self.simulate().await?;
        let hand = sim.hand().context("the simulator has a hand")?;
        let gripper = Gripper::connect(hand.addr()).await?;
        Ok((gripper, Some(sim)))
    }

    async fn simulate(&self) -> anyhow::Result<Running> {
        let sim = match self.sim {
            Simulated::Fr3 => Sim::fr3(),
            Simulated::Fer => Sim::fer(),
        };
        // With a hand, and a block of 3 cm between its fingers.
        let block = Fingers::new().with_object(0.03);
        let sim = sim.tool(Tool::hand()).hand(block, 0);
        // It shares the machine with this program.
        let sim = sim.wait_for_commands(Duration::from_secs(1)).start().await;
        sim.context("starting the simulator")
    }

    /// Returns the scheduling of a thread that controls the robot of [`Self::open`].
    pub fn scheduling(&self) -> Scheduling {
        Scheduling {
            realtime: match self.address {
                Some(_) => self.realtime.into(),
                None => franka_async::Realtime::Ignore,
            },
            ..Scheduling::default()
        }
    }

    /// Connects like [`Self::open`], asks for permission to do `what`, and moves the arm to the
    /// ready pose.
    ///
    /// # Errors
    /// The errors of [`Self::open`], of [`Self::ask`] and of [`make_ready`].
    pub async fn open_ready(&self, what: &str) -> anyhow::Result<(Robot, Option<Running>)> {
        let (robot, sim) = self.open().await?;
        self.ask(&format!("goes to its ready pose, then {what}"))?;
        make_ready(&robot).await?;
        Ok((robot, sim))
    }

    /// Prints the arm's next motion and waits for the enter key, unless the arm is simulated in
    /// this process or `--yes` was given.
    ///
    /// # Errors
    /// If the input ends first.
    pub fn ask(&self, what: &str) -> anyhow::Result<()> {
        if self.address.is_none() || self.yes {
            return Ok(());
        }
        println!("The arm {what}. Clear the path of the arm, and keep the user stop within reach.");
        print!("Enter to continue, Ctrl-C to cancel: ");
        std::io::stdout().flush()?;
        let read = std::io::stdin().lock().read_line(&mut String::new())?;
        ensure!(
            read > 0,
            "no confirmation that the arm may move: the input has ended (--yes confirms)"
        );
        Ok(())
    }

    /// Connects to the Hand of the robot that [`Self::open`] connected to.
    ///
    /// # Errors
    /// If no Hand answers at its address.
    pub async fn open_gripper(
        &self,
        robot: &Robot,
        sim: Option<&Running>,
    ) -> anyhow::Result<Gripper> {
        let gripper = match sim.and_then(Running::hand) {
            Some(hand) => Gripper::connect(hand.addr()).await,
            None => Gripper::connect(robot.address().ip()).await,
        };
        gripper.context("connecting to the hand")
    }
}

/// Moves the joints to [`READY`] at half speed, and sets thresholds that tolerate pushes: 20 N m
/// and 20 N are a contact, 60 N m and 60 N a collision that stops the arm.
///
/// # Errors
/// The errors of the motion.
pub async fn make_ready(robot: &Robot) -> anyhow::Result<()> {
    robot
        .set_collision_behavior(CollisionBehavior::compliant())
        .await?;
    let moving = robot.move_to(READY).speed(0.5);
    moving.await.context("moving to the ready pose")?;
    Ok(())
}

/// Prints the displacement of the hand from its current position twice a second, until the task is
/// aborted or the connection ends.
pub fn report_hand(robot: &Robot) -> JoinHandle<()> {
    let (mut states, robot) = (robot.states(), robot.clone());
    let start = robot.pose().translation.vector;
    tokio::spawn(async move {
        while states.changed().await.is_ok() {
            let away = (robot.pose().translation.vector - start) * 1e3;
            println!("hand {:+6.1} {:+6.1} {:+6.1} mm", away.x, away.y, away.z);
            tokio::time::sleep(Duration::from_millis(500)).await;
        }
    })
}

/// Pushes the hand of a simulated robot with `force`, in base axes `[N]`, for the next two seconds.
///
/// # Errors
/// If the simulation has ended.
pub async fn push_simulated(sim: &Running, force: [f64; 3]) -> anyhow::Result<()> {
    let [x, y, z] = force;
    let wrench = Wrench::new(x, y, z, 0.0, 0.0, 0.0);
    sim.with(move |robot| robot.push_end_effector(wrench, 2000))
        .await?;
    Ok(())
}

/// A motion's report as a line of text.
pub struct Summary<'a>(pub &'a MotionReport);

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let report = self.0;
        write!(
            f,
            "{:.3} s, {} states lost and {} skipped, success rate min {:.2} avg {:.4}, worst turnaround {:?}",
            report.duration.as_secs_f64(),
            report.lost_states,
            report.skipped_states,
            report.success_rate_min,
            report.success_rate_avg,
            report.worst_turnaround
        )
    }
}
