//! A simulated robot with its page.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use anyhow::ensure;
use franka_async::{Realtime, Robot};
use franka_dash::Options;
use franka_sim::{Running, Sim};
use tokio::runtime::Runtime;

/// A simulated robot with its page.
pub(crate) struct Served {
    pub(crate) address: SocketAddr,
    pub(crate) robot: Robot,
    runtime: Runtime,
    _running: Arc<Running>,
}

impl Served {
    pub(crate) fn new(sim: Sim) -> anyhow::Result<Self> {
        let runtime = Runtime::new()?;
        let (address, robot, running) = runtime.block_on(async {
            let sim = sim.wait_for_commands(Duration::from_millis(500));
            let running = Arc::new(sim.start().await?);
            let builder = Robot::builder(running.addr()).realtime(Realtime::Ignore);
            let robot = builder.connect().await?;
            let options = Options::default().allow_motion().simulated(&running);
            let options = options.patience(PATIENCE);
            let listener = franka_dash::bind("127.0.0.1:0".parse()?, &options).await?;
            let address = listener.local_addr()?;
            let router = franka_dash::router(robot.clone(), options);
            tokio::spawn(async move { axum::serve(listener, router).await });
            anyhow::Ok((address, robot, running))
        })?;
        Ok(Self {
            address,
            robot,
            runtime,
            _running: running,
        })
    }

    pub(crate) fn height(&self) -> f64 {
        self.robot.pose().translation.z
    }

    /// Waits until the arm rests: it has 5 s for that, and then may creep by a millimetre.
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
    }
}

/// Waits until `done`, 20 s at most.
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

/// How much later than on a robot the browser may send: pictures are drawn without a graphics card,
/// beside whatever else the machine does.
pub(crate) const PATIENCE: Duration = Duration::from_secs(2);
