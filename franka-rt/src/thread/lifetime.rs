//! Flags that the thread and its owner share.
//!
//! This file does not depend on the thread, because `tests/loom` includes it and explores the order
//! of the flags.

#[cfg(not(loom))]
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

#[cfg(loom)]
use loom::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Three flags: a stop is requested, the thread has ended, or the borrower does not run the cycle.
#[derive(Debug, Default)]
pub(super) struct Lifetime {
    stop: AtomicBool,
    ended: AtomicBool,
    turns: AtomicU64,
    stalled: AtomicBool,
}

impl Lifetime {
    /// Requests a stop. Relaxed here and in [`Self::stop_wanted`], because no other memory is read
    /// depending on this flag.
    pub(super) fn ask_to_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(super) fn stop_wanted(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Notes the end of the thread. Release, pairs with the Acquire in [`Self::has_ended`]: a
    /// reader that sees the end also sees the thread's last writes.
    pub(super) fn note_end(&self) {
        self.ended.store(true, Ordering::Release);
    }

    pub(super) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }

    /// Counts a turn of a borrower, which ends a stall. A load and a store are enough, because
    /// there is only one borrower at a time. Relaxed here and below, because no other memory is
    /// read depending on these values.
    pub(super) fn note_turn(&self) {
        let turns = self.turns.load(Ordering::Relaxed);
        self.turns.store(turns.wrapping_add(1), Ordering::Relaxed);
        self.stalled.store(false, Ordering::Relaxed);
    }

    pub(super) fn turns(&self) -> u64 {
        self.turns.load(Ordering::Relaxed)
    }

    /// Sets whether the borrower has stalled. Returns true if this is a change.
    pub(super) fn set_stalled(&self, stalled: bool) -> bool {
        self.stalled.swap(stalled, Ordering::Relaxed) != stalled
    }

    pub(super) fn is_stalled(&self) -> bool {
        self.stalled.load(Ordering::Relaxed)
    }
}
