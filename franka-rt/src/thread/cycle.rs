//! One turn of the loop: receive, answer, publish, prepare, count. `exchange` chooses the newest
//! state.

use std::sync::Arc;
use std::time::Instant;

use franka_proto::{DecodeError, RobotCommand, RobotState, Version};

use super::Core;
use super::cycle_feed::CyclePublisher;
use super::fault::{Latch, LinkFault};
use super::handle::{Datagram, Notice};
use super::lifetime::Lifetime;
use crate::event_fd::EventFd;
use crate::exchange::{Exchange, Reception, SendError};
use crate::queue::{Receiver, Sender};
use crate::slot::SlotWriter;
use crate::state_wakeups::StateWakeups;
use crate::stats::{CycleTimes, Laps, Meter, Phase, Stats};

/// State of the thread.
pub(super) struct Cycle<C: Core> {
    pub(super) core: C,
    pub(super) exchange: Exchange,
    pub(super) version: Version,
    /// Size of a state, in bytes.
    pub(super) size: usize,
    pub(super) orders: Receiver<C::Order>,
    pub(super) notices: Sender<Notice<C::Event, C::Record>>,
    pub(super) records: Sender<C::Record>,
    /// Queue of all states, in the order of their arrival.
    pub(super) sequence: Sender<Datagram>,
    /// Publishes all cycles to attached readers.
    pub(super) cycles: CyclePublisher<C::Record>,
    /// Slot of the newest state.
    pub(super) states: SlotWriter<Datagram>,
    /// Buffer from which a state is copied into the queue and the slot.
    pub(super) datagram: Box<Datagram>,
    pub(super) meter: Meter,
    pub(super) laps: Laps,
    pub(super) event_fd: EventFd,
    pub(super) state_wakeups: StateWakeups,
    /// Number of states since the last wake-up.
    pub(super) states_since_wake: u32,
    pub(super) lifetime: Arc<Lifetime>,
    /// Time at which the cycle was created.
    pub(super) started: Instant,
    pub(super) receive_faults: Latch,
    pub(super) send_faults: Latch,
}

impl<C: Core> Cycle<C> {
    /// Waits up to a tick for a state, and runs one cycle. Returns true if a state came that can be
    /// decoded.
    pub(super) fn turn(&mut self) -> bool {
        let begun = Instant::now();
        self.stats().turns.add(1);
        let reception = self.exchange.receive();
        let now = Instant::now();
        self.laps = Laps::start(now);
        self.take_orders();
        self.cycles.take_attached();
        self.laps.end(Phase::Orders);
        let decoded = reception
            .fresh
            .then(|| RobotState::decode(self.version, self.exchange.state()));
        let readable = matches!(decoded, Some(Ok(_)));
        let mut sent = None;
        if let Some(Ok(state)) = &decoded {
            self.laps.end(Phase::Decode);
            sent = self.answer(state, now, reception.skipped);
            self.publish(now);
        } else {
            // Only time inside the receive counts as silence. If the host delayed this thread
            // afterwards, states may wait in the socket, and the next turn reads them first.
            let listened = now.min(begun + reception.waited);
            let heard = self.meter.heard().unwrap_or(self.started);
            self.core
                .on_silence(listened.saturating_duration_since(heard));
        }
        self.count(&reception);
        let fault = self.fault_of(&reception, decoded.and_then(Result::err));
        let told = self.report(reception.fresh, fault) | self.pass_events_on() | self.detach();
        let due = reception.fresh && self.is_wakeup_due();
        if due || told {
            self.event_fd.notify();
        }
        self.laps.end(Phase::Publish);
        self.core.prepare();
        self.laps.end(Phase::Prepare);
        if let Some(cycle) = sent {
            self.note(cycle);
        }
        readable
    }

    /// Sends the core's command for a state, if there is one. Then does the work that may follow
    /// the command. Returns the times of the command.
    fn answer(
        &mut self,
        state: &RobotState,
        received: Instant,
        skipped: u64,
    ) -> Option<CycleTimes> {
        if skipped > 0 {
            self.core.on_skipped(skipped);
        }
        let command = self.core.on_state(state);
        self.laps.end(Phase::Program);
        // A failed send is counted and reported; the loop continues.
        let departed = command.and_then(|command| self.transmit(&command).ok());
        let arrival = self.meter.note_arrival(state.message_id, received, skipped);
        let sent = departed.map(|departed| self.meter.answered(departed));
        self.core.after_send(state, &arrival, sent.as_ref());
        sent
    }

    /// Sends a command for the newest state, outside of a turn.
    pub(super) fn send(&mut self, command: &RobotCommand) -> Result<(), SendError> {
        // The user's code ran from the end of the turn until now.
        self.laps.end(Phase::Program);
        let departed = self.transmit(command)?;
        self.note(self.meter.answered(departed));
        Ok(())
    }

    /// Adds a cycle whose command has left, after all of its phases have ended.
    fn note(&mut self, cycle: CycleTimes) {
        let cycle = CycleTimes {
            phases: self.laps.phases(),
            ..cycle
        };
        let motion = self.core.note_cycle(&cycle);
        self.meter.note_cycle(&cycle, motion);
    }

    /// Returns the newest state; `None` if the state cannot be decoded.
    pub(super) fn state(&self) -> Option<RobotState> {
        RobotState::decode(self.version, self.exchange.state()).ok()
    }

    fn take_orders(&mut self) {
        for _ in 0..ORDERS_PER_CYCLE {
            match self.orders.pop() {
                Some(order) => self.core.on_order(order),
                None => break,
            }
        }
    }

    /// Passes a command to the kernel. Returns the time when the system call returned.
    fn transmit(&mut self, command: &RobotCommand) -> Result<Instant, SendError> {
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let size = command
            .encode(self.version, &mut bytes)
            .expect("a command has at most `MAX_SIZE` bytes");
        let sent = self.exchange.send(&bytes[..size]);
        let departed = sent.map(|()| Instant::now());
        match departed {
            Ok(departed) => self.laps.end_at(Phase::Send, departed),
            Err(_) => self.stats().send_errors.add(1),
        }
        if let Some(fault) = self.send_faults.pass(sent.err().map(LinkFault::Send)) {
            self.queue(fault);
        }
        departed
    }

    /// Publishes the newest state, which was received at `now`.
    fn publish(&mut self, now: Instant) {
        self.datagram.set(self.exchange.state());
        self.states.write(&self.datagram);
        if self.sequence.push(*self.datagram).is_err() {
            self.stats().states_lost.add(1);
        }
        let record = self.core.record();
        if self.records.push(record).is_err() {
            self.stats().records_lost.add(1);
        }
        self.cycles.push(record, self.exchange.state(), now);
    }

    fn stats(&self) -> &Stats {
        self.meter.stats()
    }

    fn count(&self, reception: &Reception) {
        let stats = self.stats();
        stats.skipped.add(reception.skipped);
        stats.stale.add(reception.stale);
        stats.foreign.add(reception.foreign);
        let leaps = u64::from(reception.leap.is_some());
        stats.malformed.add(reception.short + leaps);
        stats
            .receive_errors
            .add(u64::from(reception.error.is_some()));
    }

    fn fault_of(
        &self,
        reception: &Reception,
        undecodable: Option<DecodeError>,
    ) -> Option<LinkFault> {
        self.stats().malformed.add(u64::from(undecodable.is_some()));
        let short = DecodeError::DatagramSize {
            got: reception.short_length,
            expected: self.size,
        };
        let datagram = undecodable.or((reception.short > 0).then_some(short));
        let leap = reception.leap.map(|got| LinkFault::Leap {
            got,
            newest: self.exchange.message_id().unwrap_or_default(),
        });
        datagram
            .map(LinkFault::Datagram)
            .or(leap)
            .or(reception.error.map(LinkFault::Receive))
    }

    /// True if a wake-up for a state is due: for every state if this is requested, otherwise for
    /// every [`STATES_PER_WAKE_MAX`]th state.
    fn is_wakeup_due(&mut self) -> bool {
        self.states_since_wake += 1;
        let due = self.state_wakeups.are_wanted() || self.states_since_wake >= STATES_PER_WAKE_MAX;
        if due {
            self.states_since_wake = 0;
        }
        due
    }

    /// Queues a fault of the receiving side if it is new. Returns true if it was queued.
    fn report(&mut self, fresh: bool, fault: Option<LinkFault>) -> bool {
        if !fresh && fault.is_none() {
            return false; // A tick without any datagram is neither a fault nor the end of one.
        }
        self.receive_faults
            .pass(fault)
            .is_some_and(|fault| self.queue(fault))
    }

    /// Queues a report of the loop. Returns true if there was room.
    fn queue(&mut self, fault: LinkFault) -> bool {
        let queued = self.notices.push(Notice::Link(fault)).is_ok();
        self.stats().reports_lost.add(u64::from(!queued));
        queued
    }

    /// Queues the core's events while there is room. Returns true if there was an event.
    fn pass_events_on(&mut self) -> bool {
        let event = || self.core.take_event().map(Notice::Core);
        self.notices.push_from(EVENTS_PER_CYCLE, event) > 0
    }

    /// Queues the ring of a reader of cycles that was dropped. Returns true if there was one.
    fn detach(&mut self) -> bool {
        let detached = || self.cycles.take_detached().map(Notice::Detached);
        self.notices.push_from(1, detached) > 0
    }
}

/// Number of states after which a wake-up is sent without a request. The thread's rings have room
/// for many more states. These twenty wake-ups per second use less than a thousandth of a core.
const STATES_PER_WAKE_MAX: u32 = 50;

/// Largest number of orders per cycle; further orders wait for the next cycle.
const ORDERS_PER_CYCLE: usize = 8;

/// Largest number of events queued per cycle; further events wait for the next cycle.
const EVENTS_PER_CYCLE: usize = 8;
