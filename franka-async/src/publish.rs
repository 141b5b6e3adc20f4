//! Passes states and records of the control thread on to subscribers.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use franka_proto::RobotState;
use franka_rt::driver::Record;
use franka_rt::queue::Receiver;
use franka_rt::state_wakeups::StateWakeups;
use franka_rt::thread::{StateReader, StateSequence};
use tokio::sync::{broadcast, watch};

use crate::newest_state;

/// Number of items by which a slow listener may lag before it misses items: two seconds of records,
/// one second of states.
const RECORDS: usize = 2048;
const STATES: usize = 1024;

/// An item in the stream of all states.
#[derive(Clone, Debug)]
pub(crate) enum Update {
    State(Arc<RobotState>),
    /// No state has come for this duration; the link counts as lost.
    Silence(Duration),
}

/// The reading ends of the thread's queues, and the listeners of each.
pub(crate) struct Publisher {
    pub(crate) newest: StateReader,
    pub(crate) sequence: StateSequence,
    pub(crate) queue: Receiver<Record>,
    state_wakeups: StateWakeups,
    silent: Arc<Mutex<Option<Silent>>>,
    /// True if the bridge itself reads every state.
    is_watched: bool,
    listeners: Listeners,
}

/// The silence that was reported last.
#[derive(Clone, Copy, Debug)]
struct Silent {
    /// `message_id` of the last state before the silence.
    since: u64,
    silence: Duration,
}

struct Listeners {
    newest: Arc<watch::Sender<RobotState>>,
    updates: broadcast::Sender<Update>,
    records: broadcast::Sender<Record>,
}

/// Sources for subscribers. They are weak, so that subscribers see the end of the connection.
#[derive(Clone, Debug)]
pub(crate) struct Subscriptions {
    updates: broadcast::WeakSender<Update>,
    records: broadcast::WeakSender<Record>,
    state_wakeups: StateWakeups,
    silent: Arc<Mutex<Option<Silent>>>,
}

impl Publisher {
    /// All receivers of `states` count as subscribers of this publisher.
    pub(crate) fn new(
        newest: StateReader,
        sequence: StateSequence,
        queue: Receiver<Record>,
        state_wakeups: StateWakeups,
        states: Arc<watch::Sender<RobotState>>,
    ) -> Self {
        Self {
            newest,
            sequence,
            queue,
            state_wakeups,
            silent: Arc::default(),
            is_watched: false,
            listeners: Listeners {
                newest: states,
                updates: broadcast::channel(STATES).0,
                records: broadcast::channel(RECORDS).0,
            },
        }
    }

    pub(crate) fn subscriptions(&self) -> Subscriptions {
        Subscriptions {
            updates: self.listeners.updates.downgrade(),
            records: self.listeners.records.downgrade(),
            state_wakeups: self.state_wakeups.clone(),
            silent: self.silent.clone(),
        }
    }

    /// Returns the newest state that was passed on.
    pub(crate) fn state(&self) -> watch::Ref<'_, RobotState> {
        self.listeners.newest.borrow()
    }

    /// Passes on everything that has come. If there are no subscribers, the thread stops waking the
    /// bridge for every state.
    pub(crate) fn publish(&mut self) {
        self.refresh();
        // Count the states before the subscribers, because a subscriber that comes later must not
        // get these states.
        let come = self.sequence.waiting();
        if self.listeners.updates.receiver_count() == 0 {
            self.sequence.skip(come);
        }
        // Sending fails only if the last listener has just gone.
        while let Some(state) = self.sequence.pop() {
            let _ = self.listeners.updates.send(Update::State(Arc::new(state)));
        }
        if self.listeners.records.receiver_count() == 0 {
            self.queue.skip(self.queue.waiting());
        }
        while let Some(record) = self.queue.pop() {
            let _ = self.listeners.records.send(record);
        }
        let is_wanted = || self.is_watched || self.listeners.are_there();
        self.state_wakeups.release(is_wanted);
    }

    /// Sets whether the bridge itself needs a wake-up for every state.
    pub(crate) fn watch(&mut self, every_state: bool) {
        self.is_watched = every_state;
        if every_state {
            self.state_wakeups.request();
        }
    }

    /// Passes on the newest state only. Without subscribers, the last state that was passed on may
    /// be some states old.
    pub(crate) fn refresh(&mut self) {
        if let Some(state) = self.newest.newest() {
            newest_state::publish(&self.listeners.newest, state);
        }
    }

    /// Reports to listeners that the robot has been silent for `silence`.
    pub(crate) fn tell_silence(&self, silence: Duration) {
        let since = self.state().message_id;
        *lock(&self.silent) = Some(Silent { since, silence });
        // This fails without subscribers. Later subscribers find the silence that is stored above.
        let _ = self.listeners.updates.send(Update::Silence(silence));
    }
}

impl Listeners {
    fn are_there(&self) -> bool {
        self.newest.receiver_count() > 0
            || self.updates.receiver_count() > 0
            || self.records.receiver_count() > 0
    }
}

impl Subscriptions {
    /// Returns a receiver of states from now on. The first states may be older than that.
    pub(crate) fn updates(&self) -> broadcast::Receiver<Update> {
        let updates = subscribe(&self.updates);
        self.state_wakeups.request();
        updates
    }

    /// Returns the silence for which the link was given up, if no state has come since. `newest` is
    /// the `message_id` of the newest state. The message of a silence is sent only once, so later
    /// subscribers call this.
    pub(crate) fn silence(&self, newest: u64) -> Option<Duration> {
        let silent = *lock(&self.silent);
        silent.and_then(|told| (newest <= told.since).then_some(told.silence))
    }

    /// Returns a receiver of records from now on; the first records may be of earlier cycles.
    pub(crate) fn records(&self) -> broadcast::Receiver<Record> {
        let records = subscribe(&self.records);
        self.state_wakeups.request();
        records
    }
}

fn lock(silent: &Mutex<Option<Silent>>) -> std::sync::MutexGuard<'_, Option<Silent>> {
    // A panic cannot leave the value half-finished.
    silent.lock().unwrap_or_else(PoisonError::into_inner)
}

fn subscribe<T: Clone>(sender: &broadcast::WeakSender<T>) -> broadcast::Receiver<T> {
    match sender.upgrade() {
        Some(sender) => sender.subscribe(),
        // The connection has ended, so return a closed channel.
        None => broadcast::channel(1).1,
    }
}
