//! Ctrl-C.

use std::future::Future;

use tokio::signal::unix::{SignalKind, signal};

/// Returns what resolves when the program is told to end from now on: Ctrl-C, or SIGTERM.
pub(crate) fn interrupted() -> std::io::Result<impl Future<Output = ()>> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    Ok(async move {
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
        }
    })
}
