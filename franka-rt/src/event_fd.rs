//! Eventfd with which the control thread wakes the receiver of its reports. Any reactor can poll
//! it. On systems other than Linux, a pair of sockets replaces it.
//!
//! A notification is one non-blocking `write`, without a lock. The writer does not know the
//! listener. Notifications add up until the listener drains them, so a slow listener is woken once,
//! and then reads the slot and the queues.

use std::io;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, RawFd};
use std::sync::Arc;

use crate::sys;

/// An eventfd. Clones share one descriptor.
///
/// With Tokio, create `AsyncFd::new(event_fd)` and await `readable()`. Then call
/// [`EventFd::drain`], then the guard's `clear_ready`, and then read the queues. A notification
/// that arrives between these steps is not lost, because it makes the descriptor readable again.
#[derive(Clone, Debug)]
pub struct EventFd(Arc<sys::Wake>);

impl EventFd {
    /// Opens an eventfd that is not readable yet.
    ///
    /// # Errors
    /// Returns an error if the process or the system has no descriptor left.
    pub fn new() -> io::Result<Self> {
        Ok(Self(Arc::new(sys::Wake::new()?)))
    }

    /// Makes the descriptor readable. Never blocks. If pending notifications leave no room for
    /// another, the descriptor is already readable, so the error is ignored.
    pub fn notify(&self) {
        self.0.notify();
    }

    /// Returns the number of notifications since the last call, and makes the descriptor
    /// unreadable. Never blocks.
    pub fn drain(&self) -> u64 {
        self.0.drain()
    }
}

impl AsFd for EventFd {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }
}

impl AsRawFd for EventFd {
    fn as_raw_fd(&self) -> RawFd {
        self.0.as_fd().as_raw_fd()
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
}
