//! A robot that is being simulated.

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

/// A robot that is being simulated. Dropping it stops the simulation within a cycle or two and
/// closes its sockets.
#[derive(Debug)]
pub struct Running {
    pub(super) robot: Service<Robot>,
    pub(super) hand: Option<Service<Hand>>,
    pub(super) vacuum_gripper: Option<Service<VacuumGripper>>,
    /// `None` without virtual time.
    pub(super) speed: Option<Speed>,
    /// Closed by the end of the thread, whichever it is.
    pub(super) finished: watch::Receiver<()>,
}

impl Running {
    /// Where the robot's clients connect to.
    pub fn addr(&self) -> SocketAddr {
        self.robot.addr()
    }

    /// The hand, if there is one: see [`Sim::hand`].
    pub fn hand(&self) -> Option<&Service<Hand>> {
        self.hand.as_ref()
    }

    /// The vacuum gripper, if there is one: see [`Sim::vacuum_gripper`].
    pub fn vacuum_gripper(&self) -> Option<&Service<VacuumGripper>> {
        self.vacuum_gripper.as_ref()
    }

    /// Runs `job` on the robot between two milliseconds, as [`Service::with`] does: push it, press
    /// its stop, close its brakes, read it.
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
    /// As [`Service::with`].
    ///
    /// # Cancel safety
    /// As [`Service::with`].
    pub async fn with<R: Send + 'static>(
        &self,
        job: impl FnOnce(&mut Robot) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.robot.with(job).await
    }

    /// Runs `job` between two milliseconds on the network that states and commands pass: see
    /// [`Sim::network`]. `None` is the host's own. It is also given the network's time, which
    /// begins with the robot's start, or with a network where there was none. What is under way in
    /// a network that is replaced is lost.
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
    /// As [`Service::with`].
    ///
    /// # Cancel safety
    /// As [`Service::with`].
    pub async fn with_network<R: Send + 'static>(
        &self,
        job: impl FnOnce(&mut Option<Network>, Duration) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.robot.with_network(job).await
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
        self.robot.pace().await
    }

    /// Completes when the simulation has ended by itself, which only a panic brings about: in the
    /// simulator, or in what [`with`](Self::with) or [`Sim::every_millisecond`] was given.
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub async fn ended(&self) {
        // Nothing is ever sent: an error is the end.
        let _ = self.finished.clone().changed().await;
    }

    /// Stops the simulation, disconnects its client, and returns once thread and sockets are gone.
    ///
    /// # Cancel safety
    /// Dropping the future stops the simulation all the same, without waiting for it.
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
        // The thread ends when no orders to the robot can come, or has died already.
        robot.close().await;
        let _ = finished.changed().await;
    }
}
