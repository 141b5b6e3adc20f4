//! Where a recorder takes from what it writes.

use core::time::Duration;
use std::time::Instant;

use crate::{Cycle, Event, GripperState, HostTime};

/// Where a recorder takes from what it writes: a robot, a simulation, another recording. The thread
/// of the recorder calls it.
pub trait Source: Send + 'static {
    /// The next item. Blocks for up to `timeout` while there is none.
    ///
    /// Items of one kind come in the order of their times; an event may come somewhat later than
    /// cycles after it. Cycles that were lost are told by an event
    /// ([`EventKind::Dropped`](crate::EventKind::Dropped)) before the next cycle, or at the end.
    /// Changes of the robot's mode and errors, and steps of the clock, are not: the recorder finds
    /// them in the cycles.
    fn next(&mut self, timeout: Duration) -> Next;
}

/// What a source has to give.
#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "most are cycles, and each is written at once"
)]
pub enum Next {
    /// One cycle.
    Cycle(Cycle),
    /// Something that happened.
    Event(Event),
    /// A state of a gripper.
    Gripper {
        /// When this host had it.
        time: HostTime,
        /// The state.
        state: GripperState,
    },
    /// Data that belongs to the recording as a whole: the robot's description, options.
    Attachment {
        /// Its name, as of a file: `robot.urdf`.
        name: String,
        /// Its media type: `application/xml`.
        media_type: String,
        /// The data.
        data: Vec<u8>,
    },
    /// Properties of what is recorded, by name: robot, versions, kernel.
    Metadata(Vec<(String, String)>),
    /// Nothing has come within the time.
    Nothing,
    /// Nothing will come any more.
    End,
}

/// Times of this host within one recording: the wall clock as it was at one moment, continued by
/// the monotonic clock.
#[derive(Clone, Copy, Debug)]
pub struct HostClock {
    wall: HostTime,
    monotonic: Instant,
}

impl HostClock {
    /// A clock that agrees with the wall clock now.
    pub fn start() -> Self {
        Self::agreeing(HostTime::now(), Instant::now())
    }

    /// A clock by which `monotonic` was at `wall`.
    pub fn agreeing(wall: HostTime, monotonic: Instant) -> Self {
        Self { wall, monotonic }
    }

    /// When a moment of the monotonic clock was.
    pub fn at(&self, moment: Instant) -> HostTime {
        match moment.checked_duration_since(self.monotonic) {
            Some(after) => self.wall + after,
            None => self.wall - self.monotonic.duration_since(moment),
        }
    }

    /// Now, by this clock.
    pub fn now(&self) -> HostTime {
        self.at(Instant::now())
    }

    /// By how much the wall clock is ahead of this one, `[ns]`, if it shows `wall` at `moment`:
    /// negative where it was set back.
    pub fn step(&self, wall: HostTime, moment: Instant) -> i64 {
        let ours = i128::from(self.at(moment).as_nanos());
        let ahead = i128::from(wall.as_nanos()) - ours;
        i64::try_from(ahead).unwrap_or(if ahead < 0 { i64::MIN } else { i64::MAX })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_clock_that_is_set_leaves_recorded_times_alone_and_is_noticed() {
        let (wall, begun) = (HostTime::from_nanos(5_000_000_000), Instant::now());
        let clock = HostClock::agreeing(wall, begun);
        let second = Duration::from_secs(1);
        let later = begun + second;
        assert_eq!(clock.at(later), wall + second);
        if let Some(earlier) = begun.checked_sub(second) {
            assert_eq!(clock.at(earlier), wall - second);
        }
        assert_eq!(clock.step(wall + second, later), 0);
        assert_eq!(clock.step(wall, later), -1_000_000_000);
        assert_eq!(clock.step(wall + 3 * second, later), 2_000_000_000);
        assert_eq!(clock.step(HostTime::from_nanos(u64::MAX), later), i64::MAX);
    }
}
