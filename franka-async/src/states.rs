//! Receivers of the newest state as it changes.

use std::pin::Pin;
use std::task::{Context, Poll};

use franka_proto::RobotState;
use futures::{Stream, StreamExt};
use tokio::sync::watch;
use tokio_stream::wrappers::WatchStream;

use crate::close::Closing;
use crate::error::ReadError;

/// A receiver of the newest state of a robot or an end effector as it changes: see
/// [`Robot::states`](crate::Robot::states).
///
/// As a [`Stream`], it yields each change, or the newest of several changes since the last item. It
/// ends with the connection. A clone begins with the newest state at the time of cloning.
///
/// All methods return copies of states. A borrow would lock out the task that publishes states and
/// serves `stop`. If a borrow were held across an await, both tasks would wait for each other.
#[derive(Debug)]
pub struct States<S = RobotState> {
    published: watch::Receiver<S>,
    changes: WatchStream<S>,
    closing: Closing,
}

impl<S: Copy + Send + Sync + 'static> States<S> {
    /// Returns the changes of `published` from now on; `closing` contains the reason for the end.
    pub(crate) fn new(mut published: watch::Receiver<S>, closing: Closing) -> Self {
        published.mark_unchanged();
        Self {
            changes: WatchStream::from_changes(published.clone()),
            published,
            closing,
        }
    }

    /// Returns the newest state that was published.
    pub fn newest(&self) -> S {
        *self.published.borrow()
    }

    /// Waits for a change that neither this method nor the stream has returned, and returns the
    /// newest state. [`newest`](Self::newest) may have returned that state before.
    ///
    /// # Errors
    /// Returns [`ReadError::ConnectionClosed`] if the connection has ended.
    ///
    /// # Cancel safety
    /// Dropping the future loses nothing: the next call returns the state.
    pub async fn changed(&mut self) -> Result<S, ReadError> {
        let state = self.changes.next().await;
        state.ok_or_else(|| ReadError::ConnectionClosed {
            reason: self.closing.reason(),
        })
    }

    /// Waits for a state that satisfies `condition`, including the present one, and returns it.
    /// States that are replaced before this task runs are not tested; to test every state, use
    /// [`Robot::read`](crate::Robot::read). The wait has no time limit except the end of the
    /// connection, because only the caller knows when the state should come.
    ///
    /// # Errors
    /// Returns [`ReadError::ConnectionClosed`] if the connection has ended.
    ///
    /// # Cancel safety
    /// If the future is dropped, a later call begins with the newest state.
    pub async fn wait_for(
        &mut self,
        mut condition: impl FnMut(&S) -> bool,
    ) -> Result<S, ReadError> {
        let mut state = self.newest();
        while !condition(&state) {
            state = self.changed().await?;
        }
        Ok(state)
    }
}

impl<S: Copy + Send + Sync + 'static> Clone for States<S> {
    fn clone(&self) -> Self {
        Self::new(self.published.clone(), self.closing.clone())
    }
}

impl<S: Copy + Send + Sync + 'static> Stream for States<S> {
    type Item = S;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<S>> {
        self.changes.poll_next_unpin(context)
    }
}

#[cfg(test)]
mod tests {
    use franka_rt::lifecycle::CloseReason;
    use futures::FutureExt;

    use super::*;

    fn state(message_id: u64) -> RobotState {
        RobotState {
            message_id,
            ..RobotState::default()
        }
    }

    #[test]
    fn changes_come_once_each_and_end_with_the_reason() {
        let (publisher, published) = watch::channel(state(1));
        let closing = Closing::default();
        let mut states = States::new(published, closing.clone());
        assert_eq!(states.newest().message_id, 1);
        assert_eq!(states.changed().now_or_never(), None);
        publisher.send_replace(state(2));
        publisher.send_replace(state(3));
        assert_eq!(states.changed().now_or_never(), Some(Ok(state(3))));
        assert_eq!(states.changed().now_or_never(), None);
        let mut clone = states.clone();
        assert_eq!(clone.changed().now_or_never(), None);
        closing.note(CloseReason::ClosedByPeer);
        drop(publisher);
        let reason = CloseReason::ClosedByPeer;
        assert_eq!(
            clone.changed().now_or_never(),
            Some(Err(ReadError::ConnectionClosed { reason }))
        );
        assert_eq!(states.next().now_or_never(), Some(None));
    }

    #[test]
    fn a_state_in_hand_does_not_keep_the_publisher_waiting() {
        let (publisher, published) = watch::channel(state(1));
        let mut states = States::new(published, Closing::default());
        let held = states.newest();
        // A held borrow of the watch channel would block this thread here indefinitely.
        publisher.send_replace(state(2));
        assert_eq!(held.message_id, 1);
        let waited = states.wait_for(|state| state.message_id == 2);
        assert_eq!(waited.now_or_never(), Some(Ok(state(2))));
    }
}
