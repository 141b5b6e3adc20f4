//! What the operating system grants the thread: scheduling class, processor, memory, freedom from
//! signal handlers, a socket that is polled.
//!
//! [`Scheduling::enter`] asks for what concerns the calling thread, [`Scheduling::tune`] for what
//! concerns its socket. Under [`Realtime::Enforce`] the first refusal is an error; under
//! [`Realtime::Ignore`] the same requests are made and the refusals are listed in [`Granted`]. What
//! no host can grant is an error under both.

mod kernel;
mod stack;

use core::time::Duration;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::fd::AsFd;

use crate::sys;

pub use kernel::{Kernel, kernel_is_realtime};
pub use stack::{DEFAULT as PREFAULT_DEFAULT, MAX as PREFAULT_MAX};

/// Whether a refusal of the operating system is an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Realtime {
    /// Every request must be granted, and the kernel must be a real-time one (`PREEMPT_RT`).
    #[default]
    Enforce,
    /// The requests are made, and refusals accepted.
    Ignore,
}

/// What to ask the operating system for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scheduling {
    /// Whether refusals are errors.
    pub realtime: Realtime,
    /// `SCHED_FIFO` priority, 1 to 99; the system's maximum if `None`, as libfranka 0.21 takes it.
    pub priority: Option<i32>,
    /// The processor to run on; any if `None`.
    pub cpu: Option<usize>,
    /// Lock the pages of the whole process into memory (`mlockall`, present and future ones).
    ///
    /// Off by default: under a small `RLIMIT_MEMLOCK` later allocations anywhere in the process
    /// would fail.
    pub lock_memory: bool,
    /// Stack to touch before the loop starts, in bytes, so that no cycle has a page fault there: at
    /// most [`PREFAULT_MAX`], [`PREFAULT_DEFAULT`] by default. The thread gets a larger one by a
    /// reserve. Control functions of the user's run on this stack.
    pub prefault_stack: usize,
    /// How long a receive polls the network card's queue before it sleeps (`SO_BUSY_POLL`), in
    /// whole microseconds and at most [`BUSY_POLL_MAX`]; not at all if `None`.
    ///
    /// Saves the latency of interrupt and wake-up, and occupies the processor while it polls. Only
    /// cards whose driver takes part are polled: the loopback device is not. Raising it above the
    /// system's default (`net.core.busy_read`, 0) takes `CAP_NET_ADMIN`.
    pub busy_poll: Option<Duration>,
}

/// The longest busy poll, in each millisecond between two states. Polling counts as running time,
/// and a `SCHED_FIFO` thread that runs for more than 950 ms of a second is held up for the rest of
/// it (`sched_rt_runtime_us`).
pub const BUSY_POLL_MAX: Duration = Duration::from_micros(900);

impl Default for Scheduling {
    /// [`Realtime::Enforce`] at the highest priority, on any processor, without locked memory and
    /// without polling.
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

/// What the operating system granted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Granted {
    /// `SCHED_FIFO` priority of the thread; `None` if it runs under the normal scheduler.
    pub priority: Option<i32>,
    /// How long receives poll; `None` if they do not.
    pub busy_poll: Option<Duration>,
    /// What was refused and accepted, under [`Realtime::Ignore`].
    pub refusals: Vec<SchedError>,
}

/// Why the thread cannot run as asked. The numbers are errno values; the texts of the first three
/// are libfranka's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SchedError {
    /// The system does not name a highest `SCHED_FIFO` priority.
    #[error("libfranka: unable to get maximum possible thread priority: {}", sys::error_text(*.0))]
    MaximumPriority(i32),
    /// The process may not use `SCHED_FIFO` at this priority; usually its `RLIMIT_RTPRIO` is too
    /// low.
    #[error("libfranka: unable to set realtime scheduling: {}", sys::error_text(*.0))]
    SetScheduling(i32),
    /// Nothing shows that the kernel is a real-time one. Under [`Realtime::Enforce`] only.
    /// libfranka's text, and then what was read.
    #[error("libfranka: Running kernel does not have realtime capabilities. ({0})")]
    KernelNotRealtime(Box<Kernel>),
    /// The processor asked for does not exist or is not open to this process.
    #[error("unable to run on processor {cpu}: {}", sys::error_text(*.errno))]
    Pin {
        /// The processor asked for.
        cpu: usize,
        /// Why not.
        errno: i32,
    },
    /// Memory cannot be locked; usually `RLIMIT_MEMLOCK` is too low.
    #[error("unable to lock memory: {}", sys::error_text(*.0))]
    LockMemory(i32),
    /// The socket is not polled; without `CAP_NET_ADMIN`, or with a kernel that cannot
    /// (`ENOPROTOOPT`).
    #[error("unable to poll the socket for {} us: {}", .duration.as_micros(), sys::error_text(*.errno))]
    BusyPoll {
        /// What was asked for.
        duration: Duration,
        /// Why not.
        errno: i32,
    },
    /// Caller: a busy poll this long leaves the thread no time. Under either [`Realtime`].
    #[error("a busy poll of {} us is out of range: expected 1 to {} us", .got.as_micros(), BUSY_POLL_MAX.as_micros())]
    BusyPollRange {
        /// What was asked for.
        got: Duration,
    },
    /// Caller: the stack to touch is larger than allowed. Under either [`Realtime`].
    #[error("a stack of {got} bytes is out of range: expected at most {PREFAULT_MAX} bytes")]
    PrefaultRange {
        /// What was asked for, in bytes.
        got: usize,
    },
}

impl SchedError {
    /// Returns the name of its row in the book's chapter of errors, `errors.md`.
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

    /// Whether the caller asked for an option that is out of range, which no host grants.
    pub fn is_misuse(&self) -> bool {
        matches!(
            self,
            Self::BusyPollRange { .. } | Self::PrefaultRange { .. }
        )
    }
}

impl Scheduling {
    /// Applies the options to the calling thread, touches its stack and blocks signals, so that no
    /// handler of the process runs on it. The order is that of libfranka 0.21: scheduling first,
    /// then the question after the kernel.
    ///
    /// Signals that report a fault of the thread itself (such as `SIGSEGV`) are not blocked.
    /// Threads and processes that the thread starts later inherit the rest.
    ///
    /// # Errors
    /// Under [`Realtime::Enforce`], the first request that was refused. Requests granted before it
    /// stay granted. Under either, an option that is out of range: nothing is asked for then.
    pub fn enter(&self) -> Result<Granted, SchedError> {
        self.enter_on(Kernel::read)
    }

    /// [`Self::enter`] on a host with this kernel.
    fn enter_on(&self, kernel: impl FnOnce() -> Kernel) -> Result<Granted, SchedError> {
        self.check()?;
        sys::block_signals();
        let mut granted = Granted::default();
        match self.set_fifo() {
            Ok(priority) => granted.priority = Some(priority),
            Err(error) => self.refused(error, &mut granted)?,
        }
        if self.realtime == Realtime::Enforce {
            let kernel = kernel();
            if !kernel.is_realtime() {
                return Err(SchedError::KernelNotRealtime(kernel.into()));
            }
        }
        if let Some(cpu) = self.cpu
            && let Err(errno) = sys::pin_to(cpu)
        {
            self.refused(SchedError::Pin { cpu, errno }, &mut granted)?;
        }
        if self.lock_memory
            && let Err(errno) = sys::lock_memory()
        {
            self.refused(SchedError::LockMemory(errno), &mut granted)?;
        }
        stack::touch(self.prefault_stack);
        Ok(granted)
    }

    /// Applies the options to the socket that the thread receives from, and notes in `granted` what
    /// came of it.
    ///
    /// # Errors
    /// Under [`Realtime::Enforce`], [`SchedError::BusyPoll`] if that is refused.
    pub fn tune(&self, socket: &impl AsFd, granted: &mut Granted) -> Result<(), SchedError> {
        self.check()?;
        let Some(duration) = self.busy_poll else {
            return Ok(());
        };
        match sys::busy_poll(socket, duration) {
            Ok(()) => granted.busy_poll = Some(duration),
            Err(errno) => self.refused(SchedError::BusyPoll { duration, errno }, granted)?,
        }
        Ok(())
    }

    /// Size of the stack that the thread needs, in bytes.
    pub(crate) fn stack_size(&self) -> usize {
        stack::size(self.prefault_stack.min(PREFAULT_MAX))
    }

    /// Whether every option is in its range.
    fn check(&self) -> Result<(), SchedError> {
        let polled = Duration::from_micros(1)..=BUSY_POLL_MAX;
        match self.busy_poll {
            Some(got) if !polled.contains(&got) => Err(SchedError::BusyPollRange { got }),
            _ if self.prefault_stack > PREFAULT_MAX => Err(SchedError::PrefaultRange {
                got: self.prefault_stack,
            }),
            _ => Ok(()),
        }
    }

    /// Whether a thread of this process would be granted what is asked for, memory aside. Starts a
    /// short-lived thread, so that the caller keeps its own scheduling; for asking before a robot
    /// is contacted.
    ///
    /// # Errors
    /// As [`Self::enter`] and [`Self::tune`]. A thread that cannot be started at all counts as
    /// refused scheduling.
    pub fn probe(&self) -> Result<Granted, SchedError> {
        self.check()?;
        let asked = Self {
            lock_memory: false,
            ..self.clone()
        };
        let probe = std::thread::Builder::new()
            .name("franka-probe".into())
            .stack_size(self.stack_size())
            .spawn(move || {
                let mut granted = asked.enter()?;
                if let Ok(socket) = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)) {
                    asked.tune(&socket, &mut granted)?;
                }
                Ok(granted)
            })
            .map_err(|error| {
                SchedError::SetScheduling(error.raw_os_error().unwrap_or(libc::EAGAIN))
            })?;
        probe
            .join()
            .expect("asking the operating system does not panic")
    }

    fn set_fifo(&self) -> Result<i32, SchedError> {
        let priority = match self.priority {
            Some(priority) => priority,
            None => sys::max_fifo_priority().map_err(SchedError::MaximumPriority)?,
        };
        sys::set_fifo(priority).map_err(SchedError::SetScheduling)?;
        Ok(priority)
    }

    fn refused(&self, error: SchedError, granted: &mut Granted) -> Result<(), SchedError> {
        match self.realtime {
            Realtime::Enforce => Err(error),
            Realtime::Ignore => {
                granted.refusals.push(error);
                Ok(())
            }
        }
    }
}

#[cfg(all(test, target_os = "linux", not(franka_portable)))]
mod tests;

#[cfg(all(test, any(not(target_os = "linux"), franka_portable)))]
mod portable_tests {
    use super::*;

    #[test]
    fn elsewhere_than_on_linux_nothing_is_granted() {
        let asked = Scheduling {
            cpu: Some(0),
            lock_memory: true,
            busy_poll: Some(Duration::from_micros(50)),
            ..Scheduling::default()
        };
        let refusal = asked.probe().expect_err("a robot takes a real-time thread");
        let text = "libfranka: unable to get maximum possible thread priority: ";
        assert!(refusal.to_string().starts_with(text), "{refusal}");
        let ignored = Scheduling {
            realtime: Realtime::Ignore,
            ..asked
        };
        let granted = ignored.probe().expect("a simulated robot takes none");
        assert_eq!((granted.priority, granted.busy_poll), (None, None));
        let [
            SchedError::MaximumPriority(_),
            SchedError::Pin { cpu: 0, .. },
            SchedError::BusyPoll { .. },
        ] = &granted.refusals[..]
        else {
            panic!("{granted:?}")
        };
    }
}
