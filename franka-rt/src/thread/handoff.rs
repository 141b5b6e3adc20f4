//! Lends a value from its owner's thread to other threads, one at a time.
//!
//! ```text
//!   owner:     Running --lend--> Offered              Returned --> Running
//!                                   |                     ^
//!   borrower:                    borrow --> Lent --> give_back
//! ```
//!
//! This file does not depend on the type of the value, because `tests/loom` includes it and
//! explores the hand-overs.

use std::sync::PoisonError;
#[cfg(not(loom))]
use std::sync::{
    Condvar, Mutex, MutexGuard,
    atomic::{AtomicBool, Ordering},
};
use std::time::Duration;

#[cfg(loom)]
use loom::sync::{
    Condvar, Mutex, MutexGuard,
    atomic::{AtomicBool, Ordering},
};

/// Place where a value passes from the owner to a borrower and back.
pub(super) struct Handoff<T> {
    wanted: AtomicBool,
    state: Mutex<HandoffState<T>>,
    changed: Condvar,
    tick: Duration,
}

/// Place of the value.
enum HandoffState<T> {
    /// The owner has the value.
    Running,
    /// The value is on its way to a borrower.
    Offered(T),
    Lent,
    /// The value is on its way back.
    Returned(T),
    /// The value is destroyed, because the owner has ended or a borrower has left the value
    /// invalid.
    Ended,
}

/// Reason why a lent value does not return.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NotReturned {
    /// The owner stopped waiting, and the borrower still has the value.
    Lent,
    /// The borrower has left the value invalid.
    Spoilt,
}

/// Reason why the cycle cannot be borrowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BorrowError {
    /// Another borrower has the cycle.
    #[error("another thread runs the control cycle")]
    Lent,
    /// The control thread has ended.
    #[error("the control thread has ended")]
    Ended,
}

impl<T> Handoff<T> {
    /// Returns a handoff. While the owner waits for its value, it polls the stop flag every `tick`.
    pub(super) fn new(tick: Duration) -> Self {
        Self {
            wanted: AtomicBool::new(false),
            state: Mutex::new(HandoffState::Running),
            changed: Condvar::new(),
            tick,
        }
    }

    /// True if a borrower waits. Relaxed, because the lock orders the hand-over itself.
    pub(super) fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Relaxed)
    }

    /// Offers the owner's value to a borrower, and returns it when it is back. Asks `stop_wanted`
    /// every tick whether to stop waiting.
    pub(super) fn lend(
        &self,
        value: T,
        mut stop_wanted: impl FnMut() -> bool,
    ) -> Result<T, NotReturned> {
        let mut state = self.lock();
        // Store under the lock, so that a later borrower finds the value offered or lent.
        self.wanted.store(false, Ordering::Relaxed);
        *state = HandoffState::Offered(value);
        self.changed.notify_all();
        loop {
            let stop = stop_wanted();
            match core::mem::replace(&mut *state, HandoffState::Running) {
                HandoffState::Returned(value) => return Ok(value),
                HandoffState::Offered(value) if stop => return Ok(value),
                HandoffState::Ended => return Err(NotReturned::Spoilt),
                other => *state = other,
            }
            if stop {
                return Err(NotReturned::Lent);
            }
            state = self.wait_a_tick(state);
        }
    }

    /// Makes the owner refuse all further borrowers.
    pub(super) fn close(&self) {
        let mut state = self.lock();
        // If a borrower has returned a value in the meantime, it is freed here, after the last
        // turn.
        *state = HandoffState::Ended;
        self.changed.notify_all();
    }

    /// Waits until the owner offers the value, and takes it.
    pub(super) fn borrow(&self) -> Result<T, BorrowError> {
        let mut state = self.lock();
        loop {
            match core::mem::replace(&mut *state, HandoffState::Lent) {
                HandoffState::Offered(value) => return Ok(value),
                HandoffState::Lent => return Err(BorrowError::Lent),
                HandoffState::Ended => {
                    *state = HandoffState::Ended;
                    return Err(BorrowError::Ended);
                }
                other @ (HandoffState::Running | HandoffState::Returned(_)) => *state = other,
            }
            self.wanted.store(true, Ordering::Relaxed);
            let waited = self.changed.wait(state);
            state = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Returns the borrowed value to the owner. `None` if the owner must not use it any more.
    pub(super) fn give_back(&self, value: Option<T>) {
        let mut state = self.lock();
        *state = match (&*state, value) {
            (HandoffState::Lent, Some(value)) => HandoffState::Returned(value),
            // The value is invalid or the owner has ended, so the value is freed here.
            _ => HandoffState::Ended,
        };
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, HandoffState<T>> {
        // No thread panics while it holds the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a change, for at most a tick.
    fn wait_a_tick<'a>(
        &'a self,
        state: MutexGuard<'a, HandoffState<T>>,
    ) -> MutexGuard<'a, HandoffState<T>> {
        // loom has no time. Its condition variable ends a wait with a timeout of zero once another
        // thread has run. It never ends other waits.
        #[cfg(loom)]
        if self.tick.is_zero() {
            drop(state);
            loom::thread::yield_now();
            return self.lock();
        }
        let waited = self.changed.wait_timeout(state, self.tick);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}
