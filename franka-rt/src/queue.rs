//! One sender, one receiver, every value in order: how orders and chunks enter the thread, and how
//! notices, records, states and chunks leave it.
//!
//! ```
//! use franka_rt::queue::{self, Full};
//!
//! let (mut sender, mut receiver) = queue::queue(2);
//! sender.push(1)?;
//! sender.push(2)?;
//! assert_eq!(sender.push(3), Err(Full(3)));
//! assert_eq!(receiver.pop(), Some(1));
//! assert_eq!((sender.free(), receiver.waiting()), (1, 1));
//! # Ok::<(), Full<i32>>(())
//! ```
//!
//! The ring is rtrb's: neither end ever waits for the other. Crossbeam's `ArrayQueue` does not
//! suit: there, an end that finds the other in the middle of an operation spins until that is done.
//! If the control thread has preempted the other end, on the only processor that it may run on,
//! that never happens.

use core::hint::black_box;
use core::mem::MaybeUninit;

/// A queue for `capacity` values, or one if that is zero. Its memory has been written to, so that
/// no cycle meets a page of it for the first time.
pub fn queue<T>(capacity: usize) -> (Sender<T>, Receiver<T>) {
    let capacity = capacity.max(1);
    let (mut producer, consumer) = rtrb::RingBuffer::new(capacity);
    if let Ok(mut unused) = producer.write_chunk_uninit(capacity) {
        // The second part is empty: a new ring begins at its start.
        let (elements, _) = unused.as_mut_slices();
        elements.fill_with(MaybeUninit::zeroed);
        black_box(elements);
        // Nothing is committed: the ring stays empty.
    }
    (Sender(producer), Receiver(consumer))
}

/// The end that values go into. Dropping it leaves them to the receiver.
#[derive(Debug)]
pub struct Sender<T>(rtrb::Producer<T>);

/// The end that values come out of.
#[derive(Debug)]
pub struct Receiver<T>(rtrb::Consumer<T>);

/// A queue has no room for this value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the queue is full")]
pub struct Full<T>(
    /// The value that could not be sent.
    pub T,
);

impl<T> Sender<T> {
    /// Appends a value. Never waits.
    ///
    /// # Errors
    /// [`Full`] with the value.
    pub fn push(&mut self, value: T) -> Result<(), Full<T>> {
        self.0
            .push(value)
            .map_err(|rtrb::PushError::Full(value)| Full(value))
    }

    /// Appends the results of `next`, up to `count` values, while there is room. `next` is not
    /// called without room for its result. Returns how many came.
    pub fn push_from(&mut self, count: usize, next: impl FnMut() -> Option<T>) -> usize {
        let count = count.min(self.free());
        match self.0.write_chunk_uninit(count) {
            Ok(room) => room.fill_from_iter(core::iter::from_fn(next)),
            Err(rtrb::chunks::ChunkError::TooFewSlots(_)) => 0,
        }
    }

    /// True if the receiver has been dropped.
    pub fn is_abandoned(&self) -> bool {
        self.0.is_abandoned()
    }

    /// Number of values that there is room for, at least.
    pub fn free(&self) -> usize {
        self.0.slots()
    }
}

impl<T> Receiver<T> {
    /// The oldest value. Never waits.
    pub fn pop(&mut self) -> Option<T> {
        self.0.pop().ok()
    }

    /// Number of values that are waiting, at least.
    pub fn waiting(&self) -> usize {
        self.0.slots()
    }

    /// Drops the oldest `count` values, or as many as are waiting.
    pub fn skip(&mut self, count: usize) {
        if let Ok(chunk) = self.0.read_chunk(count.min(self.waiting())) {
            chunk.commit_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_out_in_order_and_a_full_queue_returns_what_it_cannot_take() {
        let (mut sender, mut receiver) = queue(3);
        for value in 0..3 {
            sender.push(value).unwrap();
        }
        assert_eq!(sender.push(3), Err(Full(3)));
        assert_eq!((sender.free(), receiver.waiting()), (0, 3));
        receiver.skip(1);
        assert_eq!(receiver.pop(), Some(1));
        receiver.skip(7);
        assert_eq!((receiver.pop(), receiver.waiting()), (None, 0));
    }

    #[test]
    fn a_queue_holds_one_value_at_least() {
        let (mut sender, mut receiver) = queue(0);
        assert_eq!(sender.push('a'), Ok(()));
        assert_eq!(sender.push('b'), Err(Full('b')));
        assert_eq!(receiver.pop(), Some('a'));
    }

    #[test]
    fn no_value_is_asked_for_without_room() {
        let (mut sender, mut receiver) = queue(3);
        sender.push(10).unwrap();
        let mut values = 11..20;
        assert_eq!(sender.push_from(1, || values.next()), 1);
        assert_eq!(sender.push_from(8, || values.next()), 1);
        assert_eq!(sender.push_from(8, || values.next()), 0);
        assert_eq!(values.next(), Some(13), "none was lost");
        receiver.skip(3);
        assert_eq!(sender.push_from(2, || None), 0);
        assert_eq!(receiver.pop(), None);
    }
}
