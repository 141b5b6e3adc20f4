//! Watchdog for a borrower of the cycle that does not run it.

use core::time::Duration;
use std::time::Instant;

use super::lifetime::Lifetime;
use crate::event_fd::EventFd;
use crate::exchange::TICK;

/// Counts the turns of one borrower while the thread waits for its cycle. Reports if no turn has
/// come for the link timeout. Dropping the watch ends it.
pub(super) struct BorrowerWatch<'a> {
    lifetime: &'a Lifetime,
    event_fd: &'a EventFd,
    timeout: Duration,
    turns: u64,
    /// Time since the last turn.
    idle: Duration,
    looked: Instant,
    /// Result of the last check.
    stalled: bool,
}

impl<'a> BorrowerWatch<'a> {
    pub(super) fn new(
        lifetime: &'a Lifetime,
        event_fd: &'a EventFd,
        timeout: Duration,
        now: Instant,
    ) -> Self {
        Self {
            lifetime,
            event_fd,
            timeout,
            turns: lifetime.turns(),
            idle: Duration::ZERO,
            looked: now,
            stalled: false,
        }
    }

    /// Checks at the time `now` whether there was a turn since the last check. If more than a tick
    /// has passed, the host has delayed this thread, and perhaps the borrower, so only one tick
    /// counts.
    pub(super) fn look(&mut self, now: Instant) {
        let turns = self.lifetime.turns();
        if turns == self.turns {
            self.idle += now.saturating_duration_since(self.looked).min(TICK);
        } else {
            self.turns = turns;
            self.idle = Duration::ZERO;
        }
        self.looked = now;
        self.set(self.idle >= self.timeout);
    }

    /// Sets the flag. Notifies if it changed, even if a turn of the borrower changed it.
    fn set(&mut self, stalled: bool) {
        if self.lifetime.set_stalled(stalled) || self.stalled != stalled {
            self.stalled = stalled;
            self.event_fd.notify();
        }
    }
}

impl Drop for BorrowerWatch<'_> {
    fn drop(&mut self) {
        self.set(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn watch_delay_is_no_stall_of_the_borrower() {
        let (lifetime, event_fd) = (Lifetime::default(), EventFd::new().expect("a descriptor"));
        let mut now = Instant::now();
        let mut watch = BorrowerWatch::new(&lifetime, &event_fd, 5 * TICK, now);
        let mut look_after = |pause| {
            now += pause;
            watch.look(now);
            (lifetime.is_stalled(), event_fd.drain() > 0)
        };
        // The process stops once for a long time. Then come four ticks in which the borrower could
        // run a turn.
        let stop = Duration::from_secs(10);
        for pause in [stop, TICK, TICK, TICK] {
            assert_eq!(look_after(pause), (false, false));
        }
        assert_eq!(look_after(TICK), (true, true));
        assert_eq!(look_after(TICK), (true, false), "told once");
        lifetime.note_turn();
        assert_eq!(look_after(TICK), (false, true));
        assert_eq!(look_after(stop), (false, false));
    }
}
