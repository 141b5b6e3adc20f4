//! Errors for requests that the operating system refuses.

use core::time::Duration;

use super::{BUSY_POLL_MAX, Kernel, PREFAULT_MAX};
#[cfg(unix)]
use crate::sys::error_text;

/// Reason why the thread cannot run with the requested options. The numbers are errno values. The
/// texts of the first three variants are libfranka's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SchedError {
    /// The system does not report a maximum `SCHED_FIFO` priority.
    #[error("libfranka: unable to get maximum possible thread priority: {}", error_text(*.0))]
    MaximumPriority(i32),
    /// The process may not use `SCHED_FIFO` at this priority, usually because its `RLIMIT_RTPRIO`
    /// is too low.
    #[error("libfranka: unable to set realtime scheduling: {}", error_text(*.0))]
    SetScheduling(i32),
    /// There is no evidence that the kernel is a real-time kernel. Only
    /// [`Realtime::Enforce`](super::Realtime::Enforce) causes this error. The text is libfranka's,
    /// followed by the evidence.
    #[error("libfranka: Running kernel does not have realtime capabilities. ({0})")]
    KernelNotRealtime(Box<Kernel>),
    /// The requested processor does not exist or is not available to this process.
    #[error("unable to run on processor {cpu}: {}", error_text(*.errno))]
    Pin {
        /// The requested processor.
        cpu: usize,
        /// errno value with the reason.
        errno: i32,
    },
    /// Memory cannot be locked, usually because `RLIMIT_MEMLOCK` is too low.
    #[error("unable to lock memory: {}", error_text(*.0))]
    LockMemory(i32),
    /// The system refuses to poll the socket, because the process lacks `CAP_NET_ADMIN` or the
    /// kernel does not support polling (`ENOPROTOOPT`).
    #[error("unable to busy-poll the socket for {} us: {}", .duration.as_micros(), error_text(*.errno))]
    BusyPoll {
        /// The requested duration.
        duration: Duration,
        /// errno value with the reason.
        errno: i32,
    },
    /// Caller: the duration is out of range; a longer one leaves the thread no time. Refused under
    /// either [`Realtime`](super::Realtime).
    #[error("the busy poll is {} us, expected 1 to {} us", .got.as_micros(), BUSY_POLL_MAX.as_micros())]
    BusyPollRange {
        /// The requested duration.
        got: Duration,
    },
    /// Caller: the stack to touch is larger than allowed. Refused under either
    /// [`Realtime`](super::Realtime).
    #[error("the stack to prefault has {got} bytes, expected at most {PREFAULT_MAX} bytes")]
    PrefaultRange {
        /// The requested size, in bytes.
        got: usize,
    },
}

impl SchedError {
    /// Returns the name of this error's row in the error chapter of the book, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::MaximumPriority(_) => "sched-maximum-priority",
            Self::SetScheduling(_) => "sched-set-scheduling",
            Self::KernelNotRealtime(_) => "sched-kernel-not-realtime",
            Self::Pin { .. } => "sched-pin",
            Self::LockMemory(_) => "sched-lock-memory",
            Self::BusyPoll { .. } => "sched-busy-poll",
            Self::BusyPollRange { .. } => "sched-busy-poll-range",
            Self::PrefaultRange { .. } => "sched-prefault-range",
        }
    }

    /// True if the caller requested an option that is out of range. No host grants such a request.
    pub fn is_misuse(&self) -> bool {
        matches!(
            self,
            Self::BusyPollRange { .. } | Self::PrefaultRange { .. }
        )
    }
}

/// Replaces the system's error text on other systems.
#[cfg(not(unix))]
fn error_text(errno: i32) -> String {
    format!("Unknown error {errno}")
}
