//! The reason why a connection ended, which all its handles know.

use std::sync::{Arc, OnceLock};

use franka_rt::lifecycle::CloseReason;

/// The reason why one connection ended. All clones report the first reason that was noted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Closing(Arc<OnceLock<CloseReason>>);

impl Closing {
    /// Stores the reason, unless there is an earlier one; returns the first reason.
    pub(crate) fn note(&self, reason: CloseReason) -> CloseReason {
        self.0.get_or_init(|| reason).clone()
    }

    /// Returns the reason why the connection ended. If no reason was noted, the runtime has dropped
    /// the tasks that would have noted one.
    pub(crate) fn reason(&self) -> CloseReason {
        self.0.get().cloned().unwrap_or(CloseReason::RuntimeEnded)
    }
}
