//! The system calls that neither std nor socket2 offers safely: the only file of this crate with
//! `unsafe`.

use core::mem::MaybeUninit;
use core::time::Duration;
use std::ffi::CStr;
use std::io;
use std::net::SocketAddr;
use std::os::fd::{AsFd, AsRawFd, FromRawFd, OwnedFd};

use socket2::Socket;

/// The highest priority of `SCHED_FIFO`: 99 on Linux.
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

/// Puts the calling thread, and only it, under `SCHED_FIFO` at `priority`. The error is an errno
/// value.
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

/// Binds the calling thread, and only it, to one processor. The error is an errno value.
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

/// Locks every page of the process, present and future, into memory. The error is an errno value.
pub(crate) fn lock_memory() -> Result<(), i32> {
    // SAFETY: the function takes flags only. It changes which pages may be evicted, not what they
    // hold.
    match unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_FUTURE) } {
        0 => Ok(()),
        _ => Err(last_errno()),
    }
}

/// Blocks every signal on the calling thread, and only it, so that the kernel delivers those of the
/// process to other threads; all but those that report a fault of the thread itself.
pub(crate) fn block_signals() {
    // SAFETY: `sigset_t` is a C bit array, for which all zeros is a valid value. It is a set once
    // `sigfillset` has filled it below.
    let mut signals: libc::sigset_t = unsafe { core::mem::zeroed() };
    // SAFETY: `signals` is valid for reads and writes, and each signal's number is a constant of
    // the platform's, so no call can fail.
    unsafe {
        libc::sigfillset(&raw mut signals);
        for fault in FAULTS {
            libc::sigdelset(&raw mut signals, fault);
        }
    }
    // SAFETY: `signals` is initialised and only read; a null pointer asks for no previous mask.
    // The call fails only for an invalid first argument.
    unsafe { libc::pthread_sigmask(libc::SIG_BLOCK, &raw const signals, core::ptr::null_mut()) };
}

/// Signals that the kernel raises for what a thread itself does. Blocked, they would end the
/// process without the handler that prints why.
const FAULTS: [libc::c_int; 7] = [
    libc::SIGABRT,
    libc::SIGBUS,
    libc::SIGFPE,
    libc::SIGILL,
    libc::SIGSEGV,
    libc::SIGSYS,
    libc::SIGTRAP,
];

/// Sleeps for a millisecond, by `poll`.
pub(crate) fn sleep_a_millisecond() {
    // SAFETY: no descriptors are passed, so nothing is read or written through the null pointer.
    unsafe { libc::poll(core::ptr::null_mut(), 0, 1) };
}

/// Has receives from `socket` poll the network card's queue for that long, in whole microseconds,
/// before they sleep. The error is an errno value.
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

/// How long receives from `socket` poll, `[us]`. The error is an errno value.
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

/// The system's text for an errno value, as `strerror` gives it.
pub(crate) fn error_text(errno: i32) -> String {
    let mut text = [0u8; 128];
    // SAFETY: the buffer is valid for writes of the length passed with it. This is the POSIX
    // `strerror_r` (libc maps the symbol so), which writes at most that many bytes, the terminating
    // zero included.
    let failed = unsafe { libc::strerror_r(errno, text.as_mut_ptr().cast(), text.len()) };
    match CStr::from_bytes_until_nul(&text) {
        Ok(text) if failed == 0 => text.to_string_lossy().into_owned(),
        _ => format!("Unknown error {errno}"),
    }
}

/// A new eventfd with count 0, closed on exec, whose reads and writes never block.
pub(crate) fn eventfd() -> io::Result<OwnedFd> {
    // SAFETY: the function takes numbers only and returns -1 or a new descriptor.
    let fd = unsafe { libc::eventfd(0, libc::EFD_CLOEXEC | libc::EFD_NONBLOCK) };
    if fd == -1 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: `fd` is open and was returned to us alone just now, so the `OwnedFd` is its only
    // owner; `close` is the right way to give up an eventfd.
    Ok(unsafe { OwnedFd::from_raw_fd(fd) })
}

/// `recvfrom` with flags: the received length, cut to that of `buffer`, and the sender.
pub(crate) fn recv_from(
    socket: &Socket,
    buffer: &mut [u8],
    flags: i32,
) -> io::Result<(usize, Option<SocketAddr>)> {
    // SAFETY: same address, length and lifetime; `MaybeUninit<u8>` has the layout of `u8`. Writing
    // uninitialised bytes through the new type would be unsound, and socket2 promises not to
    // ("Safety" in the documentation of `Socket::recv`, to which that of `recv_from_with_flags`
    // refers).
    let buffer = unsafe { &mut *(core::ptr::from_mut(buffer) as *mut [MaybeUninit<u8>]) };
    let (length, sender) = socket.recv_from_with_flags(buffer, flags)?;
    Ok((length, sender.as_socket()))
}

fn last_errno() -> i32 {
    io::Error::last_os_error().raw_os_error().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn error_texts_are_those_of_strerror() {
        assert_eq!(error_text(libc::EPERM), "Operation not permitted");
        assert_eq!(error_text(libc::EINVAL), "Invalid argument");
        assert_eq!(error_text(99_999), "Unknown error 99999");
    }

    /// Threads that have run the handler below.
    static HANDLED: AtomicUsize = AtomicUsize::new(0);

    extern "C" fn handle(_: libc::c_int) {
        HANDLED.fetch_add(1, Ordering::Relaxed);
    }

    #[test]
    fn a_handler_of_the_process_does_not_run_on_a_thread_with_blocked_signals() {
        // SAFETY: the handler only adds to an atomic, which is async-signal-safe; nothing else in
        // this process uses the signal.
        unsafe { libc::signal(libc::SIGUSR2, handle as *const () as libc::sighandler_t) };
        let handled_on_a_thread = |blocks: bool| {
            let before = HANDLED.load(Ordering::Relaxed);
            let thread = std::thread::spawn(move || {
                if blocks {
                    block_signals();
                }
                // SAFETY: the number is a signal's. It goes to this very thread, and a handler that
                // runs has run when the call returns.
                unsafe { libc::raise(libc::SIGUSR2) };
            });
            thread.join().expect("no panic");
            HANDLED.load(Ordering::Relaxed) - before
        };
        assert_eq!(handled_on_a_thread(false), 1);
        assert_eq!(handled_on_a_thread(true), 0);
    }

    #[test]
    fn a_processor_beyond_the_set_is_refused() {
        assert_eq!(pin_to(libc::CPU_SETSIZE as usize), Err(libc::EINVAL));
        assert_eq!(pin_to(usize::MAX), Err(libc::EINVAL));
    }
}
