//! Every cycle of a control thread, for readers that come and go while it runs: recorders.
//!
//! ```text
//! CycleFeed::attach --queue--> CyclePublisher: READERS_MAX rings at most ----> a CycleReader each
//!                                  |
//!                                  +-- of a reader that was dropped --> Notice::Detached, freed elsewhere
//! ```
//!
//! Each reader has its own ring, whose memory is allocated when the reader is attached. The thread
//! copies each cycle into every ring and neither waits, allocates nor frees: a full ring drops the
//! cycle and counts it.

use core::time::Duration;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use franka_proto::{RobotState, Version};

use super::handle::Datagram;
use crate::driver::Record;
use crate::queue::{self, Full, Receiver, Sender};

/// Largest number of readers of one control thread at a time.
pub const READERS_MAX: usize = 4;

/// One cycle of the control thread: a state, and the work of the driver for it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CapturedCycle<R = Record> {
    /// Record of the driver.
    pub record: R,
    /// The state.
    pub state: RobotState,
    /// Time at which the thread had received it, by this host's monotonic clock.
    pub received: Instant,
    /// Number of cycles just before this one that did not fit into this reader's ring.
    pub lost: u64,
}

impl<R> CapturedCycle<R> {
    /// Returns a cycle that follows the previous one without loss.
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

/// State shared by both ends of a feed.
#[derive(Debug, Default)]
struct Shared {
    /// Number of readers.
    readers: AtomicUsize,
    /// Flag that is set, with Release, when no further cycle will come.
    ended: AtomicBool,
}

impl Shared {
    /// Acquire, pairs with the Release in the drop of [`CyclePublisher`]: a reader that sees the
    /// end finds every cycle that was pushed before the end.
    fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }
}

/// Reason why no reader was attached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AttachError {
    /// The number of readers is at its maximum. Drop a reader first.
    #[error("got one reader of cycles too many, expected {READERS_MAX} at most: drop one first")]
    TooMany,
    /// The ring cannot have this length.
    #[error("the ring of the reader has {got} cycles, expected 1 to {}", CycleFeed::<()>::CAPACITY_MAX)]
    Capacity {
        /// The requested capacity.
        got: usize,
    },
    /// The thread has not accepted the readers that were attached before. Another thread has
    /// borrowed its cycle and does not run it.
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
    /// Default length of a ring, in cycles: 4 s, 12 MB.
    pub const DEFAULT_CAPACITY: usize = 4096;

    /// Largest length of a ring, in cycles: a minute, 200 MB.
    pub const CAPACITY_MAX: usize = 65_536;

    /// Attaches a reader with a ring of `capacity` cycles, usually [`Self::DEFAULT_CAPACITY`]. The
    /// reader receives every cycle from shortly after the call. Allocates the ring and writes to
    /// all of it, which takes some milliseconds.
    ///
    /// # Errors
    /// [`AttachError`].
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
        // Its drop counts one reader less, after an error as well.
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

/// Receives the cycles of a control thread, each once and in order. For an ordinary thread or task.
/// Dropping the reader detaches it.
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
        // The thread passes on only what it has decoded itself.
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
    /// or no further one will come. Checks every 5 ms, because the control thread wakes no one for
    /// this.
    pub fn wait(&self, timeout: Duration) -> bool {
        let begun = Instant::now();
        loop {
            // Read the flag first, so that the cycles from before the end are then found.
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

    /// True if the thread has ended and every cycle was read.
    pub fn has_ended(&self) -> bool {
        self.shared.has_ended() && self.waiting() == 0
    }
}

impl<R> Drop for CycleReader<R> {
    fn drop(&mut self) {
        self.shared.readers.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Time between two checks of a waiting reader.
const LOOK: Duration = Duration::from_millis(5);

/// The writing end of a reader's ring, for the thread. It owns memory, so the thread passes it on
/// to be freed.
#[derive(Debug)]
pub struct CycleWriter<R = Record> {
    queue: Sender<Entry<R>>,
    lost: Arc<AtomicU64>,
    /// Number of cycles lost since the last cycle that fitted.
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

/// A cycle in a ring. The reader decodes the state, which saves the thread a conversion.
#[derive(Debug)]
struct Entry<R> {
    record: R,
    received: Instant,
    lost: u64,
    datagram: Datagram,
}

/// Passes cycles on to the attached readers: the thread's end of a feed. No method allocates, frees
/// or waits; dropping it does, when the thread ends.
#[derive(Debug)]
pub struct CyclePublisher<R = Record> {
    attached: Receiver<CycleWriter<R>>,
    writers: [Option<CycleWriter<R>>; READERS_MAX],
    shared: Arc<Shared>,
    /// Buffer from which a state is copied into the rings.
    datagram: Box<Datagram>,
}

/// Returns the two ends of the feed of one control thread, whose robot has protocol `version`.
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

    /// Passes on a cycle: the record, the bytes of its state and their time of receipt.
    pub fn push(&mut self, record: R, state: &[u8], received: Instant) {
        if self.writers.iter().all(Option::is_none) {
            return;
        }
        self.datagram.set(state);
        for writer in self.writers.iter_mut().flatten() {
            writer.push(record, &self.datagram, received);
        }
    }

    /// Returns the writing end of a ring whose reader was dropped, to be freed outside the thread.
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
