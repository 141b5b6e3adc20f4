//! Requests of a thread and its socket to Linux, and the eventfd.

use core::time::Duration;
use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, FromRawFd, OwnedFd};

/// Returns the highest priority of `SCHED_FIFO`: 99 on Linux.
pub(crate) fn max_fifo_priority() -> Result<i32, i32> {
    // SAFETY: the function takes a number, touches no memory of ours, and reports an unknown policy
    // as -1.
    let priority = unsafe { libc::sched_get_priority_max(libc::SCHED_FIFO) };
    if priority == -1 {
        Err(last_errno())
    } else {
        Ok(priority)
    }
}

/// Puts only the calling thread under `SCHED_FIFO` at `priority`. The error is an errno value.
pub(crate) fn set_fifo(priority: i32) -> Result<(), i32> {
    // SAFETY: `sched_param` is a C struct of integers, for which all zeros is a valid value (musl
    // has further fields than the priority, so a literal would not build everywhere).
    let mut parameters: libc::sched_param = unsafe { core::mem::zeroed() };
    parameters.sched_priority = priority;
    // SAFETY: `pthread_self` is always the valid id of the calling thread, which lives during the
    // call; `parameters` is initialised, and only read before the call returns.
    match unsafe {
        libc::pthread_setschedparam(
            libc::pthread_self(),
            libc::SCHED_FIFO,
            &raw const parameters,
        )
    } {
        0 => Ok(()),
        errno => Err(errno), // reported by return value, not in `errno`
    }
}

/// Binds only the calling thread to one processor. The error is an errno value.
pub(crate) fn pin_to(cpu: usize) -> Result<(), i32> {
    if cpu >= libc::CPU_SETSIZE as usize {
        return Err(libc::EINVAL);
    }
    // SAFETY: `cpu_set_t` is a C bit array, for which all zeros is the valid empty set.
    let mut set: libc::cpu_set_t = unsafe { core::mem::zeroed() };
    // SAFETY: `cpu` is below `CPU_SETSIZE`, the number of bits in `set`, so the bit lies inside it.
    unsafe { libc::CPU_SET(cpu, &mut set) };
    // SAFETY: thread 0 is the caller; `set` is initialised and valid for reads of the size passed
    // with it.
    match unsafe { libc::sched_setaffinity(0, size_of::<libc::cpu_set_t>(), &raw const set) } {
        0 => Ok(()),
        _ => Err(last_errno()),
    }
}

/// Locks all present and future pages of the process into memory. The error is an errno value.
pub(crate) fn lock_memory() -> Result<(), i32> {
    // SAFETY: the function takes flags only. It changes which pages may be evicted, not their
    // content.
    match unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_FUTURE) } {
        0 => Ok(()),
        _ => Err(last_errno()),
    }
}

/// Makes receives from `socket` poll the network card's queue for this duration, in whole
/// microseconds, before they sleep. The error is an errno value.
pub(crate) fn busy_poll(socket: &impl AsFd, duration: Duration) -> Result<(), i32> {
    let Ok(us) = libc::c_int::try_from(duration.as_micros()) else {
        return Err(libc::EINVAL);
    };
    // SAFETY: the descriptor is borrowed from its owner, hence open during the call; `us` is
    // initialised and valid for reads of the size passed with it, and only read.
    let set = unsafe {
        libc::setsockopt(
            socket.as_fd().as_raw_fd(),
            libc::SOL_SOCKET,
            libc::SO_BUSY_POLL,
            (&raw const us).cast(),
            size_of::<libc::c_int>() as libc::socklen_t,
        )
    };
    match set {
        0 => Ok(()),
        _ => Err(last_errno()),
    }
}

/// Returns the time for which receives from `socket` poll, `[us]`. The error is an errno value.
#[cfg(test)]
pub(crate) fn busy_poll_of(socket: &impl AsFd) -> Result<libc::c_int, i32> {
    let mut us: libc::c_int = 0;
    let mut length = size_of::<libc::c_int>() as libc::socklen_t;
    // SAFETY: the descriptor is borrowed from its owner, hence open during the call; `us` is valid
    // for writes of `length` bytes, and `length` for reads and writes.
    let got = unsafe {
        libc::getsockopt(
            socket.as_fd().as_raw_fd(),
            libc::SOL_SOCKET,
            libc::SO_BUSY_POLL,
            (&raw mut us).cast(),
            &raw mut length,
        )
    };
    match got {
        0 => Ok(us),
        _ => Err(last_errno()),
    }
}

/// An eventfd whose count starts at 0.
#[derive(Debug)]
pub(crate) struct Wake(File);

impl Wake {
    pub(crate) fn new() -> io::Result<Self> {
        Ok(Self(eventfd()?.into()))
    }

    /// Adds 1 to the count, which makes the descriptor readable. Never blocks. At the largest count
    /// the kernel refuses the write, but the descriptor is already readable.
    pub(crate) fn notify(&self) {
        let _ = (&self.0).write(&1u64.to_ne_bytes());
    }

    /// Returns the count, and sets it to 0. Never blocks.
    pub(crate) fn drain(&self) -> u64 {
        let mut count = [0; 8];
        match (&self.0).read(&mut count) {
            Ok(8) => u64::from_ne_bytes(count),
            // A read returns eight bytes or, if the count is 0, the error `WouldBlock`.
            _ => 0,
        }
    }

    pub(crate) fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }
}

/// Returns a new eventfd with count 0, closed on exec, whose reads and writes never block.
fn eventfd() -> io::Result<OwnedFd> {
    // SAFETY: the function takes numbers only and returns -1 or a new descriptor.
    let fd = unsafe { libc::eventfd(0, libc::EFD_CLOEXEC | libc::EFD_NONBLOCK) };
    if fd == -1 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: `fd` is open and was returned to us alone just now, so the `OwnedFd` is its only
    // owner; `close` is the right way to give up an eventfd.
    Ok(unsafe { OwnedFd::from_raw_fd(fd) })
}

fn last_errno() -> i32 {
    io::Error::last_os_error().raw_os_error().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_processor_beyond_the_set_is_refused() {
        assert_eq!(pin_to(libc::CPU_SETSIZE as usize), Err(libc::EINVAL));
        assert_eq!(pin_to(usize::MAX), Err(libc::EINVAL));
    }

    #[test]
    fn a_saturated_count_neither_blocks_nor_stays_unreadable() {
        let wake = Wake::new().expect("a descriptor is free");
        (&wake.0)
            .write_all(&(u64::MAX - 1).to_ne_bytes())
            .expect("the largest count is accepted");
        wake.notify();
        assert_eq!(wake.drain(), u64::MAX - 1);
    }
}
