//! Reads every state of the robot, whether the arm moves or not.

use std::ops::ControlFlow;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use franka_proto::RobotState;
use futures::{Stream, StreamExt};
use tokio::sync::broadcast::error::RecvError;
use tokio_stream::wrappers::BroadcastStream;
use tokio_stream::wrappers::errors::BroadcastStreamRecvError;

use crate::error::ReadError;
use crate::publish::Update;
use crate::robot::Robot;

/// A state, and the number of states that were missed before it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reading {
    /// The state.
    pub state: RobotState,
    /// Number of states between the last state of this stream and this one. Each was lost, or the
    /// control thread skipped it for a newer one, or it came while the reader lagged too far
    /// behind. For the first state of a stream, this counts from the creation of the stream.
    pub missed: u64,
}

/// Stream of all states of the robot from now on, each once and in order: see
/// [`Robot::state_stream`].
#[derive(Debug)]
pub struct StateStream {
    updates: BroadcastStream<Update>,
    /// `message_id` of the last state that was returned; at first, of the newest state at the
    /// creation.
    newest: u64,
}

impl Robot {
    /// Calls `each` with every state that comes, whether the arm moves or not, until `each` breaks.
    /// Returns the value of that break.
    ///
    /// ```no_run
    /// # async fn run(robot: franka_async::Robot) -> Result<(), franka_async::error::ReadError> {
    /// use std::ops::ControlFlow;
    ///
    /// let touched = |state: &franka_async::state::RobotState| match state.tau_ext_hat_filtered[1] {
    ///     torque if torque.abs() > 5.0 => ControlFlow::Break(torque),
    ///     _ => ControlFlow::Continue(()),
    /// };
    /// println!("joint 2 is pushed with {} N m", robot.read(touched).await?);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// `each` runs in the task that awaits this future, not on the control thread, and delays only
    /// that task. If `each` takes longer than a millisecond, it lags behind. Once it lags by more
    /// than a second, states are missed; [`Self::state_stream`] reports their number.
    ///
    /// # Errors
    /// Returns [`ReadError::LinkLost`] if the robot has been silent for the link timeout, and at
    /// once if it has already been silent for that time. Returns [`ReadError::ConnectionClosed`] if
    /// the connection has ended.
    ///
    /// # Cancel safety
    /// Dropping the future only ends the reading. No state is kept for a later call.
    pub async fn read<T>(
        &self,
        mut each: impl FnMut(&RobotState) -> ControlFlow<T>,
    ) -> Result<T, ReadError> {
        let link = self.link();
        let mut updates = link.subscriptions().updates();
        let begun = link.newest.state().message_id;
        if let Some(silence) = link.subscriptions().silence(begun)
            && !updates.is_closed()
        {
            return Err(ReadError::LinkLost { silence });
        }
        loop {
            match updates.recv().await {
                Ok(Update::State(state)) if state.message_id <= begun => {}
                Ok(Update::State(state)) => {
                    if let ControlFlow::Break(result) = each(&state) {
                        return Ok(result);
                    }
                }
                Ok(Update::Silence(silence)) => return Err(ReadError::LinkLost { silence }),
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => {
                    let reason = link.channel.closing().reason();
                    return Err(ReadError::ConnectionClosed { reason });
                }
            }
        }
    }

    /// Returns a stream of every state from now on, each once and in order, with the number of
    /// states missed before it. A reader may lag about a second behind before it misses states. The
    /// stream ends when the connection does, pauses while the robot is silent, and does not keep
    /// the connection open.
    ///
    /// To read the newest state at any time, use [`Self::states`]. For the commands and records of
    /// each cycle, use [`Self::records`].
    pub fn state_stream(&self) -> StateStream {
        let link = self.link();
        let updates = BroadcastStream::new(link.subscriptions().updates());
        let newest = link.newest.state().message_id;
        StateStream { updates, newest }
    }
}

impl StateStream {
    /// Returns the next state; `None` once the connection has ended.
    ///
    /// # Cancel safety
    /// Dropping the future loses nothing: the next call returns the state.
    pub async fn next(&mut self) -> Option<Reading> {
        StreamExt::next(self).await
    }
}

impl Stream for StateStream {
    type Item = Reading;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Reading>> {
        loop {
            let state = match ready!(self.updates.poll_next_unpin(context)) {
                Some(Ok(Update::State(state))) => state,
                // The next state reports the length of the gap.
                Some(Ok(Update::Silence(_)) | Err(BroadcastStreamRecvError::Lagged(_))) => continue,
                None => return Poll::Ready(None),
            };
            // States from before the creation of the stream may still come.
            let Some(missed) = state.message_id.checked_sub(self.newest + 1) else {
                continue;
            };
            self.newest = state.message_id;
            let state = *state;
            return Poll::Ready(Some(Reading { state, missed }));
        }
    }
}
