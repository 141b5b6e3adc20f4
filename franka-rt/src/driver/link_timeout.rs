//! Longest silence of a robot before `Driver::on_silence` ends the motion. Other modules handle
//! late states: `exchange` the overtaken ones, `stats::lateness` the delays.

use core::time::Duration;

/// Default time without states after which the link counts as lost.
///
/// Source: the UDP receive timeout of libfranka, `network.h`.
pub const LINK_TIMEOUT: Duration = Duration::from_secs(1);

/// Time without states after which the link counts as lost, between [`Self::MIN`] and
/// [`Self::MAX`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LinkTimeout(Duration);

impl LinkTimeout {
    /// Shortest timeout, 20 ms. If commands are missing for this long, the robot stops on its own;
    /// it bridges shorter gaps.
    pub const MIN: Duration = Duration::from_millis(20);

    /// Longest timeout, 10 s. A timeout above [`LINK_TIMEOUT`] is only useful for a simulated robot
    /// on a busy host, where a state may arrive more than a second late. A real robot that receives
    /// no commands stops on its own after about [`Self::MIN`].
    pub const MAX: Duration = Duration::from_secs(10);

    /// Returns a link timeout with the duration `timeout`.
    ///
    /// # Errors
    /// Returns [`LinkTimeoutError`] if `timeout` is not between [`Self::MIN`] and [`Self::MAX`].
    pub fn new(timeout: Duration) -> Result<Self, LinkTimeoutError> {
        if (Self::MIN..=Self::MAX).contains(&timeout) {
            Ok(Self(timeout))
        } else {
            Err(LinkTimeoutError { got: timeout })
        }
    }

    /// Returns the duration of the timeout.
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
    /// The timeout that was given.
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
