//! Flag whether the thread sends a wake-up for every state.
//!
//! A wake-up per state runs a task of the async world a thousand times a second, which takes about
//! one percent of a processor, half of it on the thread. A program that only looks at the newest
//! state now and then does not need them. So listeners to every state request them, and without a
//! request the thread sends one for every fiftieth state.

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

/// True if any subscriber needs a wake-up per state; initially true. Clones are the same flag.
///
/// The subscribers are counted elsewhere, by a channel for instance: this is only the flag that the
/// thread reads.
#[derive(Clone, Debug)]
pub struct StateWakeups(Arc<AtomicBool>);

impl Default for StateWakeups {
    fn default() -> Self {
        Self(Arc::new(AtomicBool::new(true)))
    }
}

impl StateWakeups {
    /// Requests wake-ups, for a subscriber that has been counted before this call.
    pub fn request(&self) {
        // Release, with the Acquire in `release`: the thread that undoes this sees the count.
        self.0.swap(true, Ordering::AcqRel);
    }

    /// Ends the wake-ups, unless `are_wanted` finds a subscriber, even a new one. For one thread
    /// only.
    pub fn release(&self, are_wanted: impl Fn() -> bool) {
        if are_wanted() {
            return;
        }
        self.0.swap(false, Ordering::AcqRel);
        if are_wanted() {
            self.request();
        }
    }

    /// True to send a wake-up for every state.
    pub fn are_wanted(&self) -> bool {
        // Relaxed: nothing else is read because of it. A request takes effect one state later at
        // worst.
        self.0.load(Ordering::Relaxed)
    }
}
