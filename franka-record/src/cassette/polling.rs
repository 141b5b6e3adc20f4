//! Sockets whose threads check periodically for a stop.

use std::io;
use std::time::Duration;

/// Interval at which threads check for a stop.
pub(super) const TICK: Duration = Duration::from_millis(20);

/// True if no data arrived within the socket's timeout.
pub(super) fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
