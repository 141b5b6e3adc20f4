//! Receives that fail on a socket of another thread.

use std::fs::File;
use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd, RawFd};

use nix::libc;

/// Makes every receive from a socket fail at once, with `ENOTSOCK`, until it is dropped: its
/// descriptor refers to `/dev/null` meanwhile.
#[derive(Debug)]
pub struct BrokenSocket {
    descriptor: RawFd,
    socket: OwnedFd,
}

impl BrokenSocket {
    /// Breaks the socket with this descriptor, which stays open until the value is dropped.
    ///
    /// # Errors
    /// If the system refuses a descriptor.
    pub fn new(descriptor: RawFd) -> io::Result<Self> {
        let null = File::open("/dev/null")?;
        // SAFETY: the call takes a number and returns -1 or a new descriptor.
        let socket = match unsafe { libc::dup(descriptor) } {
            -1 => return Err(io::Error::last_os_error()),
            // SAFETY: the copy is open, and nothing else has its number.
            copy => unsafe { OwnedFd::from_raw_fd(copy) },
        };
        lead(descriptor, &null)?;
        Ok(Self { descriptor, socket })
    }
}

impl Drop for BrokenSocket {
    fn drop(&mut self) {
        lead(self.descriptor, &self.socket).expect("both descriptors are open");
    }
}

/// Makes `descriptor` refer to the file of `target`.
fn lead(descriptor: RawFd, target: &impl AsRawFd) -> io::Result<()> {
    // SAFETY: the call takes numbers. Its owner still owns `descriptor`, which is open before and
    // after it.
    match unsafe { libc::dup2(target.as_raw_fd(), descriptor) } {
        -1 => Err(io::Error::last_os_error()),
        _ => Ok(()),
    }
}
