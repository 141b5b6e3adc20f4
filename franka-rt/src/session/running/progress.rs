//! Progress of a goal that something holds back: the leash, a guard of the course, or a push.
//!
//! Time counts while the goal is held back without coming nearer to its target. Short pauses count
//! too, because a push that comes and goes may undo the way that the arm gains in the pauses.

use crate::session::STALL_TIMEOUT;

/// The least distance to the target so far, and the time for which the goal was held back since.
#[derive(Debug)]
pub(super) struct Progress {
    least: f64,
    /// Time for which the goal was held back, short pauses included, `[ms]`.
    held: u64,
    /// Part of this time for which the leash held it, `[ms]`.
    leashed: u64,
    /// Time of the newest cycle in which the goal was held back, `message_id` of the state.
    last: u64,
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            least: f64::INFINITY,
            held: 0,
            leashed: 0,
            last: 0,
        }
    }
}

impl Progress {
    /// Records that the goal is held back at `now`, `message_id`, at this distance from its target,
    /// in any unit; infinite if the target has no place. `leashed` is true if the leash holds it.
    pub(super) fn hold(&mut self, distance: f64, leashed: bool, now: u64) {
        let since = now.saturating_sub(self.last);
        self.last = now;
        if distance < NEARER * self.least {
            self.least = distance;
            (self.held, self.leashed) = (0, 0);
            return;
        }
        let took = if since <= PAUSE { since } else { 1 };
        self.held += took;
        if leashed {
            self.leashed += took;
        }
    }

    /// Records that nothing holds the goal back at `now`, `message_id`. After a long pause, the
    /// time counts from zero again.
    pub(super) fn release(&mut self, now: u64) {
        if now.saturating_sub(self.last) > PAUSE {
            (self.held, self.leashed) = (0, 0);
        }
    }

    /// True if the goal was held back for too long without coming nearer.
    pub(super) fn is_stalled(&self) -> bool {
        u128::from(self.held) >= STALL_TIMEOUT.as_millis()
    }

    /// True if mainly the leash held the goal back.
    pub(super) fn is_obstructed(&self) -> bool {
        2 * self.leashed >= self.held
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
            progress.hold(distance(*now), true, *now);
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
            progress.hold(0.1, true, now);
        }
        assert!(!progress.is_stalled());
        // Something touches it much later.
        progress.hold(0.1, true, 10 * most);
        assert!(!progress.is_stalled());
        // A stalled goal that nothing holds back any more may be pursued again.
        for now in 10 * most + 1..12 * most {
            progress.hold(0.1, true, now);
        }
        assert!(progress.is_stalled());
        progress.release(12 * most + PAUSE - 1);
        assert!(progress.is_stalled());
        progress.release(12 * most + PAUSE);
        assert!(!progress.is_stalled());
    }

    #[test]
    fn the_leash_obstructs_a_goal_that_it_holds_half_of_the_time() {
        for (share, obstructs) in [(1, true), (2, true), (3, false)] {
            let mut progress = Progress::default();
            let mut now = 0;
            while !progress.is_stalled() {
                now += 1;
                progress.hold(f64::INFINITY, now % share == 0, now);
            }
            assert_eq!(now, STALL_TIMEOUT.as_millis() as u64, "{share}");
            assert_eq!(progress.is_obstructed(), obstructs, "{share}");
        }
    }
}
