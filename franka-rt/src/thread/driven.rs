//! What the thread drives.

use core::time::Duration;

use franka_proto::{RobotCommand, RobotState};

use crate::driver::{Driver, Event, LINK_TIMEOUT, Order, Record};

/// A pure core: states, orders and silences in; commands, records and events out.
///
/// [`Driver`] is the one that programs use. The trait lets the loop be tested, and its allocations be counted, beside
/// cores that panic, answer everything or hold their events back. No method may allocate, free, lock, log or wait: they
/// run on the real-time thread.
pub trait Core: Send + 'static {
    /// What the world outside asks for.
    type Order: Send + 'static;
    /// What the world outside has to hear. Whatever has to be freed travels inside.
    type Event: Send + 'static;
    /// What a cycle saw and did.
    type Record: Copy + Send + 'static;

    /// Takes an order.
    fn on_order(&mut self, order: Self::Order);

    /// Takes a state, newer than all before it, and returns the command that answers it.
    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand>;

    /// Tells that no state has come for `silence`, of this host's clock. Comes again and again while it lasts.
    fn on_silence(&mut self, silence: Duration);

    /// The silence that the core wants to hear of in time; the thread waits for states no longer than a fraction of it.
    fn link_timeout(&self) -> Duration {
        LINK_TIMEOUT
    }

    /// Tells how long the command took to leave, from the receipt of the state that it answers.
    fn note_turnaround(&mut self, turnaround: Duration);

    /// The record of the last cycle.
    fn record(&self) -> Self::Record;

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

    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        Self::on_state(self, state)
    }

    fn on_silence(&mut self, silence: Duration) {
        Self::on_silence(self, silence);
    }

    fn link_timeout(&self) -> Duration {
        Self::link_timeout(self).get()
    }

    fn note_turnaround(&mut self, turnaround: Duration) {
        Self::note_turnaround(self, turnaround);
    }

    fn record(&self) -> Record {
        *Self::record(self)
    }

    fn take_event(&mut self) -> Option<Event> {
        Self::take_event(self)
    }
}
