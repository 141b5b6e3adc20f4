//! Events of a robot, as a stream.

use std::pin::Pin;
use std::task::{Context, Poll, ready};

use franka_rt::supervision::Event;
use futures::{Stream, StreamExt};
use tokio::sync::broadcast;
use tokio_stream::wrappers::BroadcastStream;
use tokio_stream::wrappers::errors::BroadcastStreamRecvError;

/// Number of events by which a slow listener may lag before it misses events.
pub(crate) const CAPACITY: usize = 256;

/// An event, and the number of events that are missing before it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Notification {
    /// The event.
    pub event: Event,
    /// Number of events that were dropped just before this event, because the listener was more
    /// than 256 events behind.
    pub missed: u64,
}

/// Stream of the events of a robot from now on, each once and in order: see
/// [`Robot::events`](crate::Robot::events).
#[derive(Debug)]
pub struct Events {
    events: BroadcastStream<Event>,
    missed: u64,
}

impl Events {
    pub(crate) fn new(events: broadcast::Receiver<Event>) -> Self {
        Self {
            events: BroadcastStream::new(events),
            missed: 0,
        }
    }

    /// Returns the next event; `None` after the last one, when no further connection will come.
    ///
    /// # Cancel safety
    /// Dropping the future loses nothing: the next call returns the event.
    pub async fn next(&mut self) -> Option<Notification> {
        StreamExt::next(self).await
    }
}

impl Stream for Events {
    type Item = Notification;

    fn poll_next(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Notification>> {
        loop {
            match ready!(self.events.poll_next_unpin(context)) {
                Some(Ok(event)) => {
                    let missed = std::mem::take(&mut self.missed);
                    return Poll::Ready(Some(Notification { event, missed }));
                }
                Some(Err(BroadcastStreamRecvError::Lagged(missed))) => self.missed += missed,
                None => return Poll::Ready(None),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use franka_proto::RobotState;
    use franka_rt::session::GoalId;
    use franka_rt::supervision::{EventKind, Output, Supervision};
    use futures::FutureExt;

    use super::*;

    #[test]
    fn a_listener_that_lags_is_told_how_many_events_it_missed() {
        let mut supervision = Supervision::new(None);
        let now = Duration::ZERO;
        assert!(supervision.on_connected(None, &RobotState::default(), &[], now));
        while supervision.poll().is_some() {}
        let (sender, events) = broadcast::channel(CAPACITY);
        let mut events = Events::new(events);
        for goal in 1..=300 {
            supervision.on_begun(GoalId(goal), now);
        }
        while let Some(output) = supervision.poll() {
            let Output::Event(event) = output else {
                panic!("{output:?}")
            };
            sender.send(event).expect("somebody listens");
        }
        let mut next = || events.next().now_or_never().expect("there are more");
        let first = next().expect("not the end");
        assert_eq!(first.missed, 44);
        assert_eq!(first.event.kind, EventKind::MotionBegun { goal: 45 });
        assert_eq!(next().expect("not the end").missed, 0);
        drop(sender);
        while let Some(notification) = next() {
            assert_eq!(notification.missed, 0);
        }
    }
}
