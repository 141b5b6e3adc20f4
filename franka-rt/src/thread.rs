//! The only loop: one real-time thread per robot, from connect to drop, in motion or not.
//!
//! ```text
//! receive (wait <= 20 ms) -> orders -> decode -> Core::on_state -> encode -> send
//!                                  |                                 then: newest-state slot, record ring,
//!                                  +-> nothing came: on_silence            notices, statistics, eventfd
//! ```
//!
//! The command leaves before anything is published. After [`spawn`] has returned, the loop neither allocates, frees,
//! locks nor logs, and its only system calls are `recvfrom`, `sendto`, the clock and the `write` that rings the bell.
//! What has to be freed (a program that ended) leaves inside an event.
//!
//! The queues are rtrb's, whose two ends never wait for each other. Not crossbeam's `ArrayQueue`: there, an end that
//! finds the other in the middle of an operation spins until it is done, and if the other was preempted by this very
//! thread, on the one processor that it may run on, that never happens.
//!
//! The clock is read here and nowhere else in the crate, for three things: how long the robot has been silent, how far
//! apart its states arrive, and how long an answer takes. Control itself lives by the robot's clock, in the core.
//!
//! A panic in the core ends the loop and nothing else: the robot misses its commands and stops by itself, the bell
//! rings, and [`Thread::join`] tells. Printing the panic is the business of the process's panic hook.

mod driven;
mod fault;
mod handle;

use std::io;
use std::net::{IpAddr, UdpSocket};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc;
use std::time::Instant;

use franka_proto::{DecodeError, RobotCommand, RobotState, Version};

pub use self::driven::Core;
pub use self::fault::LinkFault;
pub use self::handle::{Handle, Notice, Panicked, StateReader, Thread};

use self::fault::Latch;
use self::handle::{Datagram, Lifetime};
use crate::exchange::{Exchange, Reception};
use crate::sched::{self, SchedError, Scheduling};
use crate::slot::{self, SlotWriter};
use crate::stats::Stats;
use crate::wake::Wake;

/// How to run the thread.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ThreadConfig {
    /// What to ask the operating system for.
    pub scheduling: Scheduling,
    /// How many orders, notices and records can wait.
    pub capacity: Capacity,
}

/// Lengths of the queues, each at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Orders into the thread.
    pub orders: usize,
    /// Notices out of it.
    pub notices: usize,
    /// Records out of it, one per millisecond.
    pub records: usize,
}

impl Default for Capacity {
    /// 16 orders (a motion takes two), 64 notices (a motion causes a handful), 2048 records: two seconds in which
    /// nobody need read them.
    fn default() -> Self {
        Self {
            orders: 16,
            notices: 64,
            records: 2048,
        }
    }
}

/// Why a thread could not be started.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The operating system refused what [`Realtime::Enforce`](crate::sched::Realtime) requires.
    #[error(transparent)]
    Scheduling(#[from] SchedError),
    /// No thread, no descriptor, or a socket that does not take its options.
    #[error("the control thread cannot be started: {0}")]
    System(#[from] io::Error),
}

/// Starts the thread of one robot, on the socket whose port `Connect` announces (see [`crate::exchange::bind`]).
///
/// States count only if they come from `robot`, and commands go to where the newest state came from. Returns when the
/// thread has asked the operating system for what `config` wants; that takes well under a millisecond of blocking.
///
/// # Errors
/// [`StartError`]; the core is then dropped.
pub fn spawn<C: Core>(
    config: ThreadConfig,
    core: C,
    socket: UdpSocket,
    robot: IpAddr,
    version: Version,
) -> Result<Handle<C>, StartError> {
    let ThreadConfig {
        scheduling,
        capacity,
    } = config;
    let size = version.state_size();
    let wake = Wake::new()?;
    let stats = Arc::new(Stats::default());
    let lifetime = Arc::new(Lifetime::default());
    let (orders, order_queue) = rtrb::RingBuffer::new(capacity.orders.max(1));
    let (notice_queue, notices) = rtrb::RingBuffer::new(capacity.notices.max(1));
    let (record_ring, records) = touched_ring(capacity.records.max(1), core.record());
    let (state_slot, state_reader) = slot::slot();
    let mut cycle = Cycle {
        core,
        exchange: Exchange::new(socket, robot, size)?,
        version,
        size,
        orders: order_queue,
        notices: notice_queue,
        records: record_ring,
        states: state_slot,
        datagram: Box::new(Datagram([0; RobotState::MAX_SIZE])),
        stats: stats.clone(),
        wake: wake.clone(),
        lifetime: lifetime.clone(),
        newest: None,
        receive_faults: Latch::default(),
        send_faults: Latch::default(),
    };
    let (granted, grant) = mpsc::sync_channel(1);
    let run = move || {
        let answer = scheduling.enter();
        let refused = answer.is_err();
        // The one who waits for the answer cannot have gone: it does nothing else.
        let _ = granted.send(answer);
        drop(granted);
        // The core panics, if at all, in its own methods, and is not used after that.
        let ended = match catch_unwind(AssertUnwindSafe(|| {
            if !refused {
                cycle.run()
            }
        })) {
            Ok(()) => Ok(()),
            Err(payload) => Err(Panicked::new(&*payload)),
        };
        cycle.lifetime.note_end();
        cycle.wake.ring();
        ended.map(|()| cycle.core)
    };
    let joiner = std::thread::Builder::new()
        .name("franka-rt".into())
        .stack_size(sched::STACK)
        .spawn(run)?;
    let granted = grant
        .recv()
        .map_err(|_| io::Error::other("it ended before it began"))??;
    Ok(Handle {
        orders,
        notices,
        records,
        states: StateReader {
            slot: state_reader,
            version,
            size,
        },
        wake,
        stats,
        granted,
        thread: Thread {
            shared: lifetime,
            joiner: Some(joiner),
        },
    })
}

/// What the thread owns.
struct Cycle<C: Core> {
    core: C,
    exchange: Exchange,
    version: Version,
    /// Size of a state, in bytes.
    size: usize,
    orders: rtrb::Consumer<C::Order>,
    notices: rtrb::Producer<Notice<C::Event>>,
    records: rtrb::Producer<C::Record>,
    states: SlotWriter<Datagram>,
    /// The newest state on its way to the slot.
    datagram: Box<Datagram>,
    stats: Arc<Stats>,
    wake: Wake,
    lifetime: Arc<Lifetime>,
    /// `message_id` and time of receipt of the newest state.
    newest: Option<(u64, Instant)>,
    receive_faults: Latch,
    send_faults: Latch,
}

impl<C: Core> Cycle<C> {
    fn run(&mut self) {
        let start = Instant::now();
        while !self.lifetime.stop_wanted() {
            let reception = self.exchange.receive();
            let now = Instant::now();
            self.take_orders();
            let decoded = reception
                .fresh
                .then(|| RobotState::decode(self.version, self.exchange.state()));
            if let Some(Ok(state)) = &decoded {
                self.answer(state, now);
                self.publish();
                self.note_arrival(state.message_id, now, reception.skipped);
            } else {
                let heard = self.newest.map_or(start, |(_, heard)| heard);
                self.core.on_silence(now.saturating_duration_since(heard));
            }
            self.count(&reception);
            let fault = self.fault_of(&reception, decoded.and_then(Result::err));
            let told = self.report(reception.fresh, fault) | self.pass_events_on();
            if reception.fresh || told {
                self.wake.ring();
            }
        }
    }

    fn take_orders(&mut self) {
        for _ in 0..ORDERS_PER_CYCLE {
            match self.orders.pop() {
                Ok(order) => self.core.on_order(order),
                Err(_) => break,
            }
        }
    }

    /// Gives `state`, received at `now`, to the core and sends its answer.
    fn answer(&mut self, state: &RobotState, now: Instant) {
        let Some(command) = self.core.on_state(state) else {
            return;
        };
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let size = command
            .encode(self.version, &mut bytes)
            .expect("a command has at most `MAX_SIZE` bytes");
        let sent = self.exchange.send(&bytes[..size]);
        if sent.is_ok() {
            let turnaround = now.elapsed();
            self.core.note_turnaround(turnaround);
            self.stats.turnaround.note(turnaround);
            self.stats.commands.add(1);
        } else {
            self.stats.send_errors.add(1);
        }
        if let Some(fault) = self.send_faults.pass(sent.err().map(LinkFault::Send)) {
            self.queue(fault);
        }
    }

    fn publish(&mut self) {
        self.datagram.0[..self.size].copy_from_slice(self.exchange.state());
        self.states.write(&self.datagram);
        if self.records.push(self.core.record()).is_err() {
            self.stats.records_lost.add(1);
        }
    }

    fn note_arrival(&mut self, message_id: u64, now: Instant, skipped: u64) {
        self.stats.states.add(1);
        if let Some((before, heard)) = self.newest.replace((message_id, now)) {
            let missing = message_id.saturating_sub(before).saturating_sub(1);
            self.stats.lost.add(missing.saturating_sub(skipped));
            self.stats
                .interval
                .note(now.saturating_duration_since(heard));
        }
    }

    fn count(&self, reception: &Reception) {
        self.stats.skipped.add(reception.skipped);
        self.stats.stale.add(reception.stale);
        self.stats.foreign.add(reception.foreign);
        self.stats.malformed.add(reception.short);
        self.stats
            .receive_errors
            .add(u64::from(reception.error.is_some()));
    }

    fn fault_of(
        &self,
        reception: &Reception,
        undecodable: Option<DecodeError>,
    ) -> Option<LinkFault> {
        self.stats.malformed.add(u64::from(undecodable.is_some()));
        let short = DecodeError::DatagramSize {
            got: reception.short_length,
            expected: self.size,
        };
        let datagram = undecodable.or((reception.short > 0).then_some(short));
        datagram
            .map(LinkFault::Datagram)
            .or(reception.error.map(LinkFault::Receive))
    }

    /// Queues a fault of the receiving side if it is news; returns whether it did.
    fn report(&mut self, fresh: bool, fault: Option<LinkFault>) -> bool {
        if !fresh && fault.is_none() {
            return false; // A tick without any datagram is neither a fault nor the end of one.
        }
        self.receive_faults
            .pass(fault)
            .is_some_and(|fault| self.queue(fault))
    }

    /// Queues a report of the loop; returns whether there was room.
    fn queue(&mut self, fault: LinkFault) -> bool {
        let queued = self.notices.push(Notice::Link(fault)).is_ok();
        self.stats.reports_lost.add(u64::from(!queued));
        queued
    }

    /// Queues what the core has to say, as far as there is room; returns whether there was something.
    fn pass_events_on(&mut self) -> bool {
        for passed in 0..EVENTS_PER_CYCLE {
            if self.notices.is_full() {
                return passed > 0;
            }
            let Some(event) = self.core.take_event() else {
                return passed > 0;
            };
            let queued = self.notices.push(Notice::Core(event));
            debug_assert!(queued.is_ok(), "there is room, and nobody else fills it");
        }
        true
    }
}

/// A ring whose memory has been written to, so that no cycle meets a page of it for the first time.
fn touched_ring<T: Copy>(capacity: usize, value: T) -> (rtrb::Producer<T>, rtrb::Consumer<T>) {
    let (mut producer, mut consumer) = rtrb::RingBuffer::new(capacity);
    while producer.push(value).is_ok() {}
    while consumer.pop().is_ok() {}
    (producer, consumer)
}

/// Orders taken in one cycle at most; the rest waits for the next.
const ORDERS_PER_CYCLE: usize = 8;

/// Events passed on in one cycle at most; the rest waits for the next.
const EVENTS_PER_CYCLE: usize = 8;
