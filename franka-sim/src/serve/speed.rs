//! Speed of robot time in virtual time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::Running;
use super::clock::PERIOD;

/// Wall-clock duration of one robot millisecond while the robot is paused. Clients consider a
/// connection lost after a second without a state.
const PAUSED_PERIOD: Duration = Duration::from_millis(400);

/// Longest sleep. A new speed takes effect within this time.
const LOOK: Duration = Duration::from_millis(10);

/// Longest delay of robot time that the simulator still makes up for.
const BEHIND_MAX: Duration = Duration::from_millis(20);

/// Reason why the speed of robot time was not set.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpeedError {
    /// Robot time follows the wall clock, because the robot was not started in virtual time.
    #[error(
        "the simulated robot runs in wall-clock time, expected virtual time: start it with \
         virtual time to change its speed"
    )]
    WallClock,
    /// The requested speed is neither 0 nor in the range of possible speeds.
    #[error(
        "the speed is {got}, expected 0 (a pause) or {} to {}",
        Running::SPEED_MIN,
        Running::SPEED_MAX
    )]
    Range {
        /// The requested speed.
        got: f64,
    },
}

impl Running {
    /// Slowest speed of robot time except a pause, as a multiple of the wall clock's speed.
    pub const SPEED_MIN: f64 = 0.01;

    /// Fastest speed of robot time that can be set, as a multiple of the wall clock's speed.
    /// Without a set speed, robot time may be faster.
    pub const SPEED_MAX: f64 = 10.0;

    /// Sets the speed of robot time in [virtual time](super::Sim::virtual_time), as a multiple of
    /// the wall clock's speed. A slow host or client may not reach it. With `None`, the default,
    /// robot time advances as fast as the client answers. A speed of 0 is a pause: each millisecond
    /// of the robot then lasts 400 ms, because clients would consider a silent connection lost.
    ///
    /// # Errors
    /// Returns [`SpeedError`] without virtual time, or if `speed` is out of range. The speed is
    /// then unchanged.
    pub fn set_speed(&self, speed: Option<f64>) -> Result<(), SpeedError> {
        let set = self.speed.as_ref().ok_or(SpeedError::WallClock)?;
        let possible = Self::SPEED_MIN..=Self::SPEED_MAX;
        if let Some(got) = speed.filter(|speed| *speed != 0.0 && !possible.contains(speed)) {
            return Err(SpeedError::Range { got });
        }
        set.set(speed);
        Ok(())
    }

    /// Returns the speed that was [set](Self::set_speed), if any.
    pub fn speed(&self) -> Option<f64> {
        self.speed.as_ref().and_then(Speed::get)
    }

    /// Returns true if the robot runs in [virtual time](super::Sim::virtual_time), in which
    /// [`Self::set_speed`] can be called.
    pub fn is_in_virtual_time(&self) -> bool {
        self.speed.is_some()
    }
}

/// Bits of the speed. Infinity means as fast as the client answers. Clones share the value.
#[derive(Clone, Debug)]
pub(super) struct Speed(Arc<AtomicU64>);

impl Default for Speed {
    fn default() -> Self {
        Self(Arc::new(AtomicU64::new(f64::INFINITY.to_bits())))
    }
}

impl Speed {
    // Relaxed ordering is enough, because the value orders no other memory.
    fn set(&self, speed: Option<f64>) {
        let bits = speed.unwrap_or(f64::INFINITY).to_bits();
        self.0.store(bits, Ordering::Relaxed);
    }

    fn get(&self) -> Option<f64> {
        let speed = f64::from_bits(self.0.load(Ordering::Relaxed));
        speed.is_finite().then_some(speed)
    }

    /// Returns how long a millisecond of the robot lasts on the wall clock; `None` for no lower
    /// bound.
    fn period(&self) -> Option<Duration> {
        self.get().map(|speed| match speed {
            0.0 => PAUSED_PERIOD,
            _ => PERIOD.div_f64(speed),
        })
    }
}

/// Makes robot time advance at its set speed.
pub(super) struct Pacer {
    speed: Speed,
    /// Time at which the current millisecond of the robot began, or should have begun.
    begun: Instant,
}

impl Pacer {
    pub(super) fn new(speed: Speed) -> Self {
        let begun = Instant::now();
        Self { speed, begun }
    }

    /// Sleeps until the next millisecond of the robot is due. Returns false immediately if no speed
    /// is set, because the next millisecond then begins when the client has answered.
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
                // The robot may still run at the previous speed if the request comes during a
                // sleep.
                robot_time(&sim, 1).await;
                let begun = Instant::now();
                let first = sim.state().await.expect("running").message_id;
                tokio::time::sleep(Duration::from_millis(300)).await;
                let passed = sim.state().await.expect("running").message_id - first;
                // On a busy machine, less robot time passes. The simulator makes up for part of the
                // lost time.
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
