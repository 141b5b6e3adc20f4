//! The two flags between the thread and its owner.
//!
//! Nothing here knows the thread: `tests/loom.rs` includes this file and explores what the flags
//! order.

#[cfg(not(loom))]
use std::sync::atomic::{AtomicBool, Ordering};

#[cfg(loom)]
use loom::sync::atomic::{AtomicBool, Ordering};

/// Whether the thread is to stop, and whether it has ended.
#[derive(Debug, Default)]
pub(super) struct Lifetime {
    stop: AtomicBool,
    ended: AtomicBool,
}

impl Lifetime {
    /// Relaxed here and in [`Self::stop_wanted`]: nothing else is read on the strength of this
    /// flag.
    pub(super) fn ask_to_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(super) fn stop_wanted(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Release, pairs with the Acquire in [`Self::has_ended`]: who sees the end sees what the
    /// thread left.
    pub(super) fn note_end(&self) {
        self.ended.store(true, Ordering::Release);
    }

    pub(super) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }
}
