//! Linux-specific values. No other file of the crate contains `unsafe`.

use core::time::Duration;
use std::io;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::fd::AsRawFd as _;
use std::sync::atomic::{AtomicU64, Ordering};

use nix::sched::{CpuSet, sched_setaffinity};
use nix::sys::time::TimeSpec;
use nix::time::{ClockId, ClockNanosleepFlags, clock_gettime, clock_nanosleep};
use nix::unistd::Pid;

use crate::host::{Ethtool, Unread};
use crate::latencies::Latencies;
pub(super) use crate::lease::is_lasting;

/// Queries the driver of a network card with `ioctl`, and returns its answer.
pub(super) fn ethtool(interface: &str, question: Ethtool) -> Result<Vec<u8>, Unread> {
    let what = format!("ethtool {interface} {:#04x}", question.command());
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))
        .map_err(|error| Unread::new(what.as_str(), &error))?;
    // SAFETY: `ifreq` is a C struct of integers, a pointer and arrays, for which all zeros is
    // a valid value.
    let mut ifreq: libc::ifreq = unsafe { core::mem::zeroed() };
    if interface.len() >= ifreq.ifr_name.len() {
        return Err(Unread::Absent(what));
    }
    for (to, from) in ifreq.ifr_name.iter_mut().zip(interface.bytes()) {
        *to = from as libc::c_char;
    }
    let mut answer = [0_u32; ANSWER_WORDS];
    answer[0] = question.command();
    ifreq.ifr_ifru.ifru_data = (&raw mut answer).cast();
    // SAFETY: the descriptor is open during the call. The kernel reads the name, which ends with a
    // zero. Behind the pointer it reads and writes the structure of the command: at most 196 bytes,
    // of members of at most four bytes (`linux/ethtool.h`). `answer` is initialised, aligned for
    // these members, and larger.
    let done = unsafe { libc::ioctl(socket.as_raw_fd(), SIOCETHTOOL, &raw mut ifreq) };
    if done == -1 {
        let error = io::Error::last_os_error();
        return Err(match error.raw_os_error() {
            Some(libc::EOPNOTSUPP) => {
                Unread::Failed(what, "the driver of the card does not report it".into())
            }
            _ => Unread::new(what, &error),
        });
    }
    let mut bytes: Vec<u8> = answer.iter().flat_map(|word| word.to_ne_bytes()).collect();
    bytes.truncate(question.size());
    Ok(bytes)
}

/// Binds the calling thread to one processor.
pub(super) fn pin_to(cpu: usize) -> io::Result<()> {
    let mut only = CpuSet::new();
    only.set(cpu)?;
    // The process id 0 means the calling thread.
    sched_setaffinity(Pid::from_raw(0), &only)?;
    Ok(())
}

/// Sleeps until the end of each of `cycles` milliseconds, and records how late each wake-up is.
pub(super) fn wake_ups(
    priority: Option<i32>,
    cycles: u64,
    done: &AtomicU64,
) -> Result<Latencies, String> {
    let mut wake_ups = Latencies::new(priority);
    let clock = ClockId::CLOCK_MONOTONIC;
    let now = || {
        clock_gettime(clock)
            .map(Duration::from)
            .map_err(|error| error.to_string())
    };
    let mut due = now()?;
    for cycle in 0..cycles {
        due += Duration::from_millis(1);
        let until = TimeSpec::from_duration(due);
        clock_nanosleep(clock, ClockNanosleepFlags::TIMER_ABSTIME, &until)
            .map_err(|error| error.to_string())?;
        let woken = now()?;
        wake_ups.note(woken.saturating_sub(due));
        // A wake-up that is later than the next period counts only once.
        while due + Duration::from_millis(1) <= woken {
            due += Duration::from_millis(1);
        }
        done.store(cycle + 1, Ordering::Relaxed);
    }
    Ok(wake_ups)
}

/// Size of the buffer for the answer to an ethtool query, in words of four bytes.
const ANSWER_WORDS: usize = 64;

/// Number of the `ioctl` request, from `linux/sockios.h`. Its type in libc depends on the platform.
const SIOCETHTOOL: libc::Ioctl = 0x8946;
