//! The sender's interface and the line that it feeds: first in, first out.

use std::ops::Range;
use std::time::Duration;

use super::conditions::{Conditions, Stalls};
use crate::noise::Random;

/// A line that carries one datagram at a time.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// `[bit/s]`
    rate: f64,
    /// When it has carried what it has been given.
    free: Duration,
    stalls: Option<Schedule>,
}

impl Line {
    pub(super) fn new(conditions: &Conditions, seed: u64) -> Self {
        Self {
            rate: conditions.rate,
            free: Duration::ZERO,
            stalls: conditions.stalls.map(|stalls| Schedule {
                stalls,
                random: Random::new(seed),
                next: None,
            }),
        }
    }

    /// When so many bytes that are there at `ready` have left.
    pub(super) fn carry(&mut self, ready: Duration, bytes: usize) -> Duration {
        let mut begin = ready.max(self.free);
        if let Some(schedule) = &mut self.stalls {
            begin = schedule.outlast(begin);
        }
        let takes = 8.0 * bytes as f64 / self.rate;
        self.free = begin + Duration::try_from_secs_f64(takes).unwrap_or_default();
        self.free
    }
}

/// When the stalls are.
#[derive(Debug, Clone)]
struct Schedule {
    stalls: Stalls,
    random: Random,
    /// The first that is not known to be over. The first of all is laid out from the first datagram
    /// on.
    next: Option<Range<Duration>>,
}

impl Schedule {
    /// The first moment from `time` on that is in no stall. Times given do not decrease.
    fn outlast(&mut self, time: Duration) -> Duration {
        let mut stall = match self.next.take() {
            Some(stall) => stall,
            None => self.after(time),
        };
        let mut free = time;
        while stall.start <= free {
            free = free.max(stall.end);
            stall = self.after(stall.end);
        }
        self.next = Some(stall);
        free
    }

    fn after(&mut self, end: Duration) -> Range<Duration> {
        // Exponentially distributed; the argument is in (0, 1].
        let share = -(1.0 - self.random.uniform()).ln();
        let pause = self.stalls.pause().as_secs_f64() * share;
        // Without any pause, the line would never be free again.
        let pause = Duration::try_from_secs_f64(pause).unwrap_or(FAR).min(FAR);
        let start = end + pause.max(Duration::from_nanos(1));
        start..start + self.stalls.quantile(self.random.uniform())
    }
}

/// A year: never, for a robot.
const FAR: Duration = Duration::from_secs(365 * 24 * 3600);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn datagrams_leave_one_after_the_other() {
        let conditions = Conditions {
            rate: 1e6,
            ..Conditions::default()
        };
        let mut line = Line::new(&conditions, 0);
        let ms = Duration::from_millis;
        assert_eq!(line.carry(ms(10), 125), ms(11));
        assert_eq!(line.carry(ms(10), 250), ms(13));
        assert_eq!(line.carry(ms(20), 125), ms(21));
        let mut instant = Line::new(&Conditions::default(), 0);
        assert_eq!(instant.carry(ms(10), 125), ms(10));
    }

    /// Sends something every 10 us, and finds when it did not leave.
    #[test]
    fn stalls_come_as_often_and_take_as_long_as_they_say() {
        let conditions = Conditions {
            stalls: Some(Stalls::FER),
            ..Conditions::default()
        };
        let mut line = Line::new(&conditions, 11);
        let step = Duration::from_micros(10);
        let mut stalls = Vec::new();
        let mut now = Duration::ZERO;
        let seconds = 300;
        while now < Duration::from_secs(seconds) {
            let left = line.carry(now, 0);
            if left > now {
                stalls.push(left - now);
                now = left;
            }
            now += step;
        }
        let rate = stalls.len() as f64 / seconds as f64;
        // Of 2100 independent events, the deviation is 2 %.
        assert!((rate - 7.0).abs() < 0.45, "{rate} /s");
        let shortest = stalls.iter().min().expect("some");
        let longest = stalls.iter().max().expect("some");
        assert!(*shortest > Stalls::FER.shortest - 2 * step, "{shortest:?}");
        assert!(*longest <= Stalls::FER.longest, "{longest:?}");
        let mean = stalls.iter().sum::<Duration>().as_secs_f64() / stalls.len() as f64;
        let expected = Stalls::FER.mean().as_secs_f64();
        assert!((mean - expected).abs() < 6e-5, "{mean} s for {expected} s");
    }

    #[test]
    fn stalls_without_a_pause_still_let_time_pass() {
        let conditions = Conditions {
            stalls: Some(Stalls {
                per_second: f64::INFINITY,
                ..Stalls::FER
            }),
            ..Conditions::default()
        };
        let mut line = Line::new(&conditions, 1);
        let left = line.carry(Duration::from_secs(1), 100);
        assert!(left < Duration::from_secs(2), "{left:?}");
    }
}
