//! Requests of the thread to the operating system: scheduling class, processor, memory, blocked
//! signals, polling of a socket.
//!
//! [`Scheduling::enter`] makes the requests for the calling thread, [`Scheduling::tune`] the
//! requests for its socket. Under [`Realtime::Enforce`] the first refusal is an error. Under
//! [`Realtime::Ignore`] the same requests are made and the refusals are listed in [`Granted`]. A
//! request that no host can grant is an error under both.

#[cfg(unix)]
mod enter;
mod error;
mod kernel;
#[cfg_attr(not(unix), allow(dead_code))]
mod stack;

use core::time::Duration;

pub use error::SchedError;
pub use kernel::{Kernel, kernel_is_realtime};
pub use stack::{DEFAULT as PREFAULT_DEFAULT, MAX as PREFAULT_MAX};

/// Handling of refusals of the operating system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Realtime {
    /// Every request must be granted, and the kernel must be a real-time one (`PREEMPT_RT`).
    #[default]
    Enforce,
    /// The requests are made, and refusals are accepted.
    Ignore,
}

/// Requests to the operating system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scheduling {
    /// Handling of refusals.
    pub realtime: Realtime,
    /// `SCHED_FIFO` priority, 1 to 99; the system's maximum if `None`.
    pub priority: Option<i32>,
    /// The processor to run on; any processor if `None`.
    pub cpu: Option<usize>,
    /// True to lock the pages of the whole process into memory (`mlockall`, present and future
    /// pages).
    ///
    /// Off by default: under a small `RLIMIT_MEMLOCK` later allocations anywhere in the process
    /// would fail.
    pub lock_memory: bool,
    /// Stack to touch before the loop starts, in bytes, so that no cycle has a page fault there: at
    /// most 64 MiB (`PREFAULT_MAX`), 512 KiB by default (`PREFAULT_DEFAULT`). The thread's whole
    /// stack is larger by a reserve. Control functions of the user run on this stack.
    pub prefault_stack: usize,
    /// Time for which a receive polls the network card's queue before it sleeps (`SO_BUSY_POLL`),
    /// in whole microseconds and at most 900 (`BUSY_POLL_MAX`); not at all if `None`.
    ///
    /// Polling saves the latency of interrupt and wake-up, and occupies the processor. Only cards
    /// whose driver supports it are polled: the loopback device is not. Raising the time above the
    /// system's default (`net.core.busy_read`, 0) requires `CAP_NET_ADMIN`.
    pub busy_poll: Option<Duration>,
}

/// The longest busy poll, in each millisecond between two states. Polling counts as running time.
/// The kernel suspends a `SCHED_FIFO` thread that runs for more than 950 ms of a second, for the
/// rest of that second (`sched_rt_runtime_us`).
pub const BUSY_POLL_MAX: Duration = Duration::from_micros(900);

impl Default for Scheduling {
    /// Returns [`Realtime::Enforce`] at the highest priority, on any processor, without locked
    /// memory and without polling.
    fn default() -> Self {
        Self {
            realtime: Realtime::Enforce,
            priority: None,
            cpu: None,
            lock_memory: false,
            prefault_stack: PREFAULT_DEFAULT,
            busy_poll: None,
        }
    }
}

/// Result of the requests to the operating system.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Granted {
    /// `SCHED_FIFO` priority of the thread; `None` if it runs under the normal scheduler.
    pub priority: Option<i32>,
    /// Time for which receives poll; `None` if they do not poll.
    pub busy_poll: Option<Duration>,
    /// Refusals that were accepted, under [`Realtime::Ignore`].
    pub refusals: Vec<SchedError>,
}
