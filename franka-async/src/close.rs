//! Reason for the end of a connection, known to all of its handles.

use std::sync::{Arc, OnceLock};

use franka_rt::lifecycle::CloseReason;

/// The reason for the end of one connection. All clones report the first reason that was noted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Closing(Arc<OnceLock<CloseReason>>);

impl Closing {
    /// Notes the reason, unless there is one already; returns the reason that counts.
    pub(crate) fn note(&self, reason: CloseReason) -> CloseReason {
        self.0.get_or_init(|| reason).clone()
    }

    /// Returns why the connection has ended. Without a reason noted, the tasks that would have
    /// noted one were dropped by their runtime.
    pub(crate) fn reason(&self) -> CloseReason {
        self.0.get().cloned().unwrap_or(CloseReason::RuntimeEnded)
    }
}
