//! The newest state: read from the control thread's slot, or published as it changes.

use std::sync::{Arc, Weak};

use franka_proto::RobotState;
use franka_rt::state_wakeups::StateWakeups;
use franka_rt::thread::StateReader;
use tokio::sync::watch;

/// Reads the newest state where the control thread has left it.
///
/// Reading it costs no other thread or task anything. For a subscriber to changes, the bridge is
/// woken for every state.
#[derive(Clone, Debug)]
pub(crate) struct Newest {
    /// Stays as it is, so that each of its clones finds everything that came later.
    reader: StateReader,
    /// The state before the states that `reader` finds.
    first: RobotState,
    /// Last state published by the bridge. Without wake-ups per state it may be some states behind.
    /// Weak, so that subscribers see the end; and no receiver, as those are counted.
    publisher: Weak<watch::Sender<RobotState>>,
    state_wakeups: StateWakeups,
}

/// Publishes a state, unless a newer one is published already.
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
    /// Reads what `reader` has not read yet; `first` is the state before.
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

    /// The newest state.
    pub(crate) fn state(&self) -> RobotState {
        // Without one there is nothing newer than `first`; or the kernel has stopped this thread in
        // the middle of each attempt.
        let newest = self.reader.clone().newest();
        newest.unwrap_or_else(|| {
            let publisher = self.publisher.upgrade();
            publisher.map_or(self.first, |publisher| *publisher.borrow())
        })
    }

    /// The newest state, and as it changes from now on.
    pub(crate) fn changes(&self) -> watch::Receiver<RobotState> {
        let Some(publisher) = self.publisher.upgrade() else {
            // Closed from the outset.
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
