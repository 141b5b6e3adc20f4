//! Flag that makes the thread send a wake-up for every state.
//!
//! A wake-up per state runs a task of the async world a thousand times a second. This uses about
//! one percent of a processor, half of it on the thread. A program that only reads the newest state
//! now and then does not need these wake-ups. Listeners to every state request them. Without a
//! request the thread sends a wake-up for every fiftieth state.

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

/// True if any subscriber needs a wake-up per state; initially true. Clones share the flag.
///
/// The subscribers are counted elsewhere, for example by a channel; the thread reads only this
/// flag.
#[derive(Clone, Debug)]
pub struct StateWakeups(Arc<AtomicBool>);

impl Default for StateWakeups {
    fn default() -> Self {
        Self(Arc::new(AtomicBool::new(true)))
    }
}

impl StateWakeups {
    /// Requests wake-ups, for a subscriber that was counted before this call.
    pub fn request(&self) {
        // Release, with the Acquire in `release`: the thread that undoes this sees the count.
        self.0.swap(true, Ordering::AcqRel);
    }

    /// Ends the wake-ups, unless `are_wanted` finds a subscriber, even a new one. Only one thread
    /// may call this.
    pub fn release(&self, are_wanted: impl Fn() -> bool) {
        if are_wanted() {
            return;
        }
        self.0.swap(false, Ordering::AcqRel);
        if are_wanted() {
            self.request();
        }
    }

    /// True if the thread must send a wake-up for every state.
    pub fn are_wanted(&self) -> bool {
        // Relaxed: nothing else is read because of it. A request takes effect one state later at
        // worst.
        self.0.load(Ordering::Relaxed)
    }
}
