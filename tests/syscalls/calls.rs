//! System calls by name, and those that a control cycle may make.

use std::collections::BTreeMap;

use crate::tracer::{Call, Calls};

/// The calls that a cycle may make, with any arguments.
const ALLOWED: &[i64] = &[
    libc::SYS_recvfrom,
    libc::SYS_recvmsg,
    libc::SYS_sendto,
    libc::SYS_sendmsg,
    libc::SYS_ppoll,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_poll,
    // Absent where the kernel serves the clock without a system call (vDSO).
    libc::SYS_clock_gettime,
    // The kernel's own: it continues a wait that a stop of the process has interrupted.
    libc::SYS_restart_syscall,
];

/// The target of an eventfd's descriptor in `/proc`.
const EVENTFD: &str = "anon_inode:[eventfd]";

/// True if a cycle may make this call. A `write` is allowed to the eventfd only.
pub(crate) fn is_allowed(call: &Call) -> bool {
    ALLOWED.contains(&call.number) || call.target.as_deref() == Some(EVENTFD)
}

/// True if this call waits for the robot.
fn receives(call: &Call) -> bool {
    [libc::SYS_recvfrom, libc::SYS_recvmsg].contains(&call.number)
}

impl Calls {
    /// The calls from the first to the last that waits for the robot. Calls before and after them
    /// set the thread up and take it down, and are not restricted.
    pub(crate) fn of_the_cycle(&self) -> &[Call] {
        let first = self.calls.iter().position(receives);
        let last = self.calls.iter().rposition(receives);
        match (first, last) {
            (Some(first), Some(last)) => &self.calls[first..=last],
            _ => &[],
        }
    }
}

/// The number of times that each call was made.
pub(crate) fn counted<'a>(calls: impl IntoIterator<Item = &'a Call>) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    for call in calls {
        *counts.entry(name_of(call)).or_default() += 1;
    }
    counts
}

fn name_of(call: &Call) -> String {
    let known = NAMES.iter().find(|(number, _)| *number == call.number);
    let name = known.map_or_else(
        || format!("call {}", call.number),
        |(_, name)| (*name).to_owned(),
    );
    match &call.target {
        Some(target) => format!("{name} to {target}"),
        None => name,
    }
}

/// Names of calls that may occur; other calls are shown by their number.
const NAMES: &[(i64, &str)] = &[
    (libc::SYS_recvfrom, "recvfrom"),
    (libc::SYS_recvmsg, "recvmsg"),
    (libc::SYS_sendto, "sendto"),
    (libc::SYS_sendmsg, "sendmsg"),
    (libc::SYS_ppoll, "ppoll"),
    #[cfg(target_arch = "x86_64")]
    (libc::SYS_poll, "poll"),
    (libc::SYS_clock_gettime, "clock_gettime"),
    (libc::SYS_clock_nanosleep, "clock_nanosleep"),
    (libc::SYS_read, "read"),
    (libc::SYS_write, "write"),
    (libc::SYS_futex, "futex"),
    (libc::SYS_mmap, "mmap"),
    (libc::SYS_munmap, "munmap"),
    (libc::SYS_mprotect, "mprotect"),
    (libc::SYS_madvise, "madvise"),
    (libc::SYS_brk, "brk"),
    (libc::SYS_getppid, "getppid"),
    (libc::SYS_sched_yield, "sched_yield"),
    (libc::SYS_restart_syscall, "restart_syscall"),
    (libc::SYS_exit, "exit"),
];
