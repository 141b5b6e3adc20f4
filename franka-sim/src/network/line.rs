//! The sender's interface and the line that it feeds: datagrams leave in the order in which they
//! came.

use std::time::Duration;

use super::conditions::{Conditions, Stalls};
use crate::noise::Random;

/// A line that carries one datagram at a time.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// Rate of the line, `[bit/s]`.
    rate: f64,
    /// Time at which the line is free again.
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

    /// Returns the time at which `bytes` have left, if they are ready at `ready`.
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

#[derive(Debug, Clone)]
struct Schedule {
    stalls: Stalls,
    random: Random,
    /// `None` until the first datagram.
    next: Option<Next>,
}

#[derive(Debug, Clone)]
struct Next {
    /// A multiple of the period.
    grid: Duration,
    near_grid: Duration,
    elsewhere: Duration,
}

impl Schedule {
    /// Returns the first moment at or after `time` that is in no stall. Successive times must not
    /// decrease.
    fn outlast(&mut self, time: Duration) -> Duration {
        let mut next = match self.next.take() {
            Some(next) => next,
            None => {
                let grid = time + self.stalls.period.mul_f64(self.random.uniform());
                let (grid, near_grid) = self.on_grid_after(grid);
                Next {
                    grid,
                    near_grid,
                    elsewhere: self.elsewhere_after(time),
                }
            }
        };
        let mut free = time;
        loop {
            let start = next.near_grid.min(next.elsewhere);
            if start > free {
                self.next = Some(next);
                return free;
            }
            if self.random.uniform() >= self.stalls.single {
                free = free.max(start + self.stalls.quantile(self.random.uniform()));
            } else if time - start.min(time) < RECENT {
                free += LATE_LEAST + LATE_LEAST.mul_f64(self.random.uniform());
            }
            if start == next.near_grid {
                (next.grid, next.near_grid) = self.on_grid_after(next.grid);
            } else {
                next.elsewhere = self.elsewhere_after(free);
            }
        }
    }

    /// Returns the first multiple of the period after `grid` that has a stall nearby, and the start
    /// of this stall.
    fn on_grid_after(&mut self, mut grid: Duration) -> (Duration, Duration) {
        let (period, share) = (self.stalls.period, self.stalls.on_grid());
        if share <= 0.0 {
            return (grid, FAR);
        }
        loop {
            grid += period;
            if self.random.uniform() < share {
                // Not later than the stall near the next multiple.
                let most = 0.25 * period.as_secs_f64();
                let off = (SPREAD.as_secs_f64() * self.random.normal()).clamp(-most, most);
                let near = grid.as_secs_f64() + off;
                return (grid, Duration::try_from_secs_f64(near).unwrap_or(grid));
            }
        }
    }

    fn elsewhere_after(&mut self, end: Duration) -> Duration {
        // The value is exponentially distributed. The argument of the logarithm is in (0, 1].
        let share = -(1.0 - self.random.uniform()).ln();
        let pause = self.stalls.pause().as_secs_f64() * share;
        // Without any pause between stalls, the line would never be free again.
        let pause = Duration::try_from_secs_f64(pause).unwrap_or(FAR).min(FAR);
        end + pause.max(Duration::from_nanos(1))
    }
}

/// Standard deviation of the distance between a stall and its multiple of the period.
const SPREAD: Duration = Duration::from_millis(6);

/// The shortest delay of a single datagram; the longest is twice that.
const LATE_LEAST: Duration = Duration::from_micros(500);

/// Time after which a stall of a single datagram is discarded if no datagram comes.
const RECENT: Duration = Duration::from_millis(2);

/// One year. It means never.
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

    /// Sends a datagram every 10 us. Returns the start and the duration of each interval in which
    /// no datagram left.
    fn stalls(stalls: Stalls, seconds: u64) -> Vec<(Duration, Duration)> {
        let conditions = Conditions {
            stalls: Some(stalls),
            ..Conditions::default()
        };
        let mut line = Line::new(&conditions, 11);
        let step = Duration::from_micros(10);
        let mut found = Vec::new();
        let mut now = Duration::ZERO;
        while now < Duration::from_secs(seconds) {
            let left = line.carry(now, 0);
            if left > now {
                found.push((now, left - now));
                now = left;
            }
            now += step;
        }
        found
    }

    #[test]
    fn stalls_come_as_often_and_take_as_long_as_they_say() {
        let partly_single = Stalls {
            single: 0.4,
            ..Stalls::FER
        };
        let found = stalls(partly_single, 300);
        let rate = found.len() as f64 / 300.0;
        // The deviation for 2100 independent events is 2 %.
        assert!((rate - 7.0).abs() < 0.45, "{rate} /s");
        let step = Duration::from_micros(20);
        let (bursts, single): (Vec<_>, Vec<_>) = found
            .iter()
            .map(|(_, length)| *length)
            .partition(|length| *length > Stalls::FER.shortest - step);
        let share = single.len() as f64 / found.len() as f64;
        assert!((share - 0.4).abs() < 0.04, "{share}");
        assert!(single.iter().all(|late| *late <= 2 * LATE_LEAST));
        let longest = bursts.iter().max().expect("some");
        assert!(*longest <= Stalls::FER.longest + step, "{longest:?}");
        let mean = bursts.iter().sum::<Duration>().as_secs_f64() / bursts.len() as f64;
        let expected = Stalls::FER.mean().as_secs_f64();
        assert!((mean - expected).abs() < 8e-5, "{mean} s for {expected} s");
    }

    /// Figures of a capture on a robot: Rayleigh 0.70 at 101 ms, where independent stalls have less
    /// than 0.1, and 46 % of the intervals within 8 ms of a multiple of 100 ms.
    #[test]
    fn stalls_of_an_fer_come_on_its_grid() {
        let rayleigh = |found: &[(Duration, Duration)]| {
            let (mut x, mut y) = (0.0, 0.0);
            for (start, _) in found {
                let phase = core::f64::consts::TAU * start.as_secs_f64() / 0.101;
                (x, y) = (x + phase.cos(), y + phase.sin());
            }
            f64::hypot(x, y) / found.len() as f64
        };
        let found = stalls(Stalls::FER, 100);
        let on_grid = rayleigh(&found);
        assert!((0.6..0.8).contains(&on_grid), "{on_grid}");
        let near = |pair: &[(Duration, Duration)]| {
            let share = (pair[1].0 - pair[0].0).as_secs_f64() / 0.1;
            (share - share.round()).abs() < 0.08 && share > 0.5
        };
        let near = found.windows(2).filter(|pair| near(pair)).count();
        let near = near as f64 / (found.len() - 1) as f64;
        assert!((0.36..0.56).contains(&near), "{near}");
        let independent = Stalls {
            period: Duration::ZERO,
            ..Stalls::FER
        };
        assert!(rayleigh(&stalls(independent, 100)) < 0.1);
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
