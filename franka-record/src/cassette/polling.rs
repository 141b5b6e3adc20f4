//! Sockets whose threads look now and then whether to stop.

use std::io;
use std::time::Duration;

/// How often threads look whether to stop.
pub(super) const TICK: Duration = Duration::from_millis(20);

/// True if nothing came within the time that a socket waits.
pub(super) fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
