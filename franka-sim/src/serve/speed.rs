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
        match speed {
            None => set.store(Duration::ZERO),
            Some(0.0) => set.store(PAUSED_PERIOD),
            Some(speed) if (Self::SPEED_MIN..=Self::SPEED_MAX).contains(&speed) => {
                set.store(PERIOD.div_f64(speed));
            }
            Some(got) => return Err(SpeedError::Range { got }),
        }
        Ok(())
    }

    /// Whether it runs in [virtual time](super::Sim::virtual_time), in which
    /// [`Self::set_speed`] can be called.
    pub fn is_in_virtual_time(&self) -> bool {
        self.speed.is_some()
    }
}

/// How long a millisecond of the robot lasts on the wall, in nanoseconds; 0 for no longer than it
/// takes. Clones are the same.
#[derive(Clone, Debug, Default)]
pub(super) struct Speed(Arc<AtomicU64>);

impl Speed {
    // Relaxed: it orders no other memory.
    fn store(&self, period: Duration) {
        let nanos = u64::try_from(period.as_nanos()).expect("less than a second");
        self.0.store(nanos, Ordering::Relaxed);
    }

    fn period(&self) -> Option<Duration> {
        let nanos = self.0.load(Ordering::Relaxed);
        (nanos > 0).then(|| Duration::from_nanos(nanos))
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
