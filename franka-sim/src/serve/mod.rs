//! The simulated robot on real sockets.
//!
//! ```text
//!  Tokio: listener ── bytes, hands ──> queue ──> cycle thread: Robot, UDP socket, 1 kHz
//!            └──────── replies <────── queue <──────┘
//! ```
//!
//! The thread owns robot and UDP socket and keeps the millisecond; whatever blocks the Tokio
//! runtime delays requests and replies, and no state.

mod cycle;
mod tcp;

pub use cycle::Pace;

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};

use franka_model::{JointVector, Load, RobotKind};
use franka_proto::RobotState;
use tokio::net::TcpListener;
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use crate::config::{Config, Noise, Tool};
use crate::robot::Robot;
use cycle::{Cycle, Order};

/// A robot to be simulated: configure, then [`start`](Self::start).
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
#[derive(Debug, Clone)]
pub struct Sim {
    config: Config,
    bind: SocketAddr,
}

impl Sim {
    /// A Franka Research 3 with a bare flange in the ready pose, on a free port of 127.0.0.1.
    pub fn fr3() -> Self {
        Self::new(Config::default())
    }

    /// A Franka Emika Robot (Panda) with a bare flange in the ready pose, on a free port of 127.0.0.1.
    pub fn fer() -> Self {
        Self::new(Config {
            kind: RobotKind::Fer,
            ..Config::default()
        })
    }

    /// A robot of this make-up, on a free port of 127.0.0.1.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            bind: SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0),
        }
    }

    /// Listens on `address`; port 0 takes a free one. Robots listen on 1337.
    pub fn bind(mut self, address: SocketAddr) -> Self {
        self.bind = address;
        self
    }

    /// Starts with the joints at `q`, `[rad]`.
    pub fn q(mut self, q: JointVector) -> Self {
        self.config.q = q;
        self
    }

    /// Mounts a tool that the robot knows of.
    pub fn tool(mut self, tool: Tool) -> Self {
        self.config.tool = tool;
        self
    }

    /// Hangs a load on the flange that nobody has declared to the robot.
    pub fn payload(mut self, payload: Load) -> Self {
        self.config.payload = payload;
        self
    }

    /// Makes the sensors noisy.
    pub fn noise(mut self, noise: Noise) -> Self {
        self.config.noise = noise;
        self
    }

    /// Seeds all randomness.
    pub fn seed(mut self, seed: u64) -> Self {
        self.config.seed = seed;
        self
    }

    /// See [`Config::enforce_limits`].
    pub fn enforce_limits(mut self, enforce: bool) -> Self {
        self.config.enforce_limits = enforce;
        self
    }

    /// See [`Config::enforce_communication`].
    pub fn enforce_communication(mut self, enforce: bool) -> Self {
        self.config.enforce_communication = enforce;
        self
    }

    /// Starts the robot. Must be called within a Tokio runtime with I/O and time enabled; any
    /// number of robots may run in one process.
    ///
    /// # Errors
    /// Those of binding the sockets and of starting the thread.
    ///
    /// # Cancel safety
    /// Dropping the future before it completes leaves nothing behind.
    pub async fn start(self) -> io::Result<Running> {
        let listener = TcpListener::bind(self.bind).await?;
        let address = listener.local_addr()?;
        let socket = UdpSocket::bind(SocketAddr::new(address.ip(), 0))?;
        socket.set_nonblocking(true)?;
        let (orders, inbox) = mpsc::channel(QUEUE);
        let (done, finished) = oneshot::channel();
        let cycle = Cycle::new(Robot::new(self.config), socket, inbox);
        std::thread::Builder::new()
            .name("franka-sim".into())
            .spawn(move || {
                cycle.run();
                // Nobody may be waiting for it.
                let _ = done.send(());
            })?;
        let server = tokio::spawn(tcp::serve(listener, orders.clone()));
        Ok(Running {
            address,
            orders,
            server,
            finished,
        })
    }
}

/// A robot that is being simulated. Dropping it stops the simulation within a cycle or two and
/// closes its sockets.
#[derive(Debug)]
pub struct Running {
    address: SocketAddr,
    orders: mpsc::Sender<Order>,
    server: JoinHandle<()>,
    finished: oneshot::Receiver<()>,
}

/// The simulation has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the simulated robot has stopped")]
pub struct Stopped;

impl Running {
    /// Where clients connect to.
    pub fn addr(&self) -> SocketAddr {
        self.address
    }

    /// Does something with the robot between two milliseconds: push it, read it, press its stop.
    /// `hands` runs on the thread that keeps the cycle, so it should not take long.
    ///
    /// # Errors
    /// [`Stopped`] if the simulation has ended, which only a panic in another `hands` brings about.
    ///
    /// # Cancel safety
    /// Once polled, `hands` may run although the future is dropped.
    pub async fn with<R: Send + 'static>(
        &self,
        hands: impl FnOnce(&mut Robot) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        let (answer, result) = oneshot::channel();
        let order = Order::Hands(Box::new(move |robot| {
            // Whoever asked may have gone.
            let _ = answer.send(hands(robot));
        }));
        self.orders.send(order).await.map_err(|_| Stopped)?;
        result.await.map_err(|_| Stopped)
    }

    /// The newest state, in full precision.
    ///
    /// # Errors
    /// As [`with`](Self::with).
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub async fn state(&self) -> Result<RobotState, Stopped> {
        self.with(|robot| *robot.state()).await
    }

    /// How well the thread has kept the millisecond so far.
    ///
    /// # Errors
    /// As [`with`](Self::with).
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub async fn pace(&self) -> Result<Pace, Stopped> {
        let (answer, pace) = oneshot::channel();
        let order = Order::Pace(answer);
        self.orders.send(order).await.map_err(|_| Stopped)?;
        pace.await.map_err(|_| Stopped)
    }

    /// Stops the simulation, disconnects its client, and returns once thread and sockets are gone.
    ///
    /// # Cancel safety
    /// Dropping the future stops the simulation all the same, without waiting for it.
    pub async fn stop(mut self) {
        self.server.abort();
        // An aborted task ends with an error, the intended one.
        let _ = (&mut self.server).await;
        // The thread ends when the last sender is gone, or at once if it has died already.
        let (closed, _) = mpsc::channel(1);
        self.orders = closed;
        let _ = (&mut self.finished).await;
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.server.abort();
    }
}

/// Orders that may wait for the thread: portions of stream bytes and hands. It takes all of them
/// every millisecond.
const QUEUE: usize = 64;

#[cfg(test)]
mod tests;
