//! The end of a connection: the moving arm is stopped, pending calls are resolved, and the control
//! thread ends.

use std::time::Duration;

use franka_rt::lifecycle::{CloseReason, MotionError};
use franka_rt::session::GoalId;
use tokio::sync::{mpsc, oneshot};

use super::{Bridge, BridgePhase};
use crate::input::Input;
use crate::world;

/// The goal that stops the arm when the last handle is dropped. Handles never use this id, because
/// they count up from 1.
pub(super) const CLOSING: GoalId = GoalId(u64::MAX);

/// Time limit for a motion to brake and finish when the last handle is dropped.
const CLOSING_TIMEOUT: Duration = Duration::from_secs(15);

/// Time limit for an arm on its way to a goal to stop when the connection is lost. After that, the
/// thread that brakes the arm ends.
const BRAKING_TIMEOUT: Duration = Duration::from_secs(3);

/// Time limit for the control thread to end. One cycle is normally enough.
const ENDING_TIMEOUT: Duration = Duration::from_secs(2);

impl Bridge {
    /// Brakes the arm if it moves, and accepts no more inputs.
    pub(super) fn begin_closing(&mut self) {
        self.drop_plans(MotionError::Stopped);
        let now = self.now();
        self.lifecycle.stop(CLOSING, &self.publisher.state(), now);
        let until = world::now() + CLOSING_TIMEOUT;
        self.phase = BridgePhase::Closing { until };
    }

    /// Notes that the robot or the thread is out of reach. The connection ends after an arm on its
    /// way to a goal has been braked: otherwise the thread would continue towards a goal that no
    /// caller can cancel.
    pub(super) fn lose(&mut self, reason: CloseReason) {
        let reason = self.channel.closing().note(reason);
        // Report this before the motions resolve, so that the next call finds a lost connection.
        self.supervisor.on_lost(reason.clone());
        self.lifecycle.on_connection_closed(reason.clone());
        self.drop_plans(MotionError::ConnectionClosed { reason });
        self.phase = BridgePhase::Lost;
    }

    /// Resolves pending calls, brakes an arm that moves, closes the connection and ends the thread.
    /// Requests to shut down that come meanwhile are added to `done`.
    pub(super) async fn end(
        mut self,
        mut inbox: mpsc::UnboundedReceiver<Input>,
        done: &mut Vec<oneshot::Sender<()>>,
    ) {
        let reason = self.channel.closing().note(CloseReason::ClosedByUs);
        inbox.close();
        self.supervisor.on_lost(reason.clone());
        self.lifecycle.on_connection_closed(reason.clone());
        let closed = reason.clone();
        self.drop_plans(MotionError::ConnectionClosed { reason: closed });
        self.carry_out();
        while let Some(input) = inbox.recv().await {
            match input {
                Input::Shutdown { ended: reply } => done.push(reply),
                Input::Begin { motion, replies } => {
                    let reason = reason.clone();
                    self.refuse(
                        motion.motion.id(),
                        replies,
                        MotionError::ConnectionClosed { reason },
                    );
                }
                // A caller that waits for another answer notices the end because its channel
                // closes.
                _ => {}
            }
        }
        self.rest().await;
        if let Some(connection) = self.connection.take() {
            connection.close().await;
        }
        if !self.ends().await {
            // The thread continues without this connection, because nothing can end it from
            // outside.
            tracing::error!(
                "the control thread did not end, because its control function did not return"
            );
        } else if let Some(thread) = self.thread.take() {
            match world::spawn_blocking(move || thread.join()).await {
                Ok(Ok(_)) => {}
                Ok(Err(panicked)) => tracing::error!(%panicked, "control thread"),
                Err(error) => tracing::error!(%error, "control thread"),
            }
        }
    }

    /// Stops the thread, and returns true if it has ended within [`ENDING_TIMEOUT`].
    async fn ends(&mut self) -> bool {
        if let Some(thread) = &self.thread {
            thread.stop();
        }
        let deadline = world::now() + ENDING_TIMEOUT;
        while !self.thread_has_ended() {
            let woken = world::timeout_at(deadline, self.wake.woken()).await;
            if !matches!(woken, Ok(Ok(()))) {
                return false;
            }
        }
        true
    }

    /// Waits until an arm that is being braked rests, for [`BRAKING_TIMEOUT`] at most.
    async fn rest(&mut self) {
        let deadline = world::now() + BRAKING_TIMEOUT;
        while self.lifecycle.is_braking() && !self.thread_has_ended() {
            match world::timeout_at(deadline, self.wake.woken()).await {
                Ok(Ok(())) => self.on_wakeup(),
                Ok(Err(_)) | Err(_) => {
                    tracing::warn!(
                        "no state showed the arm at rest in time; ending the control thread"
                    );
                    break;
                }
            }
        }
    }
}

/// Also runs when the runtime drops the task.
impl Drop for Bridge {
    fn drop(&mut self) {
        self.supervisor.on_lost(self.channel.closing().reason());
        self.supervisor.on_released();
    }
}
