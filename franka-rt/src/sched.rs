//! Requests that the thread makes to the operating system: scheduling class, processor, locked
//! memory, blocked signals, and polling of the socket.
//!
//! [`Scheduling::enter`] makes the requests for the calling thread, and [`Scheduling::tune`] makes
//! the requests for its socket. Under [`Realtime::Enforce`] the first refusal is an error. Under
//! [`Realtime::Ignore`] the same requests are made, and [`Granted`] lists the refusals. Under
//! either, a request that no host can grant is an error.

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

/// Reaction if the operating system refuses a request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Realtime {
    /// Returns an error unless every request is granted and the kernel is a real-time kernel
    /// (`PREEMPT_RT`).
    #[default]
    Enforce,
    /// Makes the requests and accepts refusals.
    Ignore,
}

/// Requests to the operating system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scheduling {
    /// Reaction to refusals.
    pub realtime: Realtime,
    /// `SCHED_FIFO` priority, 1 to 99; the system's maximum if `None`.
    pub priority: Option<i32>,
    /// Processor to run on; any processor if `None`.
    pub cpu: Option<usize>,
    /// True to lock all present and future pages of the process into memory (`mlockall`).
    ///
    /// Off by default: with a low `RLIMIT_MEMLOCK`, later allocations anywhere in the process would
    /// fail.
    pub lock_memory: bool,
    /// Number of bytes of stack to touch before the loop starts, so that no cycle causes a page
    /// fault on the stack. At most 64 MiB (`PREFAULT_MAX`); 512 KiB by default
    /// (`PREFAULT_DEFAULT`). The whole stack of the thread is larger by a reserve. The user's
    /// control functions run on this stack.
    pub prefault_stack: usize,
    /// Time for which a receive polls the network card's queue before it sleeps (`SO_BUSY_POLL`),
    /// in whole microseconds, at most 900 (`BUSY_POLL_MAX`). If `None`, receives do not poll.
    ///
    /// Polling avoids the latency of interrupt and wake-up, but occupies the processor. It only
    /// works for network cards whose driver supports it, not for the loopback device. Raising the
    /// time above the system's default (`net.core.busy_read`, 0) requires `CAP_NET_ADMIN`.
    pub busy_poll: Option<Duration>,
}

/// Longest time for which a receive may poll in each millisecond between two states. Polling counts
/// as running time. If a `SCHED_FIFO` thread runs for more than 950 ms of a second, the kernel
/// suspends it for the rest of that second (`sched_rt_runtime_us`).
pub const BUSY_POLL_MAX: Duration = Duration::from_micros(900);

impl Default for Scheduling {
    /// Returns [`Realtime::Enforce`] at the highest priority, on any processor. Memory is not
    /// locked, and receives do not poll.
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

/// Results of the requests to the operating system.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Granted {
    /// `SCHED_FIFO` priority of the thread; `None` if it runs under the normal scheduler.
    pub priority: Option<i32>,
    /// Time for which each receive polls; `None` if receives do not poll.
    pub busy_poll: Option<Duration>,
    /// Refusals that [`Realtime::Ignore`] accepted.
    pub refusals: Vec<SchedError>,
}
