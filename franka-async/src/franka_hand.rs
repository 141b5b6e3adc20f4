//! The Franka Hand.

use std::net::SocketAddr;

use crate::device_connection::DeviceConnection;
use crate::endpoint::Endpoint;
use crate::error::{ConnectError, GripperError};
#[cfg(feature = "record")]
use crate::journal::Journal;
use crate::states::States;
use franka_proto::gripper::{Grasp, Move, Request, State, Version};

/// A connected Franka Hand. It has its own server besides the robot's, and neither waits for the
/// other.
///
/// A cheap handle: clones share one connection, from any task or thread. One action runs at a time:
/// a newer one aborts it, and so does [`Gripper::stop`], from any handle. Dropping the last handle
/// closes the connection; a grasped object stays grasped.
///
/// Actions have no deadline, since some take long: a move that an obstacle blocks takes minutes.
/// Put `tokio::time::timeout` around an action to give it up, which stops it. If the Hand is out of
/// reach, the connection's keepalive ends its actions within seconds.
///
/// Connecting needs a Tokio runtime with I/O and time enabled, which then runs the task of the
/// connection. Everything else may be called and awaited from anywhere.
#[derive(Clone, Debug)]
pub struct Gripper {
    connection: DeviceConnection<Version>,
}

impl Gripper {
    /// Connects to the Hand at `endpoint`: TCP, handshake, first state; each step may take 1 s. The
    /// port is 1338 unless given.
    ///
    /// # Errors
    /// [`ConnectError`]; nothing is left behind.
    ///
    /// # Cancel safety
    /// Dropping the future closes everything that was opened.
    pub async fn connect(endpoint: impl Into<Endpoint>) -> Result<Self, ConnectError<Version>> {
        let connection = DeviceConnection::connect(endpoint.into()).await?;
        Ok(Self { connection })
    }

    /// Address of the Hand.
    pub fn address(&self) -> SocketAddr {
        self.connection.address()
    }

    #[cfg(feature = "record")]
    pub(crate) fn journal(&self) -> &Journal {
        self.connection.journal()
    }

    /// The newest state.
    pub fn state(&self) -> State {
        self.connection.state()
    }

    /// The newest state as it changes. Ends when the connection does.
    pub fn states(&self) -> States<State> {
        self.connection.states()
    }

    /// Finds how wide the fingers open: `max_width` of the state. Needed once after power-on and
    /// after a change of fingers; until then, wider grasps and moves are refused. True if it
    /// succeeded.
    ///
    /// # Errors
    /// [`GripperError`].
    ///
    /// # Cancel safety
    /// Dropping the future stops the fingers, unless a newer action has taken over or the future
    /// was never polled.
    pub async fn homing(&self) -> Result<bool, GripperError> {
        self.connection.act(Request::Homing).await
    }

    /// Moves the fingers to `width` `[m]` at `speed` `[m/s]`. True if they arrived.
    ///
    /// # Errors
    /// [`GripperError`].
    ///
    /// # Cancel safety
    /// See [`Self::homing`].
    pub async fn move_to(&self, width: f64, speed: f64) -> Result<bool, GripperError> {
        self.connection
            .act(Request::Move(Move { width, speed }))
            .await
    }

    /// Closes the fingers on an object. True if they ended within the tolerances of its width; the
    /// force stays applied either way, until the next action or a stop.
    ///
    /// # Errors
    /// [`GripperError`].
    ///
    /// # Cancel safety
    /// See [`Self::homing`]. Once the future has resolved, only another request releases the
    /// object.
    pub async fn grasp(&self, grasp: Grasp) -> Result<bool, GripperError> {
        self.connection.act(Request::Grasp(grasp)).await
    }

    /// Stops the fingers and releases the object. The action that runs resolves as aborted. True if
    /// it succeeded.
    ///
    /// # Errors
    /// [`GripperError`].
    ///
    /// # Cancel safety
    /// Once the future is polled, the fingers still stop.
    pub async fn stop(&self) -> Result<bool, GripperError> {
        self.connection.act(Request::Stop).await
    }
}
