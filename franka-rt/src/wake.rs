//! The bell that the thread rings when it has left something to be looked at: an eventfd, which any
//! reactor can wait for.
//!
//! Ringing is one non-blocking `write`, without a lock and without knowledge of who listens. Rings
//! add up until the listener clears them, so a slow listener is woken once and then looks at the
//! slot and the queues.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, RawFd};
use std::sync::Arc;

use crate::sys;

/// One bell. Clones ring and clear the same one.
///
/// For Tokio: `AsyncFd::new(wake)`, await `readable()`, [`Wake::clear`], then the guard's
/// `clear_ready`, then look. A ring that comes between is not lost: it makes the descriptor
/// readable again.
#[derive(Clone, Debug)]
pub struct Wake(Arc<File>);

impl Wake {
    /// Makes a silent bell.
    ///
    /// # Errors
    /// If the process or the system has no descriptor left.
    pub fn new() -> io::Result<Self> {
        Ok(Self(Arc::new(sys::eventfd()?.into())))
    }

    /// Rings. Never blocks and cannot fail in a way that matters: at 2^64 - 2 rings that nobody
    /// cleared the write is refused, and the descriptor is readable anyway.
    pub fn ring(&self) {
        let _ = (&*self.0).write(&1u64.to_ne_bytes());
    }

    /// Silences the bell and returns how often it rang since the last time. Never blocks.
    pub fn clear(&self) -> u64 {
        let mut count = [0; 8];
        match (&*self.0).read(&mut count) {
            Ok(8) => u64::from_ne_bytes(count),
            // An eventfd gives eight bytes or, without a ring, the error `WouldBlock`.
            _ => 0,
        }
    }
}

impl AsFd for Wake {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }
}

impl AsRawFd for Wake {
    fn as_raw_fd(&self) -> RawFd {
        self.0.as_raw_fd()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_add_up_until_cleared() {
        let bell = Wake::new().expect("a descriptor is free");
        let thread_side = bell.clone();
        assert_eq!(bell.clear(), 0);
        thread_side.ring();
        thread_side.ring();
        assert_eq!(bell.clear(), 2);
        assert_eq!(bell.clear(), 0);
    }

    #[test]
    fn a_saturated_bell_neither_blocks_nor_falls_silent() {
        let bell = Wake::new().expect("a descriptor is free");
        (&*bell.0)
            .write_all(&(u64::MAX - 1).to_ne_bytes())
            .expect("the largest count is accepted");
        bell.ring();
        assert_eq!(bell.clear(), u64::MAX - 1);
    }
}
