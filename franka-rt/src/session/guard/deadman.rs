//! The deadman: a token that the program must keep alive. If its owner is silent, or drops the
//! token, the arm brakes.

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::sync::Arc;

use crate::session::Goal;

/// Value of the counter after the token was dropped.
const GONE: u64 = u64::MAX;

/// A count that no token reaches.
const NEVER: u64 = u64::MAX - 1;

/// State that both ends of a deadman share.
#[derive(Debug)]
pub struct Pulse {
    /// Number of times that the owner has kept the token alive.
    beats: AtomicU64,
    /// Count at which the thread last found that the token was silent.
    silent: AtomicU64,
}

impl Pulse {
    /// True if the control thread has found that the token was silent, and the owner has not kept
    /// it alive since.
    pub fn is_silent(&self) -> bool {
        // Relaxed, as below.
        self.beats.load(Ordering::Relaxed) == self.silent.load(Ordering::Relaxed)
    }
}

/// The owner's end of a deadman: a token to which a session is bound. Call [`Self::keep_alive`] at
/// least once in every `silence`. If you do not, or if the token is dropped, the arm brakes and
/// holds, and every goal ends as held. The next call of [`Self::keep_alive`] ends this state; after
/// a drop it is permanent.
///
/// The control thread checks the token by the robot's clock, independently of the rest of the
/// program.
#[derive(Debug)]
#[must_use = "dropping the deadman brakes the arm"]
pub struct Deadman {
    pulse: Arc<Pulse>,
    silence: Duration,
}

/// The other end of a [`Deadman`], for the session that is bound to it. A clone serves another
/// session.
#[derive(Clone, Debug)]
pub struct DeadmanMonitor {
    pulse: Arc<Pulse>,
    silence: Duration,
    /// The newest count, and the time when it was first seen, by the robot's clock, `[ms]`.
    seen: Option<(u64, u64)>,
}

impl Deadman {
    /// The shortest silence that a session accepts.
    pub const SILENCE_MIN: Duration = Goal::SILENCE_MIN;

    /// Creates a token that may be silent for `silence`, in whole milliseconds, and its monitor for
    /// a session.
    pub fn new(silence: Duration) -> (Self, DeadmanMonitor) {
        let pulse = Arc::new(Pulse {
            beats: AtomicU64::new(0),
            silent: AtomicU64::new(NEVER),
        });
        let token = Self {
            pulse: pulse.clone(),
            silence,
        };
        let monitor = DeadmanMonitor {
            pulse,
            silence,
            seen: None,
        };
        (token, monitor)
    }

    /// Keeps the token alive: restarts the timer of its silence. Wait-free.
    pub fn keep_alive(&self) {
        // Relaxed: only the count is passed between the threads.
        self.pulse.beats.fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the longest permitted silence.
    pub fn silence(&self) -> Duration {
        self.silence
    }
}

impl Drop for Deadman {
    fn drop(&mut self) {
        // Relaxed, as above. The counter has no other writer at this point.
        self.pulse.beats.store(GONE, Ordering::Relaxed);
    }
}

impl DeadmanMonitor {
    /// Returns the longest permitted silence of the token.
    pub fn silence(&self) -> Duration {
        self.silence
    }

    /// True once the token was dropped.
    pub fn is_gone(&self) -> bool {
        // Relaxed, as above.
        self.pulse.beats.load(Ordering::Relaxed) == GONE
    }

    /// True if the token is alive at the robot's time `now`, `[ms]`. The timer of the silence
    /// starts with the first call.
    pub(crate) fn is_alive(&mut self, now: u64) -> bool {
        let beats = self.pulse.beats.load(Ordering::Relaxed);
        let since = match self.seen {
            Some((seen, since)) if seen == beats => since,
            _ => {
                self.seen = Some((beats, now));
                now
            }
        };
        let alive =
            beats != GONE && u128::from(now.saturating_sub(since)) < self.silence.as_millis();
        if !alive {
            self.pulse.silent.store(beats, Ordering::Relaxed);
        }
        alive
    }

    /// Returns the state of the token that can be read outside the control thread.
    pub fn pulse(&self) -> Arc<Pulse> {
        self.pulse.clone()
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
        assert!(!monitor.pulse().is_silent());
        assert!(!monitor.is_alive(107));
        assert!(monitor.pulse().is_silent());
        token.keep_alive();
        assert!(
            !monitor.pulse().is_silent(),
            "before the thread has seen it"
        );
        assert!(monitor.is_alive(500));
        assert!(!monitor.is_alive(600));
        token.keep_alive();
        assert!(monitor.is_alive(601));
        drop(token);
        assert!(!monitor.is_alive(602));
        assert!(monitor.pulse().is_silent());
    }
}
