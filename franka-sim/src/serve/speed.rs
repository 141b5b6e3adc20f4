//! How fast robot time passes in virtual time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::Running;
use super::clock::PERIOD;

/// A millisecond of the robot while it is paused, on the wall. Clients take a second without a
/// state for a lost connection.
const PAUSED_PERIOD: Duration = Duration::from_millis(400);

/// The longest sleep: a speed that is set takes effect after that.
const LOOK: Duration = Duration::from_millis(10);

/// By how much robot time may be behind its speed and still catch up.
const BEHIND_MAX: Duration = Duration::from_millis(20);

/// Why the speed of robot time was not set.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpeedError {
    /// Robot time passes with the clock on the wall.
    #[error(
        "the simulated robot keeps to the clock on the wall: it was not started in virtual time"
    )]
    WallClock,
    /// The speed is not possible.
    #[error(
        "a speed of {got} was asked for; possible are 0, a pause, and {} to {}",
        Running::SPEED_MIN,
        Running::SPEED_MAX
    )]
    Range {
        /// What was asked for.
        got: f64,
    },
}

impl Running {
    /// The slowest that robot time can pass, but for a pause.
    pub const SPEED_MIN: f64 = 0.01;

    /// The fastest that robot time can be asked to pass, other than as fast as it can.
    pub const SPEED_MAX: f64 = 10.0;

    /// In [virtual time](super::Sim::virtual_time), has robot time pass `speed` times as fast as
    /// the clock on the wall, as far as host and client keep up; `None`, as at the start, has it
    /// pass as fast as the client answers. 0 is a pause: there is a millisecond of the robot every
    /// 400 ms, so that no client takes the silence for a lost connection.
    ///
    /// # Errors
    /// [`SpeedError`]: the speed is as before.
    pub fn set_speed(&self, speed: Option<f64>) -> Result<(), SpeedError> {
        let set = self.speed.as_ref().ok_or(SpeedError::WallClock)?;
        let possible = Self::SPEED_MIN..=Self::SPEED_MAX;
        if let Some(got) = speed.filter(|speed| *speed != 0.0 && !possible.contains(speed)) {
            return Err(SpeedError::Range { got });
        }
        set.set(speed);
        Ok(())
    }

    /// The speed that was [set](Self::set_speed).
    pub fn speed(&self) -> Option<f64> {
        self.speed.as_ref().and_then(Speed::get)
    }

    /// True if it runs in [virtual time](super::Sim::virtual_time), in which
    /// [`Self::set_speed`] can be called.
    pub fn is_in_virtual_time(&self) -> bool {
        self.speed.is_some()
    }
}

/// The bits of the speed; infinite for as fast as the client answers. Clones are the same.
#[derive(Clone, Debug)]
pub(super) struct Speed(Arc<AtomicU64>);

impl Default for Speed {
    fn default() -> Self {
        Self(Arc::new(AtomicU64::new(f64::INFINITY.to_bits())))
    }
}

impl Speed {
    // Relaxed: it orders no other memory.
    fn set(&self, speed: Option<f64>) {
        let bits = speed.unwrap_or(f64::INFINITY).to_bits();
        self.0.store(bits, Ordering::Relaxed);
    }

    fn get(&self) -> Option<f64> {
        let speed = f64::from_bits(self.0.load(Ordering::Relaxed));
        speed.is_finite().then_some(speed)
    }

    /// How long a millisecond of the robot lasts on the wall; `None` for no longer than it takes.
    fn period(&self) -> Option<Duration> {
        self.get().map(|speed| match speed {
            0.0 => PAUSED_PERIOD,
            _ => PERIOD.div_f64(speed),
        })
    }
}

/// Keeps robot time to its speed.
pub(super) struct Pacer {
    speed: Speed,
    /// When the present millisecond of the robot began, or should have.
    begun: Instant,
}

impl Pacer {
    pub(super) fn new(speed: Speed) -> Self {
        let begun = Instant::now();
        Self { speed, begun }
    }

    /// Sleeps until the next millisecond of the robot is due. False, at once, if that is as soon as
    /// the client has answered.
    pub(super) fn wait(&mut self) -> bool {
        loop {
            let now = Instant::now();
            let Some(period) = self.speed.period() else {
                self.begun = now;
                return false;
            };
            let due = self.begun + period;
            match due.checked_duration_since(now) {
                Some(left) if !left.is_zero() => std::thread::sleep(left.min(LOOK)),
                _ => {
                    self.begun = due.max(now - BEHIND_MAX);
                    return true;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serve::Sim;
    use crate::serve::tests::{SOON, robot_time, runtime};

    #[test]
    fn in_virtual_time_the_speed_is_set_and_a_pause_ends() {
        runtime().block_on(async {
            let sim = Sim::fr3()
                .virtual_time(SOON)
                .start()
                .await
                .expect("a robot");
            for (speed, period) in [(0.1, 10), (0.0, 400)] {
                sim.set_speed(Some(speed)).expect("virtual time");
                assert_eq!(sim.speed(), Some(speed));
                // What was asked for while it slept may take the speed before.
                robot_time(&sim, 1).await;
                let begun = Instant::now();
                let first = sim.state().await.expect("running").message_id;
                tokio::time::sleep(Duration::from_millis(300)).await;
                let passed = sim.state().await.expect("running").message_id - first;
                // A busy machine has less time pass; some is made up for.
                let most = begun.elapsed().as_millis() / period + 5;
                assert!(u128::from(passed) <= most, "{speed}: {passed} > {most}");
            }
            for got in [-1.0, 0.001, 11.0, f64::INFINITY] {
                assert_eq!(sim.set_speed(Some(got)), Err(SpeedError::Range { got }));
            }
            assert!(sim.set_speed(Some(f64::NAN)).is_err());
            sim.set_speed(None).expect("virtual time");
            robot_time(&sim, 500).await;
            sim.stop().await;

            let sim = Sim::fr3().start().await.expect("a robot");
            assert!(!sim.is_in_virtual_time());
            assert_eq!(sim.set_speed(Some(0.1)), Err(SpeedError::WallClock));
            sim.stop().await;
        });
    }
}
