//! What the operating system grants the thread: scheduling class, processor, memory.
//!
//! [`Scheduling::enter`] asks for all of it, for the calling thread. Under [`Realtime::Enforce`] the first refusal is an
//! error; under [`Realtime::Ignore`] the same requests are made and the refusals are listed in [`Granted`].

use core::hint::black_box;

use crate::sys;

/// Whether the thread may run without what it asked the operating system for.
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
    /// Off by default: under a small `RLIMIT_MEMLOCK` later allocations anywhere in the process would fail.
    pub lock_memory: bool,
}

impl Default for Scheduling {
    /// [`Realtime::Enforce`] at the highest priority, on any processor, without locked memory.
    fn default() -> Self {
        Self {
            realtime: Realtime::Enforce,
            priority: None,
            cpu: None,
            lock_memory: false,
        }
    }
}

/// What the operating system granted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Granted {
    /// `SCHED_FIFO` priority of the thread; `None` if it runs under the normal scheduler.
    pub priority: Option<i32>,
    /// What was refused and accepted, under [`Realtime::Ignore`].
    pub refusals: Vec<SchedError>,
}

/// Why the thread cannot run as asked. The numbers are errno values; the texts of the first three are libfranka's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SchedError {
    /// The system does not name a highest `SCHED_FIFO` priority.
    #[error("libfranka: unable to get maximum possible thread priority: {}", sys::error_text(*.0))]
    MaximumPriority(i32),
    /// The process may not use `SCHED_FIFO` at this priority; usually its `RLIMIT_RTPRIO` is too low.
    #[error("libfranka: unable to set realtime scheduling: {}", sys::error_text(*.0))]
    SetScheduling(i32),
    /// `/sys/kernel/realtime` is absent or does not hold 1. Under [`Realtime::Enforce`] only.
    #[error("libfranka: Running kernel does not have realtime capabilities.")]
    KernelNotRealtime,
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
}

impl Scheduling {
    /// Applies the options to the calling thread and touches its stack. The order is that of libfranka 0.21:
    /// scheduling first, then the question after the kernel.
    ///
    /// # Errors
    /// Under [`Realtime::Enforce`], the first request that was refused. Requests granted before it stay granted.
    pub fn enter(&self) -> Result<Granted, SchedError> {
        let mut granted = Granted::default();
        match self.set_fifo() {
            Ok(priority) => granted.priority = Some(priority),
            Err(error) => self.refused(error, &mut granted)?,
        }
        if self.realtime == Realtime::Enforce && !kernel_is_realtime() {
            return Err(SchedError::KernelNotRealtime);
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
        touch_stack();
        Ok(granted)
    }

    /// Whether a thread of this process would be granted what is asked for, memory aside. Starts a short-lived thread,
    /// so that the caller keeps its own scheduling; for asking before a robot is contacted.
    ///
    /// # Errors
    /// As [`Self::enter`]. A thread that cannot be started at all counts as refused scheduling.
    pub fn probe(&self) -> Result<Granted, SchedError> {
        let asked = Self {
            lock_memory: false,
            ..self.clone()
        };
        let probe = std::thread::Builder::new()
            .name("franka-probe".into())
            .stack_size(STACK)
            .spawn(move || asked.enter())
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

/// Whether the running kernel says that it is a real-time one: `/sys/kernel/realtime` holds 1.
pub fn kernel_is_realtime() -> bool {
    std::fs::read_to_string("/sys/kernel/realtime").is_ok_and(|flag| flag.trim() == "1")
}

/// Stack of the thread: four times what is touched, for frames that only unoptimised builds need.
pub(crate) const STACK: usize = 4 * TOUCHED;

/// Stack touched before the loop starts, so that no cycle meets a page for the first time. A cycle uses some tens of
/// kilobytes.
const TOUCHED: usize = 512 * 1024;

#[inline(never)]
fn touch_stack() {
    let mut stack = [0u8; TOUCHED];
    black_box(&mut stack);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs `asked.enter()` in a thread of its own and returns what it got and what `/proc` says of that thread.
    fn entered(asked: Scheduling) -> (Result<Granted, SchedError>, String, String) {
        std::thread::spawn(move || {
            let granted = asked.enter();
            let read = |file| std::fs::read_to_string(file).expect("Linux has /proc");
            (
                granted,
                read("/proc/thread-self/stat"),
                read("/proc/thread-self/status"),
            )
        })
        .join()
        .expect("entering does not panic")
    }

    /// Real-time priority and policy: fields 40 and 41 of proc_pid_stat(5), counted after the parenthesised name.
    fn priority_and_policy(stat: &str) -> (i32, i32) {
        let fields: Vec<&str> = stat[stat.rfind(')').expect("a name") + 1..]
            .split_whitespace()
            .collect();
        (
            fields[40 - 3].parse().expect("a number"),
            fields[41 - 3].parse().expect("a number"),
        )
    }

    #[test]
    fn ignore_accepts_refusals_and_reports_what_the_kernel_did() {
        let asked = Scheduling {
            realtime: Realtime::Ignore,
            priority: Some(7),
            ..Scheduling::default()
        };
        let (granted, stat, _) = entered(asked);
        let granted = granted.expect("nothing is enforced");
        match granted.priority {
            Some(priority) => {
                assert_eq!(
                    (priority, 1),
                    priority_and_policy(&stat),
                    "policy 1 is SCHED_FIFO"
                );
                assert_eq!(granted.refusals, []);
            }
            None => {
                assert_eq!(
                    (0, 0),
                    priority_and_policy(&stat),
                    "policy 0 is the normal one"
                );
                assert_eq!(granted.refusals, [SchedError::SetScheduling(libc::EPERM)]);
            }
        }
    }

    #[test]
    fn a_priority_out_of_range_is_refused() {
        let asked = Scheduling {
            priority: Some(1000),
            ..Scheduling::default()
        };
        assert_eq!(
            entered(asked.clone()).0,
            Err(SchedError::SetScheduling(libc::EINVAL))
        );
        assert_eq!(asked.probe(), Err(SchedError::SetScheduling(libc::EINVAL)));
        let (granted, stat, _) = entered(Scheduling {
            realtime: Realtime::Ignore,
            ..asked
        });
        assert_eq!(
            granted.expect("nothing is enforced").refusals,
            [SchedError::SetScheduling(libc::EINVAL)]
        );
        assert_eq!((0, 0), priority_and_policy(&stat));
    }

    #[test]
    fn enforce_needs_both_the_right_to_fifo_and_a_realtime_kernel() {
        let outcome = entered(Scheduling::default()).0;
        if kernel_is_realtime() {
            assert!(
                matches!(outcome, Ok(_) | Err(SchedError::SetScheduling(_))),
                "{outcome:?}"
            );
        } else {
            let error = outcome.expect_err("the kernel is no real-time one");
            assert!(
                matches!(
                    error,
                    SchedError::KernelNotRealtime | SchedError::SetScheduling(_)
                ),
                "{error:?}"
            );
        }
    }

    #[test]
    fn the_thread_runs_on_the_processor_asked_for_and_not_on_one_that_does_not_exist() {
        let asked = Scheduling {
            realtime: Realtime::Ignore,
            cpu: Some(0),
            ..Scheduling::default()
        };
        let (granted, _, status) = entered(asked.clone());
        let pinned = status.contains("Cpus_allowed_list:\t0\n");
        let refused = granted
            .expect("nothing is enforced")
            .refusals
            .iter()
            .any(|r| matches!(r, SchedError::Pin { .. }));
        assert_ne!(pinned, refused, "{status}");

        let absent = SchedError::Pin {
            cpu: 1023,
            errno: libc::EINVAL,
        };
        let granted = entered(Scheduling {
            cpu: Some(1023),
            ..asked
        })
        .0
        .expect("nothing is enforced");
        assert!(granted.refusals.contains(&absent), "{granted:?}");
    }

    #[test]
    fn the_texts_are_those_of_libfranka() {
        for (error, text) in [
            (
                SchedError::MaximumPriority(libc::EINVAL),
                "libfranka: unable to get maximum possible thread priority: Invalid argument",
            ),
            (
                SchedError::SetScheduling(libc::EPERM),
                "libfranka: unable to set realtime scheduling: Operation not permitted",
            ),
            (
                SchedError::KernelNotRealtime,
                "libfranka: Running kernel does not have realtime capabilities.",
            ),
        ] {
            assert_eq!(error.to_string(), text);
        }
    }
}
