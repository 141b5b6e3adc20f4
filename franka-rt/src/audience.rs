//! Whether anybody wants to hear of every state.
//!
//! Ringing for each state wakes a task of the async world a thousand times a second, which takes
//! about one percent of a processor, half of it on the thread. Whoever only looks at the newest
//! state now and then need not be woken for that. So listeners enter, and the thread rings for
//! every state while somebody is there, and now and then otherwise.

#[cfg(loom)]
use loom::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
#[cfg(not(loom))]
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

/// One audience, somebody in it at first. Clones are the same one.
///
/// Who is there is counted elsewhere, by the listeners of a channel for instance: this is only what
/// the thread reads.
#[derive(Clone, Debug)]
pub struct Audience(Arc<AtomicBool>);

impl Default for Audience {
    fn default() -> Self {
        Self(Arc::new(AtomicBool::new(true)))
    }
}

impl Audience {
    /// Says that somebody is there, who has been counted before this call.
    pub fn enter(&self) {
        // Release, with the Acquire in `leave`: who undoes this sees the count.
        self.0.swap(true, Ordering::AcqRel);
    }

    /// Says that nobody is there, unless `is_there` finds somebody who has entered meanwhile. For
    /// one thread only.
    pub fn leave(&self, is_there: impl Fn() -> bool) {
        if is_there() {
            return;
        }
        self.0.swap(false, Ordering::AcqRel);
        if is_there() {
            self.enter();
        }
    }

    /// Whether to ring for every state.
    pub fn is_there(&self) -> bool {
        // Relaxed: nothing else is read on the strength of it. Who enters is heard of one state
        // later at worst.
        self.0.load(Ordering::Relaxed)
    }
}
