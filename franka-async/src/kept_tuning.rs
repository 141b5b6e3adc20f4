//! Tuning of a session, shared with the task that accepts changes.

use std::sync::{Arc, Mutex, PoisonError};

use franka_rt::lifecycle::Tuning;

/// Tuning of a session for its later goals. Clones share the tuning.
#[derive(Clone, Debug)]
pub(crate) struct KeptTuning(Arc<Mutex<Tuning>>);

impl KeptTuning {
    pub(crate) fn new(tuning: Tuning) -> Self {
        Self(Arc::new(Mutex::new(tuning)))
    }

    pub(crate) fn get(&self) -> Tuning {
        // Nothing can panic while the lock is held.
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Applies these changes and keeps everything else.
    pub(crate) fn change(&self, changes: Tuning) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *kept = changes.or(*kept);
    }
}
