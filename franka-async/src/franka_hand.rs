//! The Franka Hand.

use std::net::SocketAddr;

use crate::device_connection::DeviceConnection;
use crate::endpoint::Endpoint;
use crate::error::{ConnectError, GripperError};
#[cfg(feature = "record")]
use crate::journal::Journal;
use crate::states::States;
use franka_proto::gripper::{Grasp, Move, Request, State, Version};

/// A connected Franka Hand. The Hand has its own server, independent of the robot's.
///
/// This is a cheap handle: all clones share one connection, and may be used from any task or
/// thread. One action runs at a time: a newer action or [`Gripper::stop`], from any handle, aborts
/// the running action. Dropping the last handle closes the connection; a grasped object stays
/// grasped.
///
/// Actions have no deadline, because some take long: a blocked move takes minutes. To limit the
/// time of an action, use `tokio::time::timeout`; when it expires, the fingers stop. If the Hand is
/// out of reach, the keepalive of the connection ends its actions within seconds.
///
/// Connecting needs a Tokio runtime with I/O and time enabled, which then runs the task of the
/// connection. Everything else may be called and awaited from anywhere.
#[derive(Clone, Debug)]
pub struct Gripper {
    connection: DeviceConnection<Version>,
}

impl Gripper {
    /// Connects to the Hand at `endpoint`, and resolves when the first state has come. The TCP
    /// connection, the handshake and the first state may take 1 s each. The default port is 1338.
    ///
    /// # Errors
    /// Returns [`ConnectError`] if there is no connection.
    ///
    /// # Cancel safety
    /// Dropping the future closes everything that was opened.
    pub async fn connect(endpoint: impl Into<Endpoint>) -> Result<Self, ConnectError<Version>> {
        let connection = DeviceConnection::connect(endpoint.into()).await?;
        Ok(Self { connection })
    }

    /// Returns the address of the Hand.
    pub fn address(&self) -> SocketAddr {
        self.connection.address()
    }

    #[cfg(feature = "record")]
    pub(crate) fn journal(&self) -> &Journal {
        self.connection.journal()
    }

    /// Returns the newest state.
    pub fn state(&self) -> State {
        self.connection.state()
    }

    /// Returns a receiver that waits for newer states. It ends with the connection.
    pub fn states(&self) -> States<State> {
        self.connection.states()
    }

    /// Measures the largest opening width of the fingers (`max_width` of the state). This is needed
    /// once after power-on and after a change of fingers. Until then, the Hand refuses every width
    /// above the old `max_width`. Returns true on success.
    ///
    /// # Errors
    /// Returns [`GripperError`] if the Hand does not carry out the action.
    ///
    /// # Cancel safety
    /// Dropping the future stops the fingers, unless a newer action has taken over or the future
    /// was never polled.
    pub async fn homing(&self) -> Result<bool, GripperError> {
        self.connection.act(Request::Homing).await
    }

    /// Moves the fingers to `width` `[m]` at `speed` `[m/s]`. Returns true if the fingers arrived.
    ///
    /// # Errors
    /// See [`Self::homing`].
    ///
    /// # Cancel safety
    /// See [`Self::homing`].
    pub async fn move_to(&self, width: f64, speed: f64) -> Result<bool, GripperError> {
        self.connection
            .act(Request::Move(Move { width, speed }))
            .await
    }

    /// Closes the fingers on an object. Returns true if the fingers stopped within the tolerances
    /// of the object's width. In any case, the force stays applied until the next action or a stop.
    ///
    /// # Errors
    /// See [`Self::homing`].
    ///
    /// # Cancel safety
    /// See [`Self::homing`]. Once the future has resolved, only another request releases the
    /// object.
    pub async fn grasp(&self, grasp: Grasp) -> Result<bool, GripperError> {
        self.connection.act(Request::Grasp(grasp)).await
    }

    /// Stops the fingers and releases the object. The running action resolves as aborted. Returns
    /// true on success.
    ///
    /// # Errors
    /// See [`Self::homing`].
    ///
    /// # Cancel safety
    /// Once the future has been polled, the fingers stop, even if the future is then dropped.
    pub async fn stop(&self) -> Result<bool, GripperError> {
        self.connection.act(Request::Stop).await
    }
}
