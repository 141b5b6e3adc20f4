//! The replacement for `linux` on other systems.

use core::time::Duration;
use std::io;
use std::net::Ipv4Addr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use crate::host::{Ethtool, Unread};
use crate::latencies::Latencies;

/// Returns an error, because drivers of network cards can be queried only on Linux.
pub(super) fn ethtool(interface: &str, question: Ethtool) -> Result<Vec<u8>, Unread> {
    let what = format!("ethtool {interface} {:#04x}", question.command());
    Err(Unread::Failed(what, "available on Linux only".into()))
}

/// Returns no answer, because leased addresses can be detected only on Linux.
pub(super) fn is_lasting(_: Ipv4Addr) -> io::Result<Option<bool>> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Does nothing, because a thread cannot be bound to a processor here.
pub(super) fn pin_to(_: usize) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Sleeps until the end of each of `cycles` milliseconds, and records how late each wake-up is.
pub(super) fn wake_ups(
    priority: Option<i32>,
    cycles: u64,
    done: &AtomicU64,
) -> Result<Latencies, String> {
    let mut wake_ups = Latencies::new(priority);
    let mut due = Instant::now();
    for cycle in 0..cycles {
        due += Duration::from_millis(1);
        thread::sleep(due.saturating_duration_since(Instant::now()));
        let woken = Instant::now();
        wake_ups.note(woken.saturating_duration_since(due));
        // A wake-up that is later than the next period counts only once.
        while due + Duration::from_millis(1) <= woken {
            due += Duration::from_millis(1);
        }
        done.store(cycle + 1, Ordering::Relaxed);
    }
    Ok(wake_ups)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_wake_up_that_was_asked_for_is_counted() {
        let done = AtomicU64::new(0);
        let wake_ups = wake_ups(None, 20, &done).expect("nothing is asked of the system");
        assert_eq!((wake_ups.count(), done.into_inner()), (20, 20));
        assert_eq!(wake_ups.priority, None);
    }
}
