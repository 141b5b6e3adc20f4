//! Reason for the end of a connection, known to all of its handles.

use std::sync::{Arc, OnceLock};

use franka_rt::lifecycle::CloseReason;

/// The reason for the end of one connection. All clones report the first reason that was noted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Closing(Arc<OnceLock<CloseReason>>);

impl Closing {
    /// Notes the reason, unless an earlier one is there; returns the first reason.
    pub(crate) fn note(&self, reason: CloseReason) -> CloseReason {
        self.0.get_or_init(|| reason).clone()
    }

    /// Returns the reason for the end of the connection. If no reason was noted, the runtime has
    /// dropped the tasks that would have noted one.
    pub(crate) fn reason(&self) -> CloseReason {
        self.0.get().cloned().unwrap_or(CloseReason::RuntimeEnded)
    }
}
