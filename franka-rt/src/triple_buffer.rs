//! One writer, one reader, newest value only, for values of any type: how goals enter the thread.
//!
//! Three buffers hold the values. The writer and the reader own one each, and the third waits
//! between them. A write fills the writer's buffer and swaps it with the buffer in between; a read
//! swaps the reader's buffer if the one in between is newer. Each side takes one step, so neither
//! can delay the other, and no value is ever torn. [`slot`](crate::slot) has many readers, but only
//! carries values that can be written as words.
//!
//! ```
//! let (mut writer, mut reader) = franka_rt::triple_buffer::triple_buffer();
//! assert_eq!(reader.read_newer(), None);
//! writer.write("first");
//! writer.write("second");
//! assert_eq!(reader.read_newer(), Some("second"));
//! assert_eq!(reader.read_newer(), None);
//! ```
//!
//! Each buffer is behind a mutex, which replaces `unsafe`. No mutex is ever contended, because a
//! buffer has one owner at a time. So `try_lock` is one atomic operation and always succeeds.
//! `tests/loom` explores the interleavings.

#[cfg(loom)]
use loom::sync::{
    Arc, Mutex,
    atomic::{AtomicUsize, Ordering},
};
#[cfg(not(loom))]
use std::sync::{
    Arc, Mutex,
    atomic::{AtomicUsize, Ordering},
};

/// Creates an empty buffer. This call allocates; neither end does afterwards.
pub fn triple_buffer<T>() -> (Writer<T>, Reader<T>) {
    let shared = Arc::new(Shared {
        buffers: [(); 3].map(|()| Mutex::new(None)),
        between: AtomicUsize::new(1),
    });
    let reader = Reader {
        shared: shared.clone(),
        own: 2,
    };
    (Writer { shared, own: 0 }, reader)
}

#[derive(Debug)]
struct Shared<T> {
    buffers: [Mutex<Option<T>>; 3],
    /// Index of the buffer that waits between the two ends, and [`FRESH`] if the writer put it
    /// there.
    between: AtomicUsize,
}

const FRESH: usize = 4;

/// Writing end.
#[derive(Debug)]
pub struct Writer<T> {
    shared: Arc<Shared<T>>,
    own: usize,
}

/// Reading end.
#[derive(Debug)]
pub struct Reader<T> {
    shared: Arc<Shared<T>>,
    own: usize,
}

impl<T> Writer<T> {
    /// Makes `value` the newest value. An earlier value that was not read is dropped, on this side.
    pub fn write(&mut self, value: T) {
        if let Ok(mut buffer) = self.shared.buffers[self.own].try_lock() {
            *buffer = Some(value);
        }
        // Release: the reader sees the value. Acquire: the reader has left the buffer that comes
        // back.
        let back = self.shared.between.swap(self.own | FRESH, Ordering::AcqRel);
        self.own = back & !FRESH;
    }
}

impl<T> Reader<T> {
    /// Takes the newest value, if it was not taken before.
    pub fn read_newer(&mut self) -> Option<T> {
        // Only the swap needs an order: this load decides nothing but whether to try.
        if self.shared.between.load(Ordering::Relaxed) & FRESH == 0 {
            return None;
        }
        let newer = self.shared.between.swap(self.own, Ordering::AcqRel);
        self.own = newer & !FRESH;
        self.shared.buffers[self.own].try_lock().ok()?.take()
    }
}

#[cfg(all(test, not(loom)))]
mod tests {
    use super::*;

    /// Runs every order of ten writes and reads.
    #[test]
    fn each_buffer_has_one_owner_and_reads_return_the_newest_value() {
        for order in 0_u32..1 << 10 {
            let (mut writer, mut reader) = triple_buffer();
            let mut newest = None;
            for step in 0..10 {
                if order >> step & 1 == 1 {
                    writer.write(step);
                    newest = Some(step);
                } else {
                    assert_eq!(reader.read_newer(), newest.take(), "order {order:010b}");
                }
                let between = writer.shared.between.load(Ordering::Relaxed) & !FRESH;
                let mut owned = [writer.own, reader.own, between];
                owned.sort_unstable();
                assert_eq!(owned, [0, 1, 2], "order {order:010b}");
            }
        }
    }
}
