//! Attempts: growing pauses between them, and a limit of how many are made within a time.

use core::time::Duration;
use std::collections::VecDeque;

use super::policy::Backoff;

/// Computes random pauses.
#[derive(Clone, Debug)]
pub(super) struct Pauses {
    backoff: Backoff,
    random: u64,
}

impl Pauses {
    pub(super) fn new(backoff: Backoff, seed: u64) -> Self {
        Self {
            backoff,
            random: seed,
        }
    }

    /// Returns the pause after `failed` failed attempts, 1 or more.
    pub(super) fn after(&mut self, failed: u32) -> Duration {
        let Backoff {
            first,
            most,
            jitter,
        } = self.backoff;
        let doublings = failed.saturating_sub(1).min(31);
        let longest = first.saturating_mul(1 << doublings).min(most);
        let jitter = if jitter.is_nan() { 0.0 } else { jitter };
        let share = jitter.clamp(0.0, 1.0) * self.draw();
        // Multiplied by a share, the longest duration would be rounded up beyond its range.
        let pause = longest.as_secs_f64() * (1.0 - share);
        Duration::try_from_secs_f64(pause).unwrap_or(longest)
    }

    /// Returns a random number in [0, 1) with SplitMix64. Source: Steele, Lea, Flood: Fast
    /// splittable pseudorandom number generators, 2014.
    fn draw(&mut self) -> f64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.random;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
        (mixed >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Attempts(VecDeque<Duration>);

impl Attempts {
    /// Records an attempt at `now`, unless `most` attempts were made within the `window` before.
    /// Returns true if the attempt may be made.
    pub(super) fn note(&mut self, most: u32, window: Duration, now: Duration) -> bool {
        self.forget(window, now);
        let may = self.0.len() < most as usize;
        if may {
            self.0.push_back(now);
        }
        may
    }

    pub(super) fn may(&mut self, most: u32, window: Duration, now: Duration) -> bool {
        self.forget(window, now);
        self.0.len() < most as usize
    }

    fn forget(&mut self, window: Duration, now: Duration) {
        let is_past = |&made: &Duration| made.saturating_add(window) <= now;
        while self.0.front().is_some_and(is_past) {
            self.0.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: fn(u64) -> Duration = Duration::from_millis;

    #[test]
    fn pauses_double_up_to_a_maximum_and_jitter_shortens_them() {
        let backoff = Backoff {
            first: MS(100),
            most: MS(500),
            jitter: 0.0,
        };
        let mut pauses = Pauses::new(backoff, 7);
        let drawn: Vec<Duration> = (1..=5).map(|failed| pauses.after(failed)).collect();
        assert_eq!(drawn, [MS(100), MS(200), MS(400), MS(500), MS(500)]);
        assert_eq!(pauses.after(u32::MAX), MS(500));

        let jittery = Backoff {
            jitter: 0.5,
            ..backoff
        };
        let draw = |seed| {
            let mut pauses = Pauses::new(jittery, seed);
            (0..100).map(|_| pauses.after(9)).collect::<Vec<_>>()
        };
        let drawn = draw(7);
        assert!(
            drawn
                .iter()
                .all(|pause| (MS(250)..=MS(500)).contains(pause))
        );
        let range = |way: fn(_) -> Option<&'static Duration>| way(drawn.clone().leak().iter());
        assert!(range(Iterator::min) < Some(&MS(270)) && range(Iterator::max) > Some(&MS(480)));
        assert_eq!(drawn, draw(7), "a seed gives the same pauses");
        assert_ne!(drawn, draw(8));
        let broken = Backoff {
            jitter: f64::NAN,
            ..backoff
        };
        assert_eq!(Pauses::new(broken, 7).after(1), MS(100));
    }

    #[test]
    fn attempts_within_a_window_are_limited_and_old_ones_forgotten() {
        let mut attempts = Attempts::default();
        let mut note = |now| attempts.note(2, MS(100), MS(now));
        assert_eq!([note(0), note(60), note(99)], [true, true, false]);
        assert_eq!([note(100), note(159), note(160)], [true, false, true]);
        assert!(!Attempts::default().note(0, MS(100), MS(0)));
    }

    #[test]
    fn windows_and_pauses_may_be_as_long_as_a_duration_can_be() {
        let (mut attempts, ever) = (Attempts::default(), Duration::MAX);
        let noted: Vec<bool> = (1..5)
            .map(|day| attempts.note(3, ever, MS(86_400_000 * day)))
            .collect();
        assert_eq!(noted, [true, true, true, false]);
        assert!(!attempts.may(3, ever, MS(u64::MAX)));
        let backoff = Backoff {
            first: ever,
            most: ever,
            jitter: 0.0,
        };
        assert_eq!(Pauses::new(backoff, 7).after(1), ever);
    }
}
