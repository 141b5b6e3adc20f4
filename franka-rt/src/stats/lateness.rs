//! Lateness of states relative to their due times. A late state is answered like any other state.
//! `exchange` drops a state if a newer state has overtaken it.

use core::time::Duration;
use std::time::Instant;

use super::cycle::CYCLE_NANOS;

/// Estimates when the next state is due, from the arrivals of earlier states.
///
/// The robot sends one state per millisecond of its own clock, and no state arrives before it is
/// sent. The most punctual state of a recent window therefore determines the offset between the two
/// clocks. The lateness of another state is the delay by network, kernel and scheduler. The window
/// is short, so the estimate soon forgets clock drift and pauses of a simulated robot. A drift of
/// 100 ppm changes the offset by 6 us within a window.
#[derive(Debug, Default)]
pub(super) struct Arrivals {
    /// `message_id` and arrival time of the state that all offsets refer to.
    origin: Option<(u64, Instant)>,
    /// Smallest offsets of the previous window and of the current window so far, in nanoseconds.
    earliest: [i64; 2],
    /// Number of states in the current window.
    counted: u32,
}

impl Arrivals {
    /// Returns the lateness of a state that arrived at `now`.
    pub(super) fn note(&mut self, time: u64, now: Instant) -> Duration {
        let (first, start) = *self.origin.get_or_insert((time, now));
        let elapsed = now.saturating_duration_since(start).as_nanos();
        let elapsed = i64::try_from(elapsed).unwrap_or(i64::MAX);
        let robots = i64::try_from(time.saturating_sub(first)).unwrap_or(i64::MAX);
        let offset = elapsed.saturating_sub(robots.saturating_mul(CYCLE_NANOS));
        if self.counted == WINDOW {
            self.earliest = [self.earliest[1], i64::MAX];
            self.counted = 0;
        }
        self.counted += 1;
        self.earliest[1] = self.earliest[1].min(offset);
        let earliest = self.earliest[0].min(self.earliest[1]);
        let late = offset.saturating_sub(earliest);
        Duration::from_nanos(late.unsigned_abs())
    }
}

/// Number of states in a window. The estimate covers one to two windows.
const WINDOW: u32 = 32;

#[cfg(test)]
mod tests {
    use super::*;

    const US: fn(u64) -> Duration = Duration::from_micros;

    /// Returns the lateness of states, in microseconds, if each state is late by `late` and the
    /// robot's clock is fast by `ppm`.
    fn lateness(times: core::ops::Range<u64>, ppm: i64, late: impl Fn(u64) -> u64) -> Vec<u64> {
        let start = Instant::now();
        let mut arrivals = Arrivals::default();
        times
            .map(|time| {
                let due = time as i64 * (CYCLE_NANOS - ppm);
                let now = start + Duration::from_nanos(due.unsigned_abs()) + US(late(time));
                arrivals.note(time, now).as_micros() as u64
            })
            .collect()
    }

    #[test]
    fn a_punctual_robot_is_never_late() {
        assert!(lateness(5..500, 0, |_| 0).iter().all(|&late| late == 0));
    }

    #[test]
    fn lateness_equals_the_extra_delay() {
        let delay = |time| if time % 10 == 7 { 100 + time } else { 20 };
        let found = lateness(0..500, 0, delay);
        for (time, late) in found.iter().enumerate() {
            assert_eq!(*late, delay(time as u64) - 20, "state {time}");
        }
    }

    #[test]
    fn late_first_state_is_trusted_until_a_punctual_one() {
        let found = lateness(0..4, 0, |time| if time < 2 { 700 } else { 50 });
        assert_eq!(found, [0, 0, 0, 0]);
        let found = lateness(0..4, 0, |time| if time == 1 { 50 } else { 700 });
        assert_eq!(found, [0, 0, 650, 650]);
    }

    #[test]
    fn gaps_change_nothing() {
        let start = Instant::now();
        let mut arrivals = Arrivals::default();
        for (time, at) in [(10, 0), (11, 1000), (15, 5030), (16, 6000)] {
            let late = arrivals.note(time, start + US(at));
            assert_eq!(late, US(if time == 15 { 30 } else { 0 }));
        }
    }

    #[test]
    fn clocks_that_drift_apart_count_for_little() {
        for ppm in [-100, 100] {
            let found = lateness(0..60_000, ppm, |_| 0);
            let most = found.iter().max().copied();
            assert!(most <= Some(7), "{ppm} ppm: {most:?} us");
        }
    }

    #[test]
    fn stalled_robot_is_punctual_again_within_two_windows() {
        let found = lateness(0..1000, 0, |time| if time < 500 { 0 } else { 5000 });
        assert!(found[500..530].iter().all(|&late| late == 5000));
        assert!(found[564..].iter().all(|&late| late == 0));
    }

    #[test]
    fn numbers_that_no_robot_sends_do_no_harm() {
        let mut arrivals = Arrivals::default();
        let now = Instant::now();
        for time in [u64::MAX, 0, 7, u64::MAX, 3] {
            arrivals.note(time, now + Duration::from_secs(1 << 40));
        }
    }
}
