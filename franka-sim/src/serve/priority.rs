//! The priority of the thread that keeps the millisecond.

/// Gives the calling thread a real-time priority.
///
/// # Errors
/// What the host has against it, in practice that the user has no right to one.
#[cfg(target_os = "linux")]
pub(super) fn raise() -> std::io::Result<()> {
    let parameters = libc::sched_param {
        sched_priority: PRIORITY,
    };
    // SAFETY: 0 is the calling thread, and the pointer is to a live value, which is only read.
    let result = unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) };
    if result == 0 {
        Ok(())
    } else {
        Err(std::io::Error::last_os_error())
    }
}

/// See there: elsewhere there is no such priority to have.
#[cfg(not(target_os = "linux"))]
pub(super) fn raise() -> std::io::Result<()> {
    Err(std::io::ErrorKind::Unsupported.into())
}

/// In the middle of what there is (1 to 99): a client on the same host may be above.
#[cfg(target_os = "linux")]
const PRIORITY: i32 = 50;
