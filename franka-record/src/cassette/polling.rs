//! Sockets whose threads check at intervals whether they must stop.

use std::io;
use std::time::Duration;

/// Interval at which threads check whether they must stop.
pub(super) const TICK: Duration = Duration::from_millis(20);

/// Returns true if no data arrived within the socket's timeout.
pub(super) fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
