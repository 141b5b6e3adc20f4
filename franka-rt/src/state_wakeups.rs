//! Flag that makes the thread send a wake-up for every state.
//!
//! A wake-up for every state runs an async task a thousand times per second. This uses about one
//! percent of a processor, half of it on the thread. A program that only reads the newest state
//! occasionally does not need these wake-ups; listeners to every state request them. Without a
//! request, the thread sends a wake-up for every fiftieth state.

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

/// True if any subscriber needs a wake-up for every state; initially true. Clones share the flag.
///
/// The thread reads only this flag. The subscribers are counted elsewhere, for example by a
/// channel.
#[derive(Clone, Debug)]
pub struct StateWakeups(Arc<AtomicBool>);

impl Default for StateWakeups {
    fn default() -> Self {
        Self(Arc::new(AtomicBool::new(true)))
    }
}

impl StateWakeups {
    /// Requests wake-ups. The subscriber must be counted before this call.
    pub fn request(&self) {
        // Release, pairs with the Acquire in `release`: a thread that undoes this request sees the
        // count.
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
        // Relaxed: no other memory is read depending on it. A request takes effect at most one
        // state later.
        self.0.load(Ordering::Relaxed)
    }
}
