//! What the thread drives.

use core::time::Duration;

use franka_proto::{RobotCommand, RobotState};

use crate::driver::{Driver, Event, LINK_TIMEOUT, Order, Record};
use crate::stats::{Arrival, CycleTimes, MotionStatistics};

/// A pure core: states, orders and silences in; commands, records and events out.
///
/// [`Driver`] is the one that programs use. The trait lets the loop be tested, and its allocations
/// be counted, beside cores that panic, answer everything or hold their events back. No method may
/// allocate, free, lock, log or wait: they run on the real-time thread. Those with a body are for
/// cores that keep counts.
pub trait Core: Send + 'static {
    /// What other threads ask for.
    type Order: Send + 'static;
    /// What is reported to other threads. Memory that is no longer needed leaves inside, to be
    /// freed there.
    type Event: Send + 'static;
    /// What a cycle saw and did.
    type Record: Copy + Send + 'static;

    /// Takes an order.
    fn on_order(&mut self, order: Self::Order);

    /// Tells that so many states came with the next one, and were skipped for it. Not called for
    /// none.
    fn on_skipped(&mut self, _states: u64) {}

    /// Takes a state, newer than all before it, and returns the command that answers it.
    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand>;

    /// Tells that no state has come for `silence`, of this host's clock. Comes again and again
    /// while it lasts.
    fn on_silence(&mut self, silence: Duration);

    /// The silence that the core wants to hear of in time; the thread waits for states no longer
    /// than a fraction of it.
    fn link_timeout(&self) -> Duration {
        LINK_TIMEOUT
    }

    /// Does for a state, after [`Self::on_state`], what can wait until the command has left. `sent`
    /// has the times of the command, if one left: all but those of what follows it.
    fn after_send(&mut self, _state: &RobotState, _arrival: &Arrival, _sent: Option<&CycleTimes>) {}

    /// The record of the last cycle, after [`Self::after_send`].
    fn record(&self) -> Self::Record;

    /// Takes all times of a cycle whose command has left.
    fn note_cycle(&mut self, _cycle: &CycleTimes) {}

    /// Counts of the motion that runs, if one does.
    fn statistics(&self) -> Option<&MotionStatistics> {
        None
    }

    /// The oldest event not taken yet. Only called when there is room for it outside.
    fn take_event(&mut self) -> Option<Self::Event>;
}

impl Core for Driver {
    type Order = Order;
    type Event = Event;
    type Record = Record;

    fn on_order(&mut self, order: Order) {
        Self::on_order(self, order);
    }

    fn on_skipped(&mut self, states: u64) {
        Self::on_skipped(self, states);
    }

    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        Self::on_state(self, state)
    }

    fn on_silence(&mut self, silence: Duration) {
        Self::on_silence(self, silence);
    }

    fn link_timeout(&self) -> Duration {
        Self::link_timeout(self).get()
    }

    fn after_send(&mut self, state: &RobotState, arrival: &Arrival, sent: Option<&CycleTimes>) {
        Self::after_send(self, state, arrival, sent);
    }

    fn record(&self) -> Record {
        *Self::record(self)
    }

    fn note_cycle(&mut self, cycle: &CycleTimes) {
        Self::note_cycle(self, cycle);
    }

    fn statistics(&self) -> Option<&MotionStatistics> {
        Self::statistics(self)
    }

    fn take_event(&mut self) -> Option<Event> {
        Self::take_event(self)
    }
}
