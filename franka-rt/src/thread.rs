//! The only loop of the crate: one real-time thread per robot, from connect to drop, with or
//! without a motion.
//!
//! ```text
//! receive (wait <= 20 ms) -> orders -> decode -> Core::on_state -> encode -> send
//!                                  |                 then: Core::after_send, newest-state slot, queues of states and
//!                                  |                       records, notices, eventfd, Core::prepare, statistics
//!                                  +-> nothing came: on_silence
//! ```
//!
//! The command is sent before anything is published. After [`spawn`] has returned, the loop neither
//! allocates, frees, locks nor logs. Its only system calls are `recvfrom`, `sendto`, the clock and
//! the `write` to the eventfd. An event carries away each value that must be freed, for example a
//! program that has ended.
//!
//! The loop can lend its cycle through a [`Lease`]: a thread of the program then runs the cycle
//! instead of this thread, until it returns the cycle.
//!
//! The core reads no clock: control uses the robot's time. The loop measures how long the robot is
//! silent, the interval between states, and the time that an answer takes. With the feature
//! `cycle-phases` it also measures each part of an answer.
//!
//! A panic in the core ends only the loop. The robot then receives no commands and stops on its
//! own. The eventfd is notified, and [`Thread::join`] returns the panic's message, which the
//! process's panic hook prints.

mod borrower;
mod cycle;
mod cycle_feed;
mod driven;
mod fault;
mod handle;
mod handoff;
mod lease;
mod lifetime;

use std::io;
use std::net::{IpAddr, UdpSocket};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc;
use std::time::Instant;

use franka_proto::Version;

pub use self::cycle_feed::{
    AttachError, CapturedCycle, CycleFeed, CyclePublisher, CycleReader, CycleWriter, READERS_MAX,
    cycle_feed,
};
pub use self::driven::Core;
pub use self::fault::LinkFault;
pub use self::handle::{Handle, Lost, Notice, StateReader, StateSequence, Thread};
pub use self::handoff::BorrowError;
pub use self::lease::{Lease, Lender, WriteFault};

use self::borrower::BorrowerWatch;
use self::cycle::Cycle;
use self::fault::Latch;
use self::handle::Datagram;
use self::handoff::{Handoff, NotReturned};
use self::lifetime::Lifetime;
use crate::event_fd::EventFd;
use crate::exchange::{self, Exchange};
use crate::queue;
use crate::sched::{SchedError, Scheduling};
use crate::slot;
use crate::state_wakeups::StateWakeups;
use crate::stats::{Laps, Meter};

/// Options of the thread.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ThreadConfig {
    /// Requests to the operating system.
    pub scheduling: Scheduling,
    /// Lengths of the thread's queues.
    pub capacity: Capacity,
}

/// Lengths of the queues, each at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Number of orders to the thread.
    pub orders: usize,
    /// Number of notices from the thread.
    pub notices: usize,
    /// Number of records from the thread, one per millisecond.
    pub records: usize,
    /// Number of states from the thread, one per millisecond, of 2.5 kB each.
    pub states: usize,
}

impl Default for Capacity {
    /// Returns 16 orders (a motion needs two) and 64 notices (a motion causes a handful). The 2048
    /// records are two seconds, and the 1024 states are one second.
    fn default() -> Self {
        Self {
            orders: 16,
            notices: 64,
            records: 2048,
            states: 1024,
        }
    }
}

/// Reason why a thread was not started.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The operating system refused a request that [`Realtime::Enforce`](crate::sched::Realtime)
    /// requires.
    #[error(transparent)]
    Scheduling(#[from] SchedError),
    /// No thread or descriptor is available, or the socket does not accept its options.
    #[error("cannot start the control thread: {0}")]
    System(#[from] io::Error),
}

/// Starts the thread of one robot. It uses the socket whose port `Connect` announces (see
/// [`crate::exchange::bind`]).
///
/// Only states from `robot` count, and commands are sent to the sender of the newest state. Returns
/// once the thread has made the requests of `config` to the operating system. This blocks for well
/// under a millisecond.
///
/// # Errors
/// Returns [`StartError`] if the thread cannot start; the core is then dropped.
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
    let event_fd = EventFd::new()?;
    let state_wakeups = StateWakeups::default();
    let meter = Meter::new();
    let stats = meter.stats().clone();
    let lifetime = Arc::new(Lifetime::default());
    let (orders, order_queue) = queue::queue(capacity.orders);
    let (notice_queue, notices) = queue::queue(capacity.notices);
    let (record_queue, records) = queue::queue(capacity.records);
    let (cycle_feed, cycles) = cycle_feed(version);
    let (state_queue, states) = queue::queue(capacity.states);
    let (state_slot, state_reader) = slot::slot();
    let handoff = Arc::new(Handoff::new(exchange::TICK));
    let link_timeout = core.link_timeout();
    let wait = exchange::wait_for(link_timeout);
    let exchange = Exchange::new(socket, robot, size)?.with_wait(wait)?;
    let now = Instant::now();
    let mut cycle = Box::new(Cycle {
        core,
        exchange,
        version,
        size,
        orders: order_queue,
        notices: notice_queue,
        records: record_queue,
        sequence: state_queue,
        cycles,
        states: state_slot,
        datagram: Box::new(Datagram::ZERO),
        meter,
        laps: Laps::start(now),
        event_fd: event_fd.clone(),
        state_wakeups: state_wakeups.clone(),
        states_since_wake: 0,
        lifetime: lifetime.clone(),
        started: now,
        receive_faults: Latch::default(),
        send_faults: Latch::default(),
    });
    let lender = Lender::new(handoff.clone());
    let (granted, grant) = mpsc::sync_channel(1);
    let stack_size = scheduling.stack_size();
    let run = move || {
        let answer = scheduling.enter().and_then(|mut granted| {
            scheduling.tune(cycle.exchange.socket(), &mut granted)?;
            Ok(granted)
        });
        let refused = answer.is_err();
        // This cannot fail, because the caller still waits for the answer.
        let _ = granted.send(answer);
        drop(granted);
        let lifetime = cycle.lifetime.clone();
        let event_fd = cycle.event_fd.clone();
        // Only a method of the core can panic, and the core is not used after that.
        let ended = catch_unwind(AssertUnwindSafe(|| {
            while !refused && !lifetime.stop_wanted() {
                if handoff.is_wanted() {
                    let now = Instant::now();
                    let mut watch = BorrowerWatch::new(&lifetime, &event_fd, link_timeout, now);
                    cycle = handoff.lend(cycle, || {
                        watch.look(Instant::now());
                        lifetime.stop_wanted()
                    })?;
                }
                cycle.turn();
            }
            Ok::<C, NotReturned>(cycle.core)
        }));
        handoff.close();
        lifetime.note_end();
        event_fd.notify();
        match ended {
            Ok(core) => core.map_err(Lost::from),
            Err(payload) => Err(Lost::panicked(&*payload)),
        }
    };
    let joiner = std::thread::Builder::new()
        .name("franka-rt".into())
        .stack_size(stack_size)
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
        sequence: StateSequence {
            queue: states,
            version,
            size,
        },
        cycles: cycle_feed,
        event_fd,
        state_wakeups,
        stats,
        granted,
        lender,
        thread: Thread {
            shared: lifetime,
            joiner: Some(joiner),
            link_timeout,
        },
    })
}
