//! Interface between the loop and the core that it calls.

use core::time::Duration;

use franka_proto::{RobotCommand, RobotState};

use crate::driver::{Driver, Event, LINK_TIMEOUT, Order, Record};
use crate::stats::{Arrival, CycleTimes, MotionStatistics};

/// A core without I/O. It receives states, orders and silences, and returns commands, records and
/// events.
///
/// [`Driver`] is the core that programs use. The trait exists for tests of the loop and its
/// allocations, with cores that panic, answer every state, or hold their events back. All methods
/// run on the real-time thread, so they must not allocate, free, lock, log or wait. Methods with a
/// body are optional.
pub trait Core: Send + 'static {
    /// An order from other threads.
    type Order: Send + 'static;
    /// A report to other threads. It also carries memory that these threads must free.
    type Event: Send + 'static;
    /// Record of a cycle.
    type Record: Copy + Send + 'static;

    /// Carries out an order.
    fn on_order(&mut self, order: Self::Order);

    /// Announces that `states` older states arrived with the next state and are skipped. Not called
    /// for 0.
    fn on_skipped(&mut self, _states: u64) {}

    /// Processes a state that is newer than all previous states, and returns the command that
    /// answers it.
    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand>;

    /// Reports that no state has come for `silence`, by this host's clock. Called repeatedly while
    /// the silence lasts.
    fn on_silence(&mut self, silence: Duration);

    /// Returns the length of silence that the thread must notice in time. The thread waits for a
    /// state no longer than a fraction of it.
    fn link_timeout(&self) -> Duration {
        LINK_TIMEOUT
    }

    /// Does the work for a state that can wait until the command has left. `sent` contains the
    /// times of the command, if one left, without the phases after it.
    fn after_send(&mut self, _state: &RobotState, _arrival: &Arrival, _sent: Option<&CycleTimes>) {}

    /// Returns the record of the last cycle, after [`Self::after_send`].
    fn record(&self) -> Self::Record;

    /// Does the work for the next state that is possible before this state arrives. Called after
    /// all other work of the cycle.
    fn prepare(&mut self) {}

    /// Notes the times of a cycle whose command has left. Returns the counts of the running motion,
    /// if a motion runs.
    fn note_cycle(&mut self, _cycle: &CycleTimes) -> Option<&MotionStatistics> {
        None
    }

    /// Removes and returns the oldest event. Called only if the queue has room for it.
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

    fn prepare(&mut self) {
        Self::prepare(self);
    }

    fn note_cycle(&mut self, cycle: &CycleTimes) -> Option<&MotionStatistics> {
        Self::note_cycle(self, cycle)
    }

    fn take_event(&mut self) -> Option<Event> {
        Self::take_event(self)
    }
}
