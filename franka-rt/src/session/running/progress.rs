//! Progress of a goal against pushes that come and go.
//!
//! A push that holds a goal back all the time stalls it. One that pauses lets the count of its
//! cycles fall again, although it may undo all that the arm gained in the pauses. So the distance
//! to the target decides, too.

use crate::session::STALL_TIMEOUT;

/// The least distance to the target so far, and the time for which the goal was held back since.
#[derive(Debug)]
pub(super) struct Progress {
    least: f64,
    /// Time for which the goal was held back, short pauses included, `[ms]`.
    held: u64,
    /// Time of the newest cycle in which it was, `message_id` of the state.
    last: u64,
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            least: f64::INFINITY,
            held: 0,
            last: 0,
        }
    }
}

impl Progress {
    /// Records that the goal is held back at `now`, `message_id`, at this distance from its target,
    /// in any unit.
    pub(super) fn hold(&mut self, distance: f64, now: u64) {
        let since = now.saturating_sub(self.last);
        self.last = now;
        if distance < NEARER * self.least {
            self.least = distance;
            self.held = 0;
        } else {
            self.held += if since <= PAUSE { since } else { 1 };
        }
    }

    /// Records that nothing holds the goal back at `now`, `message_id`. After a long pause, the
    /// time counts from zero again.
    pub(super) fn release(&mut self, now: u64) {
        if now.saturating_sub(self.last) > PAUSE {
            self.held = 0;
        }
    }

    /// True if the goal was held back for too long without coming nearer.
    pub(super) fn is_stalled(&self) -> bool {
        u128::from(self.held) >= STALL_TIMEOUT.as_millis()
    }
}

/// Share of the least distance below which the arm has come nearer. It bounds the number of times
/// that a goal gains new time.
const NEARER: f64 = 0.95;

/// Longest pause of a push that counts as part of it, `[ms]`.
const PAUSE: u64 = 1000;

#[cfg(test)]
mod tests {
    use super::*;

    /// Time until a goal is stalled that is held back in every second 250 ms, `[ms]`.
    fn stalled_after(progress: &mut Progress, distance: impl Fn(u64) -> f64) -> u64 {
        let pushed = |now: &u64| now % 500 < 250;
        let stalls = |now: &u64| {
            progress.hold(distance(*now), *now);
            progress.is_stalled()
        };
        (1..).filter(pushed).find(stalls).expect("it has an end")
    }

    #[test]
    fn pushes_that_undo_what_the_pauses_gain_stall_a_goal() {
        let most = STALL_TIMEOUT.as_millis() as u64;
        let swings = |now: u64| 0.1 + 4e-3 * (now as f64 * 0.02).cos();
        let took = stalled_after(&mut Progress::default(), swings);
        // The first swing comes nearer.
        assert!((most..most + 500).contains(&took), "{took}");
    }

    #[test]
    fn a_goal_that_comes_nearer_has_its_time_again() {
        let most = STALL_TIMEOUT.as_millis() as u64;
        let comes_nearer = |now: u64| 0.9_f64.powi((now / 4000).min(20) as i32);
        let took = stalled_after(&mut Progress::default(), comes_nearer);
        assert!((80_000 + most..81_000 + most).contains(&took), "{took}");
    }

    #[test]
    fn a_released_goal_has_no_time_counted() {
        let mut progress = Progress::default();
        let most = STALL_TIMEOUT.as_millis() as u64;
        for now in 1..most {
            progress.hold(0.1, now);
        }
        assert!(!progress.is_stalled());
        // Something touches it much later.
        progress.hold(0.1, 10 * most);
        assert!(!progress.is_stalled());
        // A stalled goal that nothing holds back any more may be pursued again.
        for now in 10 * most + 1..12 * most {
            progress.hold(0.1, now);
        }
        assert!(progress.is_stalled());
        progress.release(12 * most + PAUSE - 1);
        assert!(progress.is_stalled());
        progress.release(12 * most + PAUSE);
        assert!(!progress.is_stalled());
    }
}
