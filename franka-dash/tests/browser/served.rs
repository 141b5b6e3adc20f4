//! A simulated robot with its page.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context as _, ensure};
use axum::Router;
use franka_async::connection::admission::Token;
use franka_async::gripper::Gripper;
use franka_async::model::collision::Obstacle;
use franka_async::motion::Outcome;
use franka_async::nalgebra::Vector3;
use franka_async::{Pose, READY, Realtime, Robot};
use franka_dash::Options;
use franka_sim::{Fingers, Running, Sim, Tool};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::task::JoinHandle;

/// A simulated robot with its page.
pub(crate) struct Served {
    pub(crate) address: SocketAddr,
    pub(crate) robot: Robot,
    pub(crate) gripper: Gripper,
    /// Folder of the recordings.
    pub(crate) folder: PathBuf,
    pub(crate) running: Arc<Running>,
    runtime: Runtime,
}

/// Serves pages that know the address of each viewer; without it, they require a token.
fn serve(listener: TcpListener, pages: Router) {
    let pages = pages.into_make_service_with_connect_info::<SocketAddr>();
    tokio::spawn(axum::serve(listener, pages).into_future());
}

impl Served {
    /// Serves a robot; `name` must be unique in this program.
    pub(crate) fn new(sim: Sim, name: &str) -> anyhow::Result<Self> {
        let runtime = Runtime::new()?;
        let folder =
            std::env::temp_dir().join(format!("franka-dash-{}-{name}", std::process::id()));
        std::fs::create_dir(&folder)?;
        let (address, robot, gripper, running) = runtime.block_on(async {
            let sim = sim.tool(Tool::hand()).hand(Fingers::new(), 0);
            let sim = sim.wait_for_commands(Duration::from_millis(500));
            let running = Arc::new(sim.start().await?);
            let builder = Robot::builder(running.addr()).realtime(Realtime::Ignore);
            let robot = builder.connect().await?;
            let hand = running.hand().context("a hand")?.addr();
            let gripper = Gripper::connect(hand).await?;
            let options = Options::default().allow_motion().simulated(&running);
            let options = options.gripper(gripper.clone()).record_to(&folder);
            let options = options.patience(PATIENCE).keep_out([block()]);
            let listener = franka_dash::bind("127.0.0.1:0".parse()?, &options).await?;
            let address = listener.local_addr()?;
            serve(listener, franka_dash::router(robot.clone(), options));
            anyhow::Ok((address, robot, gripper, running))
        })?;
        Ok(Self {
            address,
            robot,
            gripper,
            folder,
            running,
            runtime,
        })
    }

    /// Serves the page of this robot at another address, until the runtime is dropped.
    pub(crate) fn again(&self, address: SocketAddr) -> anyhow::Result<(SocketAddr, Runtime)> {
        let (runtime, robot) = (Runtime::new()?, self.robot.clone());
        let options = Options::default().simulated(&self.running);
        let address = runtime.block_on(async {
            let listener = franka_dash::bind(address, &options).await?;
            let address = listener.local_addr()?;
            serve(listener, franka_dash::router(robot, options));
            anyhow::Ok(address)
        })?;
        Ok((address, runtime))
    }

    /// Serves the page of this robot and of another robot together.
    pub(crate) fn beside(&self, other: &Self) -> anyhow::Result<SocketAddr> {
        self.runtime.block_on(async {
            let options = Options::default();
            let listener = franka_dash::bind("127.0.0.1:0".parse()?, &options).await?;
            let address = listener.local_addr()?;
            let robots = [("left", &self.robot), ("right", &other.robot)];
            let robots = robots.map(|(name, robot)| (name, robot.clone(), options.clone()));
            serve(listener, franka_dash::several(robots)?);
            Ok(address)
        })
    }

    /// Serves another page of this robot, which requires a token.
    pub(crate) fn with_token(&self, token: &str) -> anyhow::Result<SocketAddr> {
        self.runtime.block_on(async {
            let options = Options::default().token(Token::new(token)?);
            let listener = franka_dash::bind("127.0.0.1:0".parse()?, &options).await?;
            let address = listener.local_addr()?;
            serve(listener, franka_dash::router(self.robot.clone(), options));
            Ok(address)
        })
    }

    /// Turns joint 1 by half a radian, slowly.
    pub(crate) fn turn(&self) -> JoinHandle<Outcome> {
        let robot = self.robot.clone();
        let mut there = robot.state().q;
        there[0] -= 0.5 * there[0].signum();
        self.runtime
            .spawn(async move { robot.move_joints(there).speed(0.2).await })
    }

    /// Moves to the ready pose: robots estimate no external forces near a singularity.
    pub(crate) fn make_ready(&self) -> anyhow::Result<()> {
        let motion = async { self.robot.move_joints(READY).await };
        self.runtime.block_on(motion)?;
        Ok(())
    }

    /// Returns the result of a motion.
    pub(crate) fn outcome(&self, motion: JoinHandle<Outcome>) -> anyhow::Result<Outcome> {
        Ok(self.runtime.block_on(motion)?)
    }

    /// Height of the region that the arm must avoid, `[m]`.
    pub(crate) fn region_top(&self) -> f64 {
        2.0 * BLOCK
    }

    pub(crate) fn height(&self) -> f64 {
        self.robot.pose().translation.z
    }

    /// Checks that the arm has not moved, except for creep at rest.
    pub(crate) fn check_still(&self, before: [f64; 7]) -> anyhow::Result<()> {
        let now = self.robot.state().q;
        let moved = now.iter().zip(before).map(|(q, before)| (q - before).abs());
        ensure!(moved.fold(0.0, f64::max) < 2e-3, "it moved");
        Ok(())
    }

    /// Waits for at most 5 s until the arm is at rest. Afterwards the arm may creep by a
    /// millimetre.
    pub(crate) fn check_rest(&self) -> anyhow::Result<()> {
        let moving = || {
            let state = self.robot.state();
            state.motion_running() || state.dq.iter().any(|dq| dq.abs() > 2e-3)
        };
        wait("the arm to rest", || Ok(!moving()))?;
        let rested = self.height();
        std::thread::sleep(Duration::from_millis(100));
        let crept = (self.height() - rested).abs();
        ensure!(crept < 1e-3, "the arm moved on by {crept} m");
        Ok(())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.runtime.block_on(self.robot.shutdown());
        // Remaining files are harmless.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Waits until `done` is true, for at most 20 s.
pub(crate) fn wait(
    what: &str,
    mut done: impl FnMut() -> anyhow::Result<bool>,
) -> anyhow::Result<()> {
    for _ in 0..1000 {
        if done()? {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    anyhow::bail!("waited for {what} in vain")
}

/// Returns a region to avoid, in front of the arm.
fn block() -> Obstacle {
    Obstacle::Box {
        pose: Pose::translation(0.45, 0.0, BLOCK),
        half: Vector3::new(0.2, 0.2, BLOCK),
    }
}

/// Half of the height of this region, `[m]`.
const BLOCK: f64 = 0.1;

/// Time by which the browser's messages may be later than with a real robot, because a busy machine
/// draws pictures without a graphics card.
pub(crate) const PATIENCE: Duration = Duration::from_secs(2);
