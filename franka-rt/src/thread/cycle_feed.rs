//! Passes every cycle of a control thread to readers, such as recorders, that are attached and
//! dropped while it runs.
//!
//! ```text
//! CycleFeed::attach --queue--> CyclePublisher: READERS_MAX rings at most ----> a CycleReader each
//!                                  |
//!                                  +-- of a reader that was dropped --> Notice::Detached, freed elsewhere
//! ```
//!
//! Each reader has its own ring, whose memory is allocated when the reader is attached. The thread
//! copies each cycle into every ring, and neither waits, allocates nor frees. If a ring is full,
//! the cycle is dropped and counted.

use core::time::Duration;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use franka_proto::{RobotState, Version};

use super::handle::Datagram;
use crate::driver::Record;
use crate::queue::{self, Full, Receiver, Sender};

/// Largest number of simultaneous readers of one control thread.
pub const READERS_MAX: usize = 4;

/// One cycle of the control thread: a state, and the record of the driver for it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CapturedCycle<R = Record> {
    /// Record of the driver.
    pub record: R,
    /// The state.
    pub state: RobotState,
    /// Time when the thread had received the state, by this host's monotonic clock.
    pub received: Instant,
    /// Number of cycles just before this cycle that did not fit into the reader's ring.
    pub lost: u64,
}

impl<R> CapturedCycle<R> {
    /// Returns a cycle without lost cycles before it.
    pub fn new(record: R, state: RobotState, received: Instant) -> Self {
        Self {
            record,
            state,
            received,
            lost: 0,
        }
    }
}

/// Attaches readers to a running control thread. Clones attach to the same thread.
#[derive(Debug)]
pub struct CycleFeed<R = Record> {
    attached: Arc<Mutex<Sender<CycleWriter<R>>>>,
    shared: Arc<Shared>,
    version: Version,
}

impl<R> Clone for CycleFeed<R> {
    fn clone(&self) -> Self {
        Self {
            attached: self.attached.clone(),
            shared: self.shared.clone(),
            version: self.version,
        }
    }
}

/// State that both ends of a feed share.
#[derive(Debug, Default)]
struct Shared {
    /// Number of readers.
    readers: AtomicUsize,
    /// True if no further cycle will come. Set with Release.
    ended: AtomicBool,
}

impl Shared {
    /// Acquire, pairs with the Release in the drop of [`CyclePublisher`]: a reader that sees the
    /// flag finds every cycle that was pushed before.
    fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }
}

/// Reason why a reader was not attached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AttachError {
    /// There are already as many readers as possible. Drop a reader first.
    #[error("got one reader of cycles too many, expected {READERS_MAX} at most: drop one first")]
    TooMany,
    /// The requested length of the ring is out of range.
    #[error("the ring of the reader has {got} cycles, expected 1 to {}", CycleFeed::<()>::CAPACITY_MAX)]
    Capacity {
        /// The requested length.
        got: usize,
    },
    /// The thread has not accepted earlier readers yet, because another thread has borrowed its
    /// cycle and does not run it.
    #[error(
        "the control thread has not accepted the previous readers yet: another thread has \
         borrowed its cycle"
    )]
    Busy,
    /// The thread has ended.
    #[error("the control thread has ended")]
    Ended,
}

impl<R: Send + 'static> CycleFeed<R> {
    /// Default length of a ring, in cycles: 4 s, which need 12 MB.
    pub const DEFAULT_CAPACITY: usize = 4096;

    /// Largest length of a ring, in cycles: a minute, which needs 200 MB.
    pub const CAPACITY_MAX: usize = 65_536;

    /// Attaches a reader with a ring of `capacity` cycles, usually [`Self::DEFAULT_CAPACITY`]. Soon
    /// after the call, the reader begins to receive every cycle. The call allocates the ring and
    /// writes to all of it, which takes some milliseconds.
    ///
    /// # Errors
    /// Returns [`AttachError`] if the thread cannot accept the reader.
    pub fn attach(&self, capacity: usize) -> Result<CycleReader<R>, AttachError> {
        if !(1..=Self::CAPACITY_MAX).contains(&capacity) {
            return Err(AttachError::Capacity { got: capacity });
        }
        let one_more = |readers| (readers < READERS_MAX).then_some(readers + 1);
        // Relaxed, as in the drop of a reader: the number orders no other memory.
        let counted =
            self.shared
                .readers
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_more);
        counted.map_err(|_| AttachError::TooMany)?;
        let (queue, receiver) = queue::queue(capacity);
        let lost = Arc::<AtomicU64>::default();
        // Dropping the reader subtracts one from the count, also after an error.
        let reader = CycleReader {
            queue: receiver,
            lost: lost.clone(),
            shared: self.shared.clone(),
            version: self.version,
        };
        let writer = CycleWriter {
            queue,
            lost,
            gap: 0,
        };
        let attached = self.attached.lock();
        let pushed = attached
            .unwrap_or_else(PoisonError::into_inner)
            .push(writer);
        if self.shared.has_ended() {
            return Err(AttachError::Ended);
        }
        pushed.map_err(|Full(_)| AttachError::Busy)?;
        Ok(reader)
    }
}

/// Receives the cycles of a control thread, each once and in order. Use it on an ordinary thread or
/// task. Dropping the reader detaches it.
#[derive(Debug)]
pub struct CycleReader<R = Record> {
    queue: Receiver<Entry<R>>,
    lost: Arc<AtomicU64>,
    shared: Arc<Shared>,
    version: Version,
}

impl<R> CycleReader<R> {
    /// Removes and returns the oldest cycle. Never waits.
    pub fn pop(&mut self) -> Option<CapturedCycle<R>> {
        let entry = self.queue.pop()?;
        // The thread only passes on states that it has decoded itself.
        let state =
            RobotState::decode(self.version, &entry.datagram.0[..self.version.state_size()])
                .ok()?;
        Some(CapturedCycle {
            record: entry.record,
            state,
            received: entry.received,
            lost: entry.lost,
        })
    }

    /// Blocks this thread until there is a cycle. Returns false if none has come within `timeout`,
    /// or none will come any more. Checks every 5 ms, because the control thread does not wake
    /// readers.
    pub fn wait(&self, timeout: Duration) -> bool {
        let begun = Instant::now();
        loop {
            // Read the flag first: then all cycles from before the end are found.
            let ended = self.shared.has_ended();
            if self.waiting() > 0 {
                return true;
            }
            let remaining = timeout.saturating_sub(begun.elapsed());
            if ended || remaining.is_zero() {
                return false;
            }
            std::thread::sleep(remaining.min(LOOK));
        }
    }

    /// Returns the number of cycles that wait in the ring.
    pub fn waiting(&self) -> usize {
        self.queue.waiting()
    }

    /// Returns the number of cycles so far that did not fit into the ring.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    /// True if `other` reads the cycles of the same control thread.
    pub fn is_of_same_thread(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    /// True if the thread has ended and every cycle has been read.
    pub fn has_ended(&self) -> bool {
        self.shared.has_ended() && self.waiting() == 0
    }
}

impl<R> Drop for CycleReader<R> {
    fn drop(&mut self) {
        self.shared.readers.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Time between two checks of a reader that waits.
const LOOK: Duration = Duration::from_millis(5);

/// Writing end of a reader's ring, which the thread owns. It contains memory, so the thread passes
/// it on to be freed.
#[derive(Debug)]
pub struct CycleWriter<R = Record> {
    queue: Sender<Entry<R>>,
    lost: Arc<AtomicU64>,
    /// Number of cycles lost since the last cycle that fitted into the ring.
    gap: u64,
}

impl<R: Copy> CycleWriter<R> {
    fn push(&mut self, record: R, datagram: &Datagram, received: Instant) {
        let entry = Entry {
            record,
            received,
            lost: self.gap,
            datagram: *datagram,
        };
        match self.queue.push(entry) {
            Ok(()) => self.gap = 0,
            Err(Full(_)) => {
                self.gap += 1;
                // There is one writer, so a load and a store are enough. Relaxed, because the count
                // orders nothing.
                let lost = self.lost.load(Ordering::Relaxed);
                self.lost.store(lost + 1, Ordering::Relaxed);
            }
        }
    }
}

/// A cycle in a ring. The reader decodes the state, so the thread does not have to convert it.
#[derive(Debug)]
struct Entry<R> {
    record: R,
    received: Instant,
    lost: u64,
    datagram: Datagram,
}

/// Passes cycles to the attached readers: the thread's end of a feed. No method allocates, frees or
/// waits. Dropping it does, when the thread ends.
#[derive(Debug)]
pub struct CyclePublisher<R = Record> {
    attached: Receiver<CycleWriter<R>>,
    writers: [Option<CycleWriter<R>>; READERS_MAX],
    shared: Arc<Shared>,
    /// Buffer from which a state is copied into the rings.
    datagram: Box<Datagram>,
}

/// Returns the two ends of the feed of a control thread whose robot uses protocol `version`.
pub fn cycle_feed<R>(version: Version) -> (CycleFeed<R>, CyclePublisher<R>) {
    let (attached, receiver) = queue::queue(READERS_MAX);
    let shared = Arc::<Shared>::default();
    let feed = CycleFeed {
        attached: Arc::new(Mutex::new(attached)),
        shared: shared.clone(),
        version,
    };
    let publisher = CyclePublisher {
        attached: receiver,
        writers: core::array::from_fn(|_| None),
        shared,
        datagram: Box::new(Datagram::ZERO),
    };
    (feed, publisher)
}

impl<R: Copy> CyclePublisher<R> {
    /// Accepts the readers that were attached, while there is room for them.
    pub fn take_attached(&mut self) {
        for free in self.writers.iter_mut().filter(|writer| writer.is_none()) {
            *free = self.attached.pop();
        }
    }

    /// Passes on a cycle: the record, the bytes of its state, and the time when the state was
    /// received.
    pub fn push(&mut self, record: R, state: &[u8], received: Instant) {
        if self.writers.iter().all(Option::is_none) {
            return;
        }
        self.datagram.set(state);
        for writer in self.writers.iter_mut().flatten() {
            writer.push(record, &self.datagram, received);
        }
    }

    /// Returns the writing end of a ring whose reader was dropped, so that another thread frees it.
    pub fn take_detached(&mut self) -> Option<CycleWriter<R>> {
        let detached = |writer: &mut CycleWriter<R>| writer.queue.is_abandoned();
        self.writers
            .iter_mut()
            .find_map(|writer| writer.take_if(detached))
    }
}

impl<R> Drop for CyclePublisher<R> {
    fn drop(&mut self) {
        self.shared.ended.store(true, Ordering::Release);
    }
}
