//! The eventfd by which the thread wakes whatever waits for it: any reactor can poll it.
//!
//! Notifying is one non-blocking `write`, without a lock and without knowledge of what listens.
//! Notifications add up until the listener drains them, so a slow listener is woken once and then
//! looks at the slot and the queues.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, RawFd};
use std::sync::Arc;

use crate::sys;

/// An eventfd. Clones are the same one.
///
/// For Tokio: `AsyncFd::new(event_fd)`, await `readable()`, [`EventFd::drain`], then the guard's
/// `clear_ready`, then look. A notification that comes between is not lost: it makes the descriptor
/// readable again.
#[derive(Clone, Debug)]
pub struct EventFd(Arc<File>);

impl EventFd {
    /// Opens one without a notification.
    ///
    /// # Errors
    /// If the process or the system has no descriptor left.
    pub fn new() -> io::Result<Self> {
        Ok(Self(Arc::new(sys::eventfd()?.into())))
    }

    /// Makes the descriptor readable. Never blocks and cannot fail in a way that matters: at
    /// 2^64 - 2 notifications that were not drained the write is refused, and the descriptor is
    /// readable anyway.
    pub fn notify(&self) {
        let _ = (&*self.0).write(&1u64.to_ne_bytes());
    }

    /// Returns the number of notifications since the last call, and makes the descriptor
    /// unreadable. Never blocks.
    pub fn drain(&self) -> u64 {
        let mut count = [0; 8];
        match (&*self.0).read(&mut count) {
            Ok(8) => u64::from_ne_bytes(count),
            // An eventfd gives eight bytes or, without a notification, the error `WouldBlock`.
            _ => 0,
        }
    }
}

impl AsFd for EventFd {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }
}

impl AsRawFd for EventFd {
    fn as_raw_fd(&self) -> RawFd {
        self.0.as_raw_fd()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notifications_add_up_until_drained() {
        let event_fd = EventFd::new().expect("a descriptor is free");
        let thread_side = event_fd.clone();
        assert_eq!(event_fd.drain(), 0);
        thread_side.notify();
        thread_side.notify();
        assert_eq!(event_fd.drain(), 2);
        assert_eq!(event_fd.drain(), 0);
    }

    #[test]
    fn a_saturated_count_neither_blocks_nor_stays_unreadable() {
        let event_fd = EventFd::new().expect("a descriptor is free");
        (&*event_fd.0)
            .write_all(&(u64::MAX - 1).to_ne_bytes())
            .expect("the largest count is accepted");
        event_fd.notify();
        assert_eq!(event_fd.drain(), u64::MAX - 1);
    }
}
