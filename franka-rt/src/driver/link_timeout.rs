//! Longest silence of a robot; `Driver::on_silence` then ends the motion. Late states are handled
//! in `exchange` (overtaken states) and `stats::arrivals`.

use core::time::Duration;

/// Default silence of the robot after which the link counts as lost.
///
/// Source: the UDP receive timeout of libfranka, `network.h`.
pub const LINK_TIMEOUT: Duration = Duration::from_secs(1);

/// Silence of the robot after which the link counts as lost, between [`Self::MIN`] and
/// [`Self::MAX`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LinkTimeout(Duration);

impl LinkTimeout {
    /// 20 ms: a robot that misses as many commands in a row stops on its own. It bridges shorter
    /// gaps.
    pub const MIN: Duration = Duration::from_millis(20);

    /// 10 s. A timeout of more than [`LINK_TIMEOUT`] is for a simulated robot on a busy host, which
    /// delays states for longer. A silent real robot has stopped on its own long before.
    pub const MAX: Duration = Duration::from_secs(10);

    /// Returns a timeout of this length.
    ///
    /// # Errors
    /// [`LinkTimeoutError`] for a length out of range.
    pub fn new(timeout: Duration) -> Result<Self, LinkTimeoutError> {
        if (Self::MIN..=Self::MAX).contains(&timeout) {
            Ok(Self(timeout))
        } else {
            Err(LinkTimeoutError { got: timeout })
        }
    }

    /// Returns the length of the silence.
    pub fn get(self) -> Duration {
        self.0
    }
}

impl Default for LinkTimeout {
    /// Returns [`LINK_TIMEOUT`].
    fn default() -> Self {
        Self(LINK_TIMEOUT)
    }
}

/// Caller: the timeout is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the link timeout is {got:?}, expected {:?} to {:?}",
    LinkTimeout::MIN,
    LinkTimeout::MAX
)]
pub struct LinkTimeoutError {
    /// Timeout that was given.
    pub got: Duration,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn link_timeout_out_of_range_is_refused_with_the_range() {
        for (us, accepted) in [
            (0, false),
            (19_999, false),
            (20_000, true),
            (150_000, true),
            (10_000_000, true),
            (10_000_001, false),
        ] {
            let timeout = Duration::from_micros(us);
            let made = LinkTimeout::new(timeout);
            assert_eq!(made.is_ok(), accepted, "{timeout:?}");
            match made {
                Ok(made) => assert_eq!(made.get(), timeout),
                Err(error) => assert_eq!(error.got, timeout),
            }
        }
        let error = LinkTimeout::new(Duration::from_millis(5)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the link timeout is 5ms, expected 20ms to 10s"
        );
    }
}
