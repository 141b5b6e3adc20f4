//! System calls that neither std nor socket2 provides safely. No other module of this crate uses
//! `unsafe`.
//!
//! | module | content |
//! |---|---|
//! | this | common to all Unix systems |
//! | `linux` | available on Linux only: scheduling, locked memory, polling, the eventfd |
//! | `portable` | the same requests on other systems: refused, and a pair of sockets for the eventfd |
//!
//! The other systems serve development with simulated robots. With `--cfg franka_portable`, Linux
//! builds and tests their code.

#[cfg(all(target_os = "linux", not(franka_portable)))]
mod linux;
// Its tests also run on Linux.
#[cfg(any(test, not(target_os = "linux"), franka_portable))]
#[cfg_attr(all(target_os = "linux", not(franka_portable)), allow(dead_code))]
mod portable;

use core::mem::MaybeUninit;
use std::ffi::CStr;
use std::io;
use std::net::SocketAddr;

use socket2::Socket;

#[cfg(all(target_os = "linux", not(franka_portable)))]
pub(crate) use linux::*;
#[cfg(any(not(target_os = "linux"), franka_portable))]
pub(crate) use portable::*;

/// Blocks signals on the calling thread only, so that the kernel delivers the process's signals to
/// other threads. Signals that report a fault of the thread itself stay unblocked.
pub(crate) fn block_signals() {
    // SAFETY: `sigset_t` is a C bit array, for which all zeros is a valid value. It is a set once
    // `sigfillset` has filled it below.
    let mut signals: libc::sigset_t = unsafe { core::mem::zeroed() };
    // SAFETY: `signals` is valid for reads and writes, and each signal's number is a constant of
    // the platform, so no call can fail.
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

/// Signals that the kernel raises for a fault of a thread itself. If they were blocked, a fault
/// would end the process without the handler that prints the cause.
const FAULTS: [libc::c_int; 7] = [
    libc::SIGABRT,
    libc::SIGBUS,
    libc::SIGFPE,
    libc::SIGILL,
    libc::SIGSEGV,
    libc::SIGSYS,
    libc::SIGTRAP,
];

/// Sleeps for a millisecond, with `poll`.
pub(crate) fn sleep_a_millisecond() {
    // SAFETY: no descriptors are passed, so nothing is read or written through the null pointer.
    unsafe { libc::poll(core::ptr::null_mut(), 0, 1) };
}

/// Returns the system's text for an errno value, from `strerror`.
pub(crate) fn error_text(errno: i32) -> String {
    let mut text = [0u8; 128];
    // SAFETY: the buffer is valid for writes of the length passed with it. This is the POSIX
    // `strerror_r`, to which libc maps the symbol. It writes at most that many bytes, including the
    // terminating zero.
    let failed = unsafe { libc::strerror_r(errno, text.as_mut_ptr().cast(), text.len()) };
    match CStr::from_bytes_until_nul(&text) {
        Ok(text) if failed == 0 => text.to_string_lossy().into_owned(),
        _ => format!("Unknown error {errno}"),
    }
}

/// Calls `recvfrom` with flags. Returns the received length, which is at most the length of
/// `buffer`, and the sender.
pub(crate) fn recv_from(
    socket: &Socket,
    buffer: &mut [u8],
    flags: i32,
) -> io::Result<(usize, Option<SocketAddr>)> {
    // SAFETY: same address, length and lifetime; `MaybeUninit<u8>` has the layout of `u8`. Writing
    // uninitialised bytes through the new type would be unsound, and socket2 promises not to
    // ("Safety" in the documentation of `Socket::recv`, to which `recv_from_with_flags` refers).
    let buffer = unsafe { &mut *(core::ptr::from_mut(buffer) as *mut [MaybeUninit<u8>]) };
    let (length, sender) = socket.recv_from_with_flags(buffer, flags)?;
    Ok((length, sender.as_socket()))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn error_texts_are_those_of_strerror() {
        assert_eq!(error_text(libc::EPERM), "Operation not permitted");
        assert_eq!(error_text(libc::EINVAL), "Invalid argument");
        assert_eq!(error_text(99_999), "Unknown error 99999");
    }

    /// Number of times that the handler below has run.
    static HANDLED: AtomicUsize = AtomicUsize::new(0);

    extern "C" fn handle(_: libc::c_int) {
        HANDLED.fetch_add(1, Ordering::Relaxed);
    }

    #[test]
    fn signal_handler_skips_threads_with_blocked_signals() {
        // SAFETY: the handler only adds to an atomic, which is async-signal-safe; nothing else in
        // this process uses the signal.
        unsafe { libc::signal(libc::SIGUSR2, handle as *const () as libc::sighandler_t) };
        let handled_on_a_thread = |blocks: bool| {
            let before = HANDLED.load(Ordering::Relaxed);
            let thread = std::thread::spawn(move || {
                if blocks {
                    block_signals();
                }
                // SAFETY: the number is a valid signal. It is sent to this thread, and a handler
                // that runs has run when the call returns.
                unsafe { libc::raise(libc::SIGUSR2) };
            });
            thread.join().expect("no panic");
            HANDLED.load(Ordering::Relaxed) - before
        };
        assert_eq!(handled_on_a_thread(false), 1);
        assert_eq!(handled_on_a_thread(true), 0);
    }
}
