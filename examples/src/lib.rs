//! What the examples share: a robot at the address given, or a simulated one in this process.

use anyhow::Context;
use clap::{Args, Parser, ValueEnum};
use franka_async::{Gripper, Realtime, Robot};
use franka_sim::{Fingers, Running, Sim, Tool};

/// Options of every example.
#[derive(Args, Clone, Debug)]
pub struct Connection {
    /// Address of a robot or simulator, `host` or `host:port`; without it a simulator starts in this process.
    pub address: Option<String>,
    /// Which robot to simulate. A real one says itself which it is.
    #[arg(long, value_enum, default_value_t = Simulated::Fr3, conflicts_with = "address")]
    pub sim: Simulated,
    /// Go on without a real-time kernel when driving a robot. A simulator never asks for one.
    #[arg(long)]
    pub ignore_realtime: bool,
}

/// The robots that can be simulated.
#[derive(ValueEnum, Clone, Copy, Debug)]
pub enum Simulated {
    /// Franka Research 3
    Fr3,
    /// Franka Emika Robot, known as Panda
    Fer,
}

/// Command line of the examples without options of their own.
#[derive(Debug, Parser)]
pub struct Arguments {
    /// Which robot.
    #[command(flatten)]
    pub connection: Connection,
}

impl Connection {
    /// Connects. Keep what comes with the robot: dropping it ends the simulator, if there is one.
    ///
    /// # Errors
    /// If nothing answers at the address, or the simulator cannot start.
    pub async fn open(&self) -> anyhow::Result<(Robot, Option<Running>)> {
        if let Some(address) = &self.address {
            let realtime = if self.ignore_realtime {
                Realtime::Ignore
            } else {
                Realtime::Enforce
            };
            let robot = Robot::builder(address).realtime(realtime).connect().await;
            let robot = robot.with_context(|| match realtime {
                Realtime::Enforce => format!(
                    "connecting to {address} (a simulator needs no real-time kernel: --ignore-realtime)"
                ),
                Realtime::Ignore => format!("connecting to {address}"),
            })?;
            return Ok((robot, None));
        }
        let sim = match self.sim {
            Simulated::Fr3 => Sim::fr3(),
            Simulated::Fer => Sim::fer(),
        };
        // With a hand, and a block of 3 cm between its fingers.
        let block = Fingers::new().with_object(0.03);
        let sim = sim.tool(Tool::hand()).hand(block, 0).start().await;
        let sim = sim.context("starting the simulator")?;
        let robot = Robot::builder(sim.addr())
            .realtime(Realtime::Ignore)
            .connect()
            .await?;
        Ok((robot, Some(sim)))
    }

    /// Connects to the hand beside the robot that [`Self::open`] connected to.
    ///
    /// # Errors
    /// If no hand answers there.
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
