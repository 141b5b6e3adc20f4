//! Queue with one sender and one receiver that passes every value, in order. Orders and chunks
//! enter the thread through queues; events, records, states and chunks leave it through them.
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
//! The ring is rtrb's: neither end ever waits for the other. Crossbeam's `ArrayQueue` is not
//! suitable, because an end spins while the other end is in the middle of an operation. If both
//! share one processor and the control thread has preempted the other end, the control thread would
//! spin forever.

use core::hint::black_box;
use core::mem::MaybeUninit;

/// Returns a queue for `capacity` values, or for one value if `capacity` is zero. Its memory is
/// written to, so that no cycle causes a page fault in it.
pub fn queue<T>(capacity: usize) -> (Sender<T>, Receiver<T>) {
    let capacity = capacity.max(1);
    let (mut producer, consumer) = rtrb::RingBuffer::new(capacity);
    if let Ok(mut unused) = producer.write_chunk_uninit(capacity) {
        // The second part is empty, because a new ring begins at its start.
        let (elements, _) = unused.as_mut_slices();
        elements.fill_with(MaybeUninit::zeroed);
        black_box(elements);
        // No element is committed, so the ring stays empty.
    }
    (Sender(producer), Receiver(consumer))
}

/// Sending end of a queue. If it is dropped, the receiver can still read the waiting values.
#[derive(Debug)]
pub struct Sender<T>(rtrb::Producer<T>);

/// Receiving end of a queue.
#[derive(Debug)]
pub struct Receiver<T>(rtrb::Consumer<T>);

/// Error: the queue has no room for a value.
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
    /// Returns [`Full`] with the value if there is no room.
    pub fn push(&mut self, value: T) -> Result<(), Full<T>> {
        self.0
            .push(value)
            .map_err(|rtrb::PushError::Full(value)| Full(value))
    }

    /// Appends the results of `next`, up to `count` values, while there is room. Calls `next` only
    /// if its result fits. Returns the number of appended values.
    pub fn push_from(&mut self, count: usize, next: impl FnMut() -> Option<T>) -> usize {
        let count = count.min(self.free());
        match self.0.write_chunk_uninit(count) {
            Ok(room) => room.fill_from_iter(core::iter::from_fn(next)),
            Err(rtrb::chunks::ChunkError::TooFewSlots(_)) => 0,
        }
    }

    /// True if the receiver was dropped.
    pub fn is_abandoned(&self) -> bool {
        self.0.is_abandoned()
    }

    /// Returns the number of values that certainly fit.
    pub fn free(&self) -> usize {
        self.0.slots()
    }
}

impl<T> Receiver<T> {
    /// Removes and returns the oldest value. Never waits.
    pub fn pop(&mut self) -> Option<T> {
        self.0.pop().ok()
    }

    /// Returns the number of values that are certainly waiting.
    pub fn waiting(&self) -> usize {
        self.0.slots()
    }

    /// Drops the oldest `count` values, or all waiting values if there are fewer.
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
    fn queue_keeps_order_and_returns_values_when_full() {
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
