//! Whether the borrower of the cycle runs it.

use core::time::Duration;
use std::time::Instant;

use super::lifetime::Lifetime;
use crate::event_fd::EventFd;

/// Watches the turns of one borrower while the thread waits for its cycle, and tells when none has
/// come for the link timeout. It is over when it is dropped.
pub(super) struct BorrowerWatch<'a> {
    lifetime: &'a Lifetime,
    event_fd: &'a EventFd,
    timeout: Duration,
    turns: u64,
    since: Instant,
    /// What the last look found.
    stalled: bool,
}

impl<'a> BorrowerWatch<'a> {
    pub(super) fn new(lifetime: &'a Lifetime, event_fd: &'a EventFd, timeout: Duration) -> Self {
        Self {
            lifetime,
            event_fd,
            timeout,
            turns: lifetime.turns(),
            since: Instant::now(),
            stalled: false,
        }
    }

    /// Looks whether there was a turn since the last look.
    pub(super) fn look(&mut self) {
        let turns = self.lifetime.turns();
        if turns != self.turns {
            self.turns = turns;
            self.since = Instant::now();
        }
        self.set(self.since.elapsed() >= self.timeout);
    }

    /// Notifies of a change, also of one that the borrower has made by a turn.
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
