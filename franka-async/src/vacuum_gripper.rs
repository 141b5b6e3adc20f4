//! The vacuum gripper.

use std::net::SocketAddr;
use std::time::Duration;

use crate::device_connection::DeviceConnection;
use crate::endpoint::Endpoint;
use crate::error::{ConnectError, VacuumGripperError};
#[cfg(feature = "record")]
use crate::journal::Journal;
use crate::states::States;
use franka_proto::vacuum::{Request, State, Vacuum, Version};

/// A connected vacuum gripper. Its handles and actions behave as for the
/// [`Gripper`](crate::gripper::Gripper).
#[derive(Clone, Debug)]
pub struct VacuumGripper {
    connection: DeviceConnection<Version>,
}

impl VacuumGripper {
    /// Connects to the gripper at `endpoint`, and resolves when the first state has come. The TCP
    /// connection, the handshake and the first state may take 1 s each. The default port is 1339.
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

    /// Returns the address of the gripper.
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

    /// Picks up an object by vacuum and holds it. Returns true if the vacuum was reached in time.
    ///
    /// # Errors
    /// Returns [`VacuumGripperError`] if the gripper does not carry out the action.
    ///
    /// # Cancel safety
    /// Dropping the future stops the pump, unless a newer action has taken over or the future was
    /// never polled.
    pub async fn vacuum(&self, vacuum: Vacuum) -> Result<bool, VacuumGripperError> {
        self.connection.act(Request::Vacuum(vacuum)).await
    }

    /// Drops the object. Returns true if the gripper did this within `timeout`, which is sent in
    /// whole milliseconds.
    ///
    /// # Errors
    /// See [`Self::vacuum`].
    ///
    /// # Cancel safety
    /// See [`Self::vacuum`].
    pub async fn drop_off(&self, timeout: Duration) -> Result<bool, VacuumGripperError> {
        let timeout = i64::try_from(timeout.as_millis()).unwrap_or(i64::MAX);
        self.connection.act(Request::DropOff { timeout }).await
    }

    /// Stops the running action, which resolves as aborted. Returns true on success.
    ///
    /// # Errors
    /// See [`Self::vacuum`].
    ///
    /// # Cancel safety
    /// Once the future has been polled, the gripper stops, even if the future is then dropped.
    pub async fn stop(&self) -> Result<bool, VacuumGripperError> {
        self.connection.act(Request::Stop).await
    }
}
