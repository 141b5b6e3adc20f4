//! One connection to a robot, with everything that ends with it.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use franka_rt::lifecycle::{CloseReason, MotionError};
use franka_rt::sched::Granted;
use franka_rt::stats::Stats;
use franka_rt::thread::{CycleFeed, Lender};

use crate::command_channel::Channel;
use crate::geometry_check::GeometryCheck;
use crate::input::{BridgeHandle, Input};
use crate::newest_state::Newest;
use crate::progress::Course;
use crate::publish::Subscriptions;
use crate::thresholds::Thresholds;
use crate::world;

/// One connection to a robot. Dropping it brakes the arm, ends the motion and closes the
/// connection, in the background.
pub(crate) struct Link {
    pub(crate) address: SocketAddr,
    /// Hash of the robot's description or model library, if it sent one.
    pub(crate) description: Option<u64>,
    pub(crate) geometry: GeometryCheck,
    pub(crate) bridge: BridgeHandle,
    pub(crate) channel: Channel,
    pub(crate) newest: Newest,
    pub(crate) course: Course,
    pub(crate) thresholds: Thresholds,
    pub(crate) stats: Arc<Stats>,
    pub(crate) granted: Arc<Granted>,
    pub(crate) lender: Lender,
    pub(crate) cycles: CycleFeed,
}

impl Link {
    /// Sends an input to the bridge. A bridge that has ended drops the input and the sender of its
    /// reply; the receiver notices this.
    pub(crate) fn send(&self, input: Input) {
        let _ = self.try_send(input);
    }

    /// Sends an input as [`Self::send`] does, but returns it if the bridge has ended.
    #[expect(
        clippy::result_large_err,
        reason = "it goes back to where it came from"
    )]
    pub(crate) fn try_send(&self, input: Input) -> Result<(), Input> {
        self.bridge.inbox.send(input).map_err(|unsent| unsent.0)
    }

    pub(crate) fn subscriptions(&self) -> &Subscriptions {
        &self.bridge.subscriptions
    }

    /// True if the bridge accepts no more inputs.
    pub(crate) fn has_ended(&self) -> bool {
        self.bridge.inbox.is_closed()
    }

    /// Returns the silence for which the link was given up, if no state has come since.
    pub(crate) fn silence(&self) -> Option<Duration> {
        let newest = self.newest.state().message_id;
        self.subscriptions().silence(newest)
    }

    /// Waits until the link has been given up and no state has come for another `more`. Returns the
    /// whole silence.
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub(crate) async fn stays_silent(&self, more: Duration) -> Duration {
        const LOOK: Duration = Duration::from_millis(50);
        let mut since = None;
        loop {
            match self.silence() {
                None => since = None,
                Some(silence) => {
                    let waited = world::now() - *since.get_or_insert_with(world::now);
                    if waited >= more {
                        return silence + waited;
                    }
                }
            }
            world::sleep(LOOK).await;
        }
    }

    /// Waits until the connection has ended, and returns the reason.
    ///
    /// # Cancel safety
    /// Dropping the future has no effect.
    pub(crate) async fn ended(&self) -> CloseReason {
        self.bridge.inbox.closed().await;
        self.channel.closing().reason()
    }

    /// Returns the error for requests to a connection that has ended.
    pub(crate) fn closed(&self) -> MotionError {
        let reason = self.channel.closing().reason();
        MotionError::ConnectionClosed { reason }
    }
}
