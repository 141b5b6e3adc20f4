//! Ctrl-C and SIGTERM.

use std::fmt;
use std::future::Future;

use tokio::signal::unix::{SignalKind, signal};

use crate::ending::{Ending, Failure};

/// A signal that ends the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interruption {
    CtrlC,
    /// SIGTERM, which `kill` and service managers send.
    Terminated,
}

impl Interruption {
    /// Returns the failure for a program that was interrupted before it had finished.
    pub(crate) fn failure(self, message: &str) -> Failure {
        let ending = match self {
            Self::CtrlC => Ending::Interrupted,
            Self::Terminated => Ending::Terminated,
        };
        Failure::new(ending, message)
    }
}

impl fmt::Display for Interruption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::CtrlC => "Ctrl-C",
            Self::Terminated => "SIGTERM",
        })
    }
}

/// Returns a future that resolves at the first ending signal after this call.
pub(crate) fn interrupted() -> std::io::Result<impl Future<Output = Interruption>> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    Ok(async move {
        tokio::select! {
            _ = interrupt.recv() => Interruption::CtrlC,
            _ = terminate.recv() => Interruption::Terminated,
        }
    })
}
