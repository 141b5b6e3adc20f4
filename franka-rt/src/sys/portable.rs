//! Requests on systems that are not known to grant any. Every request is refused.
//! `Realtime::Enforce` returns this as an error; `Realtime::Ignore` accepts it.

use core::time::Duration;
use std::io::{self, Read as _, Write as _};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;

/// Refuses, because no priority is known that a control thread could rely on.
pub(crate) fn max_fifo_priority() -> Result<i32, i32> {
    Err(libc::ENOTSUP)
}

/// Refuses: see [`max_fifo_priority`].
pub(crate) fn set_fifo(_: i32) -> Result<(), i32> {
    Err(libc::ENOTSUP)
}

/// Refuses, because a thread cannot be bound to a processor here.
pub(crate) fn pin_to(_: usize) -> Result<(), i32> {
    Err(libc::ENOTSUP)
}

pub(crate) fn lock_memory() -> Result<(), i32> {
    Err(libc::ENOTSUP)
}

pub(crate) fn busy_poll(_: &impl AsFd, _: Duration) -> Result<(), i32> {
    Err(libc::ENOPROTOOPT)
}

/// A pair of sockets that replaces an eventfd: a notification is a byte in the buffer of one
/// socket.
#[derive(Debug)]
pub(crate) struct Wake {
    listener: UnixStream,
    notifier: UnixStream,
}

impl Wake {
    pub(crate) fn new() -> io::Result<Self> {
        let (listener, notifier) = UnixStream::pair()?;
        listener.set_nonblocking(true)?;
        notifier.set_nonblocking(true)?;
        Ok(Self { listener, notifier })
    }

    /// Makes the descriptor readable. Never blocks. If the buffer is full the write is refused, but
    /// the descriptor is already readable.
    pub(crate) fn notify(&self) {
        let _ = (&self.notifier).write(&[1]);
    }

    /// Returns the number of notifications in the buffer, and removes them. Never blocks.
    pub(crate) fn drain(&self) -> u64 {
        let mut notifications = 0;
        let mut bytes = [0; 4096];
        loop {
            match (&self.listener).read(&mut bytes) {
                Ok(length) if length > 0 => notifications += length as u64,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                // The buffer is empty. The other end stays open as long as this end.
                _ => return notifications,
            }
        }
    }

    pub(crate) fn as_fd(&self) -> BorrowedFd<'_> {
        self.listener.as_fd()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_buffer_neither_blocks_nor_stays_unreadable() {
        let wake = Wake::new().expect("two descriptors are free");
        for _ in 0..100_000 {
            wake.notify();
        }
        assert!(wake.drain() > 0);
        assert_eq!(wake.drain(), 0);
        wake.notify();
        assert_eq!(wake.drain(), 1);
    }
}
