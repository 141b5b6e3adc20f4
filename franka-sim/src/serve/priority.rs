//! The priority of the thread that keeps the millisecond.

/// Raises the calling thread to a real-time priority.
///
/// # Errors
/// Returns the host's error, usually because the user lacks the right to this priority.
#[cfg(target_os = "linux")]
pub(super) fn raise() -> std::io::Result<()> {
    // SAFETY: `sched_param` is a C struct of integers, for which all zeros is a valid value. musl
    // has further fields than the priority, so a literal would not build everywhere.
    let mut parameters: libc::sched_param = unsafe { std::mem::zeroed() };
    parameters.sched_priority = PRIORITY;
    // musl always refuses `sched_setscheduler`. SAFETY: `pthread_self` is the valid id of the
    // calling thread, and the pointer is to a live value, which is only read.
    match unsafe {
        libc::pthread_setschedparam(
            libc::pthread_self(),
            libc::SCHED_FIFO,
            &raw const parameters,
        )
    } {
        0 => Ok(()),
        errno => Err(std::io::Error::from_raw_os_error(errno)),
    }
}

/// Always fails, because only Linux is supported.
#[cfg(not(target_os = "linux"))]
pub(super) fn raise() -> std::io::Result<()> {
    Err(std::io::ErrorKind::Unsupported.into())
}

/// Priority in the middle of the range (1 to 99). A client on the same host can therefore have a
/// higher priority.
#[cfg(target_os = "linux")]
const PRIORITY: i32 = 50;
