//! Recorded cycles and their times.

use core::fmt;
use core::ops::{Add, Sub};
use core::time::Duration;
use std::time::{SystemTime, UNIX_EPOCH};

use franka_proto::RobotState;
use franka_rt::driver::Record;
use nalgebra::Isometry3;

/// A time on this host, in nanoseconds since 1970.
///
/// Within one recording, the time starts with the wall clock at the beginning of the recording and
/// never decreases. Later changes of the wall clock have no effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HostTime(u64);

impl HostTime {
    /// Creates the time that is `nanos` nanoseconds after the start of 1970.
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos)
    }

    /// Returns the current time of this host's wall clock. If the clock is set to a time before
    /// 1970, returns the start of 1970.
    pub fn now() -> Self {
        Self::from(SystemTime::now())
    }

    /// Returns the number of nanoseconds since the start of 1970.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// Returns the duration from `earlier` to `self`; zero if `earlier` is later than `self`.
    pub fn since(self, earlier: Self) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }
}

impl From<SystemTime> for HostTime {
    fn from(time: SystemTime) -> Self {
        let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
        Self(u64::try_from(since.as_nanos()).unwrap_or(u64::MAX))
    }
}

impl From<HostTime> for SystemTime {
    fn from(time: HostTime) -> Self {
        UNIX_EPOCH + Duration::from_nanos(time.0)
    }
}

impl Add<Duration> for HostTime {
    type Output = Self;

    /// Saturates at the latest possible time.
    fn add(self, duration: Duration) -> Self {
        let nanos = u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        Self(self.0.saturating_add(nanos))
    }
}

impl Sub<Duration> for HostTime {
    type Output = Self;

    /// Saturates at the start of 1970.
    fn sub(self, duration: Duration) -> Self {
        let nanos = u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        Self(self.0.saturating_sub(nanos))
    }
}

impl fmt::Display for HostTime {
    /// Formats the time in UTC with milliseconds, for example `2026-03-01T12:00:00.000Z`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.0 / 1_000_000_000;
        let (year, month, day) = date(seconds / 86_400);
        let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
        let millis = self.0 / 1_000_000 % 1000;
        write!(
            f,
            "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{millis:03}Z"
        )
    }
}

/// Returns the Gregorian year, month and day that is `days` after 1970-01-01.
fn date(days: u64) -> (u64, u64, u64) {
    // Counts from 1 March of year 0, so that a leap day is the last day of its year.
    let days = days + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    (year, month, day)
}

/// One cycle: a state of the robot, and the driver's record of the cycle.
///
/// Numbers that were read from a file have the precision of an `f32`. Only times and measured joint
/// positions keep their full precision. The fields `K_F_ext_hat_K` and `elbow` are computed from
/// other fields.
///
/// Some fields are not recorded and have their default values: `dtau_J`, `theta`, `dtheta`, the
/// accelerometers, `O_ddP_O`, and the commanded quantities of Cartesian motions (`O_T_EE_c`,
/// `elbow_c` and so on). A recorded pose that is not a rigid transformation becomes the identity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// Time at which this host received the state.
    pub time: HostTime,
    /// The driver's record of the cycle.
    pub record: Record,
    /// State to which the driver replied in this cycle.
    pub state: RobotState,
    /// Pose of the end effector at the reference joint positions, in the base frame; `None` outside
    /// target control. A recorder computes this pose if it is `None`.
    pub reference: Option<Isometry3<f64>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_written_in_utc() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_400, "2000-02-29T00:00:00.000Z"),
            (1_709_210_096, "2024-02-29T12:34:56.000Z"),
            (1_735_689_599, "2024-12-31T23:59:59.000Z"),
            (4_107_542_400, "2100-03-01T00:00:00.000Z"),
        ] {
            let time = HostTime::from_nanos(seconds * 1_000_000_000);
            assert_eq!(time.to_string(), text);
        }
    }

    #[test]
    fn times_end_where_their_numbers_do() {
        let first = HostTime::default();
        let last = HostTime::from_nanos(u64::MAX);
        assert_eq!(first - Duration::MAX, first);
        assert_eq!(first + Duration::MAX, last);
        assert_eq!(first.since(last), Duration::ZERO);
        assert_eq!(HostTime::from(SystemTime::from(last)), last);
    }
}
