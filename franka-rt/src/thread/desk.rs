//! Where a value changes hands between the thread that owns it and those that borrow it.
//!
//! ```text
//!   owner:     Running --lend--> Offered              Returned --> Running
//!                                   |                     ^
//!   borrower:                    borrow --> Lent --> give_back
//! ```
//!
//! Nothing here knows what is lent: `tests/loom.rs` includes this file and explores the hand-overs.

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

/// Where a value changes hands.
pub(super) struct Desk<T> {
    wanted: AtomicBool,
    place: Mutex<Place<T>>,
    changed: Condvar,
    tick: Duration,
}

/// Where the value is.
enum Place<T> {
    /// With its owner.
    Running,
    /// On its way to a borrower.
    Offered(T),
    /// With a borrower.
    Lent,
    /// On its way back.
    Returned(T),
    /// Gone: the owner has ended, or a borrower has spoilt it.
    Ended,
}

/// Why a value that was lent does not come back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NotReturned {
    /// The owner stopped waiting: the borrower still has it.
    Lent,
    /// The borrower has spoilt it.
    Spoilt,
}

/// Why the cycle cannot be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BorrowError {
    /// Somebody else has it.
    #[error("another thread runs the control cycle")]
    Lent,
    /// There is none any more.
    #[error("the control thread has ended")]
    Ended,
}

impl<T> Desk<T> {
    /// A desk whose owner, while it waits for its value, looks every `tick` whether it has to stop.
    pub(super) fn new(tick: Duration) -> Self {
        Self {
            wanted: AtomicBool::new(false),
            place: Mutex::new(Place::Running),
            changed: Condvar::new(),
            tick,
        }
    }

    /// Whether somebody wants to borrow. Relaxed: the hand-over itself goes through the lock.
    pub(super) fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Relaxed)
    }

    /// Offers the owner's value to a borrower and returns it when it is back. Asks `stop_wanted`
    /// every tick whether to go on waiting.
    pub(super) fn lend(
        &self,
        value: T,
        mut stop_wanted: impl FnMut() -> bool,
    ) -> Result<T, NotReturned> {
        let mut place = self.lock();
        // Under the lock: whoever wants it later finds it on offer, or lent.
        self.wanted.store(false, Ordering::Relaxed);
        *place = Place::Offered(value);
        self.changed.notify_all();
        loop {
            let stop = stop_wanted();
            match core::mem::replace(&mut *place, Place::Running) {
                Place::Returned(value) => return Ok(value),
                Place::Offered(value) if stop => return Ok(value),
                Place::Ended => return Err(NotReturned::Spoilt),
                other => *place = other,
            }
            if stop {
                return Err(NotReturned::Lent);
            }
            place = self.wait_a_tick(place);
        }
    }

    /// The owner refuses all further borrowers.
    pub(super) fn close(&self) {
        let mut place = self.lock();
        // What a borrower has brought back meanwhile is freed here, after the last turn.
        *place = Place::Ended;
        self.changed.notify_all();
    }

    /// Takes the value over from its owner. Waits until that offers it.
    pub(super) fn borrow(&self) -> Result<T, BorrowError> {
        let mut place = self.lock();
        loop {
            match core::mem::replace(&mut *place, Place::Lent) {
                Place::Offered(value) => return Ok(value),
                Place::Lent => return Err(BorrowError::Lent),
                Place::Ended => {
                    *place = Place::Ended;
                    return Err(BorrowError::Ended);
                }
                other @ (Place::Running | Place::Returned(_)) => *place = other,
            }
            self.wanted.store(true, Ordering::Relaxed);
            let waited = self.changed.wait(place);
            place = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Gives back what was borrowed; `None` if it is not to be used any more.
    pub(super) fn give_back(&self, value: Option<T>) {
        let mut place = self.lock();
        *place = match (&*place, value) {
            (Place::Lent, Some(value)) => Place::Returned(value),
            // It is spoilt, or the owner has ended: it is freed here.
            _ => Place::Ended,
        };
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Place<T>> {
        // Nobody panics while holding it.
        self.place.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a change, for a tick at most.
    fn wait_a_tick<'a>(&'a self, place: MutexGuard<'a, Place<T>>) -> MutexGuard<'a, Place<T>> {
        // loom knows no time. A tick of zero stands for one that is over once somebody else has
        // run, and its condition variable takes any other for one that never ends.
        #[cfg(loom)]
        if self.tick.is_zero() {
            drop(place);
            loom::thread::yield_now();
            return self.lock();
        }
        let waited = self.changed.wait_timeout(place, self.tick);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}
