//! The newest state, read from the control thread's slot or published as it changes.

use std::sync::{Arc, Weak};

use franka_proto::RobotState;
use franka_rt::state_wakeups::StateWakeups;
use franka_rt::thread::StateReader;
use tokio::sync::watch;

/// Reads the newest state from the control thread's slot.
///
/// Reading the state costs other threads and tasks nothing. Subscribing to changes makes the
/// control thread wake the bridge for every state.
#[derive(Clone, Debug)]
pub(crate) struct Newest {
    /// Reader that is never advanced, so that each of its clones finds all later states.
    reader: StateReader,
    /// The state before the first state that `reader` finds.
    first: RobotState,
    /// The last state that the bridge published, which may be some states old without wake-ups for
    /// every state. The sender is weak, so that subscribers see the end of the connection. There is
    /// no receiver here, because receivers count as subscribers.
    publisher: Weak<watch::Sender<RobotState>>,
    state_wakeups: StateWakeups,
}

/// Publishes a state, unless a newer one is already published.
pub(crate) fn publish(publisher: &watch::Sender<RobotState>, state: RobotState) {
    publisher.send_if_modified(|newest| {
        let newer = state.message_id > newest.message_id;
        if newer {
            *newest = state;
        }
        newer
    });
}

impl Newest {
    /// Returns a reader of the states that `reader` has not read yet; `first` is the state before
    /// them.
    pub(crate) fn new(
        (first, reader): (RobotState, StateReader),
        publisher: &Arc<watch::Sender<RobotState>>,
        state_wakeups: StateWakeups,
    ) -> Self {
        Self {
            reader,
            first,
            publisher: Arc::downgrade(publisher),
            state_wakeups,
        }
    }

    pub(crate) fn state(&self) -> RobotState {
        // Nothing was read: nothing is newer than `first`, or the kernel has stopped this thread in
        // the middle of each attempt.
        let newest = self.reader.clone().newest();
        newest.unwrap_or_else(|| {
            let publisher = self.publisher.upgrade();
            publisher.map_or(self.first, |publisher| *publisher.borrow())
        })
    }

    /// Returns a receiver of the newest state and of its changes from now on.
    pub(crate) fn changes(&self) -> watch::Receiver<RobotState> {
        let Some(publisher) = self.publisher.upgrade() else {
            // The connection has ended, so return a closed channel.
            return watch::channel(self.state()).1;
        };
        let mut states = publisher.subscribe();
        self.state_wakeups.request();
        // A state that was published without wake-ups may be some states old.
        publish(&publisher, self.state());
        states.mark_unchanged();
        states
    }
}
