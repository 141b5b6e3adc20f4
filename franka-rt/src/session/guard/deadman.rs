//! The deadman: a token that has to be kept alive. The arm brakes when its owner is silent or gone.

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::sync::Arc;

/// The value of the counter once the token is dropped.
const GONE: u64 = u64::MAX;

/// The token of a session. [`Self::keep_alive`] has to be called more often than every `silence`;
/// otherwise, and once the token is dropped, the arm brakes and holds, and every goal ends as held,
/// until the token is kept alive again. A token that was dropped never comes back.
///
/// The control thread watches it by the robot's clock, whatever the rest of the program is busy
/// with.
#[derive(Debug)]
pub struct Deadman {
    beats: Arc<AtomicU64>,
    silence: Duration,
}

/// The other end of a [`Deadman`], for the session that is bound to it.
#[derive(Debug)]
pub struct DeadmanMonitor {
    beats: Arc<AtomicU64>,
    silence: Duration,
    /// The newest count, and the robot's time when it was first seen, `[ms]`.
    seen: Option<(u64, u64)>,
}

impl Deadman {
    /// Returns a token that may be silent for `silence`, in whole milliseconds, and the end of it
    /// for a session.
    pub fn new(silence: Duration) -> (Self, DeadmanMonitor) {
        let beats = Arc::new(AtomicU64::new(0));
        let token = Self {
            beats: beats.clone(),
            silence,
        };
        let monitor = DeadmanMonitor {
            beats,
            silence,
            seen: None,
        };
        (token, monitor)
    }

    /// Restarts the time of silence. Wait-free.
    pub fn keep_alive(&self) {
        // Relaxed: the count is all that crosses.
        self.beats.fetch_add(1, Ordering::Relaxed);
    }

    /// How long it may be silent.
    pub fn silence(&self) -> Duration {
        self.silence
    }
}

impl Drop for Deadman {
    fn drop(&mut self) {
        // Relaxed, as above. The counter has no other writer any more.
        self.beats.store(GONE, Ordering::Relaxed);
    }
}

impl DeadmanMonitor {
    /// How long the token may be silent.
    pub fn silence(&self) -> Duration {
        self.silence
    }

    /// Whether the token lives at the robot's time `now`, `[ms]`. Its silence counts from the first
    /// call on.
    pub(crate) fn is_alive(&mut self, now: u64) -> bool {
        let beats = self.beats.load(Ordering::Relaxed);
        let since = match self.seen {
            Some((seen, since)) if seen == beats => since,
            _ => {
                self.seen = Some((beats, now));
                now
            }
        };
        beats != GONE && u128::from(now.saturating_sub(since)) < self.silence.as_millis()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_and_drop_are_both_the_end_and_only_silence_is_mended() {
        let (token, mut monitor) = Deadman::new(Duration::from_millis(100));
        assert!(monitor.is_alive(7));
        assert!(monitor.is_alive(106));
        assert!(!monitor.is_alive(107));
        token.keep_alive();
        assert!(monitor.is_alive(500));
        assert!(!monitor.is_alive(600));
        token.keep_alive();
        assert!(monitor.is_alive(601));
        drop(token);
        assert!(!monitor.is_alive(602));
    }
}
