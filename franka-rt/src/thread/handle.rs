//! The control thread, as other threads use it.

use core::time::Duration;
use std::any::Any;
use std::sync::Arc;
use std::thread::JoinHandle;

use franka_proto::{RobotState, Version};

use super::cycle_feed::{CycleFeed, CycleWriter};
use super::handoff::NotReturned;
use super::lifetime::Lifetime;
use crate::driver::{Driver, Record};
use crate::event_fd::EventFd;
use crate::panic;
use crate::queue::{Receiver, Sender};
use crate::sched::Granted;
use crate::slot::{Read, SlotReader, Words};
use crate::state_wakeups::StateWakeups;
use crate::stats::Stats;
use crate::thread::{Core, Lender, LinkFault};

/// Everything that connects other threads to one running control thread. The fields are independent
/// and may be moved out.
#[derive(Debug)]
pub struct Handle<C: Core = Driver> {
    /// Orders to the core. The thread reads them with the next state, or within
    /// [`crate::exchange::TICK`] if the robot is silent.
    pub orders: Sender<C::Order>,
    /// Reports from the core and the loop, oldest first.
    pub notices: Receiver<Notice<C::Event, C::Record>>,
    /// One record per state, oldest first. If the queue is full, a record is lost and counted in
    /// [`Stats::records_lost`].
    pub records: Receiver<C::Record>,
    /// The newest state.
    pub states: StateReader,
    /// All states, oldest first. If the queue is full, a state is lost and counted in
    /// [`Stats::states_lost`].
    pub sequence: StateSequence,
    /// Attaches readers of all cycles.
    pub cycles: CycleFeed<C::Record>,
    /// Wakes the listener after every cycle with a notice, after every state while wake-ups are
    /// requested, otherwise after every fiftieth state, and when the thread ends.
    pub event_fd: EventFd,
    /// Flag that requests a wake-up for every state; initially true.
    pub state_wakeups: StateWakeups,
    /// Counts and times of the loop.
    pub stats: Arc<Stats>,
    /// Results of the thread's requests to the operating system.
    pub granted: Granted,
    /// Lends the cycle to threads of the user.
    pub lender: Lender<C>,
    /// The running thread. Dropping it stops the thread.
    pub thread: Thread<C>,
}

/// Report of the thread.
#[derive(Debug)]
pub enum Notice<E, R = Record> {
    /// An event of the core. None is lost, because events wait in the core while the queue is full.
    Core(E),
    /// A fault of the link, reported once when it begins.
    Link(LinkFault),
    /// A reader of cycles was dropped. The notice carries the memory of its ring, to be freed.
    Detached(CycleWriter<R>),
}

/// The running thread. Dropping it asks the thread to stop, but does not wait.
#[derive(Debug)]
pub struct Thread<C> {
    pub(super) shared: Arc<Lifetime>,
    pub(super) joiner: Option<JoinHandle<Result<C, Lost>>>,
    pub(super) link_timeout: Duration,
}

impl<C> Thread<C> {
    /// Asks the thread to stop before its next cycle, or within [`crate::exchange::TICK`] if the
    /// robot is silent. Does not finish a running motion first, so the robot will miss its
    /// commands.
    pub fn stop(&self) {
        self.shared.ask_to_stop();
    }

    /// True if the loop has ended, because it was stopped or the core panicked. The eventfd is
    /// notified afterwards.
    pub fn has_ended(&self) -> bool {
        self.shared.has_ended()
    }

    /// Returns the link timeout if a thread has borrowed the cycle and has not run it for that
    /// long. Meanwhile the thread receives and publishes no state, and cannot detect the loss of
    /// the link. The eventfd is notified after each change.
    pub fn stalled(&self) -> Option<Duration> {
        self.shared.is_stalled().then_some(self.link_timeout)
    }

    /// Stops the thread, waits for its end and returns the core. Blocks for a cycle or a tick, so
    /// in async code call it where blocking is allowed.
    ///
    /// # Errors
    /// Returns [`Lost`] if the core has panicked or is lent.
    pub fn join(mut self) -> Result<C, Lost> {
        self.stop();
        let joiner = self
            .joiner
            .take()
            .expect("only this method takes it, and it consumes the thread");
        match joiner.join() {
            Ok(ended) => ended,
            Err(payload) => Err(Lost::panicked(&*payload)),
        }
    }
}

impl<C> Drop for Thread<C> {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Reason why an ended thread cannot return its core.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Lost {
    /// The core panicked, which ended the thread, so no more commands are sent. This is a defect.
    /// The process continues.
    #[error("the control thread panicked: {message}")]
    Panicked {
        /// Message of the panic.
        message: String,
    },
    /// The cycle was lent when the thread was stopped. Dropping the [`Lease`](super::Lease)
    /// destroys it.
    #[error("another thread had borrowed the control cycle and did not return it")]
    Lent,
    /// The core panicked in a thread that had borrowed the cycle, which ended the control thread.
    /// This is a defect. The process continues.
    #[error("the control cycle panicked in a thread that had borrowed it")]
    Spoilt,
}

impl From<NotReturned> for Lost {
    fn from(reason: NotReturned) -> Self {
        match reason {
            NotReturned::Lent => Self::Lent,
            NotReturned::Spoilt => Self::Spoilt,
        }
    }
}

impl Lost {
    pub(super) fn panicked(payload: &(dyn Any + Send)) -> Self {
        Self::Panicked {
            message: panic::message(payload),
        }
    }
}

/// Reads the newest state that the thread has received. Clones read independently of each other.
#[derive(Clone, Debug)]
pub struct StateReader {
    pub(super) slot: SlotReader<Datagram>,
    pub(super) version: Version,
    pub(super) size: usize,
}

impl StateReader {
    /// Returns the newest state, if this reader has not returned it yet. Never waits.
    ///
    /// Also returns `None` if this thread was delayed in the middle of every attempt. Another
    /// wake-up follows in this case.
    pub fn newest(&mut self) -> Option<RobotState> {
        match self.slot.read_retry(ATTEMPTS) {
            // The thread only publishes states that it has decoded itself.
            Read::Newer(datagram) => {
                RobotState::decode(self.version, &datagram.0[..self.size]).ok()
            }
            Read::Same | Read::Torn => None,
        }
    }
}

/// Receives the states of the thread, each once and in order.
#[derive(Debug)]
pub struct StateSequence {
    pub(super) queue: Receiver<Datagram>,
    pub(super) version: Version,
    pub(super) size: usize,
}

impl StateSequence {
    /// Removes and returns the oldest state. Never waits.
    pub fn pop(&mut self) -> Option<RobotState> {
        let datagram = self.queue.pop()?;
        // The thread only passes on states that it has decoded itself.
        RobotState::decode(self.version, &datagram.0[..self.size]).ok()
    }

    /// Returns the number of waiting states. A state counts only after it was readable as the
    /// newest state.
    pub fn waiting(&self) -> usize {
        self.queue.waiting()
    }

    /// Discards the oldest `count` states, or all if there are fewer, without decoding them.
    pub fn skip(&mut self, count: usize) {
        self.queue.skip(count);
    }
}

/// Number of attempts to read. An attempt fails if the state is replaced twice while it reads.
const ATTEMPTS: usize = 16;

/// Bytes of a state, at the front of the array. Each reader decodes them, so the thread does not
/// have to convert the state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Datagram(pub(super) [u8; RobotState::MAX_SIZE]);

impl Datagram {
    pub(super) const ZERO: Self = Self([0; RobotState::MAX_SIZE]);

    /// Copies the bytes of a state to the front; the rest does not change.
    pub(super) fn set(&mut self, state: &[u8]) {
        self.0[..state.len()].copy_from_slice(state);
    }
}

impl Words for Datagram {
    const WORDS: usize = RobotState::MAX_SIZE.div_ceil(WORD);

    fn store(&self, words: &mut [u64]) {
        for (word, bytes) in words.iter_mut().zip(self.0.chunks(WORD)) {
            let mut padded = [0; WORD];
            padded[..bytes.len()].copy_from_slice(bytes);
            *word = u64::from_ne_bytes(padded);
        }
    }

    fn load(words: &[u64]) -> Self {
        let mut bytes = [0; RobotState::MAX_SIZE];
        for (bytes, word) in bytes.chunks_mut(WORD).zip(words) {
            bytes.copy_from_slice(&word.to_ne_bytes()[..bytes.len()]);
        }
        Self(bytes)
    }
}

const WORD: usize = size_of::<u64>();

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_datagram_survives_its_words() {
        let datagram = Datagram(core::array::from_fn(|i| (i * 7 + 1) as u8));
        let mut words = [0; Datagram::WORDS];
        datagram.store(&mut words);
        assert!(Datagram::load(&words).0 == datagram.0);
    }

    #[test]
    fn a_panic_keeps_its_message() {
        for (payload, message) in [
            (Box::new("static") as Box<dyn Any + Send>, "static"),
            (Box::new(String::from("formatted")), "formatted"),
            (Box::new(5), "no message"),
        ] {
            let message = message.to_owned();
            assert_eq!(Lost::panicked(&*payload), Lost::Panicked { message });
        }
    }
}
