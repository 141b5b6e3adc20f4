//! A running simulated robot.

use std::net::SocketAddr;
use std::time::Duration;

use franka_proto::RobotState;
use tokio::sync::watch;

#[cfg(doc)]
use super::Sim;
use super::speed::Speed;
use super::{Pace, Service, Stopped};
use crate::end_effector::{Hand, VacuumGripper};
use crate::network::Network;
use crate::robot::Robot;

/// A running simulated robot. Dropping this value stops the simulation within a cycle or two and
/// closes its sockets.
#[derive(Debug)]
pub struct Running {
    pub(super) robot: Service<Robot>,
    pub(super) hand: Option<Service<Hand>>,
    pub(super) vacuum_gripper: Option<Service<VacuumGripper>>,
    /// Speed of robot time; `None` without virtual time.
    pub(super) speed: Option<Speed>,
    /// Channel that closes when the thread ends for any reason.
    pub(super) finished: watch::Receiver<()>,
}

impl Running {
    /// Returns the address to which clients of the robot connect.
    pub fn addr(&self) -> SocketAddr {
        self.robot.addr()
    }

    /// Returns the hand, if any: see [`Sim::hand`].
    pub fn hand(&self) -> Option<&Service<Hand>> {
        self.hand.as_ref()
    }

    /// Returns the vacuum gripper, if any: see [`Sim::vacuum_gripper`].
    pub fn vacuum_gripper(&self) -> Option<&Service<VacuumGripper>> {
        self.vacuum_gripper.as_ref()
    }

    /// Runs `job` on the robot between two milliseconds, as [`Service::with`] does. For example,
    /// `job` can push the arm, press the user stop, close the brakes, or read the robot.
    ///
    /// ```
    /// # use franka_sim::{Sim, Touch};
    /// # #[tokio::main(flavor = "current_thread")]
    /// # async fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let sim = Sim::fr3().start().await?;
    /// sim.with(|robot| robot.press_user_stop(true)).await?;
    /// # sim.stop().await;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// See [`Service::with`].
    ///
    /// # Cancel safety
    /// See [`Service::with`].
    pub async fn with<R: Send + 'static>(
        &self,
        job: impl FnOnce(&mut Robot) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.robot.with(job).await
    }

    /// Runs `job` between two milliseconds on the simulated network between the robot and its
    /// client: see [`Sim::network`]. The network is `None` if datagrams pass only the host's
    /// network. `job` also receives the network's time, which begins when the robot starts or when
    /// the first network is set. If `job` replaces the network, the datagrams in transit are lost.
    ///
    /// ```
    /// # use std::time::Duration;
    /// # use franka_sim::{Network, Sim};
    /// # #[tokio::main(flavor = "current_thread")]
    /// # async fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let sim = Sim::fr3().start().await?;
    /// // No state arrives for 30 ms.
    /// sim.with_network(|network, now| {
    ///     let network = network.get_or_insert_with(Network::perfect);
    ///     network.to_client.cut(now..now + Duration::from_millis(30));
    /// })
    /// .await?;
    /// # sim.stop().await;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// See [`Service::with`].
    ///
    /// # Cancel safety
    /// See [`Service::with`].
    pub async fn with_network<R: Send + 'static>(
        &self,
        job: impl FnOnce(&mut Option<Network>, Duration) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.robot.with_network(job).await
    }

    /// Returns the newest state, in double precision.
    ///
    /// # Errors
    /// See [`with`](Self::with).
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub async fn state(&self) -> Result<RobotState, Stopped> {
        self.with(|robot| *robot.state()).await
    }

    /// Returns the timing record of the simulator's thread so far.
    ///
    /// # Errors
    /// See [`with`](Self::with).
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub async fn pace(&self) -> Result<Pace, Stopped> {
        self.robot.pace().await
    }

    /// Completes when the simulation has ended, although no caller stopped it. Only a panic causes
    /// such an end: a panic in the simulator, or in a function passed to [`with`](Self::with) or
    /// [`Sim::every_millisecond`].
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub async fn ended(&self) {
        // Nothing is ever sent; the error signals the end.
        let _ = self.finished.clone().changed().await;
    }

    /// Stops the simulation, disconnects its client, and returns once the thread has ended and the
    /// sockets are closed.
    ///
    /// # Cancel safety
    /// Dropping the future still stops the simulation, without waiting for it.
    pub async fn stop(self) {
        let Self {
            robot,
            hand,
            vacuum_gripper,
            speed: _,
            mut finished,
        } = self;
        if let Some(hand) = hand {
            hand.close().await;
        }
        if let Some(gripper) = vacuum_gripper {
            gripper.close().await;
        }
        // The thread ends when the robot can receive no more orders, unless it has already ended.
        robot.close().await;
        let _ = finished.changed().await;
    }
}
