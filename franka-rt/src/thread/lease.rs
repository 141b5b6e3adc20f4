//! The cycle, lent to a thread of the user's.
//!
//! ```text
//!             borrow                        drop
//!   Running ----------> Lent (this thread waits) ------> Running
//! ```
//!
//! The thread hands the cycle over between two turns and waits until it comes back, or until it is told to stop. The lock
//! is taken at the two hand-overs only; a turn, whoever runs it, takes none.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use franka_proto::RobotState;

use super::Core;
use super::cycle::Cycle;
use super::handle::Lifetime;
use crate::control::{Command, WriteError};
use crate::driver::Driver;
use crate::exchange::{SendError, TICK};

/// Where the cycle changes hands.
pub(super) struct Desk<C: Core> {
    wanted: AtomicBool,
    place: Mutex<Place<C>>,
    changed: Condvar,
}

/// Where the cycle is.
enum Place<C: Core> {
    /// With the thread.
    Running,
    /// On its way to a borrower.
    Offered(Box<Cycle<C>>),
    /// With a borrower.
    Lent,
    /// On its way back.
    Returned(Box<Cycle<C>>),
    /// Gone: the thread has ended.
    Ended,
}

impl<C: Core> Default for Desk<C> {
    fn default() -> Self {
        Self {
            wanted: AtomicBool::new(false),
            place: Mutex::new(Place::Running),
            changed: Condvar::new(),
        }
    }
}

impl<C: Core> Desk<C> {
    /// Whether somebody wants to borrow. Relaxed: the hand-over itself goes through the lock.
    pub(super) fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Relaxed)
    }

    /// Gives the cycle to whoever wants it and waits until it is back. `None` if the thread is told to stop meanwhile.
    pub(super) fn lend(&self, cycle: Box<Cycle<C>>, lifetime: &Lifetime) -> Option<Box<Cycle<C>>> {
        let mut place = self.lock();
        // Under the lock: whoever wants it later finds it on offer, or lent.
        self.wanted.store(false, Ordering::Relaxed);
        *place = Place::Offered(cycle);
        self.changed.notify_all();
        loop {
            let stop = lifetime.stop_wanted();
            match core::mem::replace(&mut *place, Place::Running) {
                Place::Returned(cycle) => return Some(cycle),
                Place::Offered(cycle) if stop => return Some(cycle),
                Place::Ended => return None,
                other => *place = other,
            }
            if stop {
                return None;
            }
            let waited = self.changed.wait_timeout(place, TICK);
            place = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Refuses all further borrowers.
    pub(super) fn close(&self) {
        let mut place = self.lock();
        // What a borrower has brought back meanwhile is freed here, after the last turn.
        *place = Place::Ended;
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Place<C>> {
        // Nobody panics while holding it.
        self.place.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Lends the cycle of one thread. Clones lend the same one.
pub struct Lender<C: Core = Driver> {
    desk: Arc<Desk<C>>,
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

impl<C: Core> Lender<C> {
    pub(super) fn new(desk: Arc<Desk<C>>) -> Self {
        Self { desk }
    }

    /// Takes the cycle over from its thread. Blocks until that has done its turn: a cycle, or a [`TICK`] while the robot is
    /// silent.
    ///
    /// # Errors
    /// [`BorrowError`].
    pub fn borrow(&self) -> Result<Lease<C>, BorrowError> {
        let mut place = self.desk.lock();
        loop {
            match core::mem::replace(&mut *place, Place::Lent) {
                Place::Offered(cycle) => {
                    return Ok(Lease {
                        desk: self.desk.clone(),
                        cycle: Some(cycle),
                    });
                }
                Place::Lent => return Err(BorrowError::Lent),
                Place::Ended => {
                    *place = Place::Ended;
                    return Err(BorrowError::Ended);
                }
                other @ (Place::Running | Place::Returned(_)) => *place = other,
            }
            self.desk.wanted.store(true, Ordering::Relaxed);
            let waited = self.desk.changed.wait(place);
            place = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl<C: Core> Clone for Lender<C> {
    fn clone(&self) -> Self {
        Self::new(self.desk.clone())
    }
}

impl<C: Core> core::fmt::Debug for Lender<C> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Lender").finish_non_exhaustive()
    }
}

/// The cycle of a control thread, in the hands of another. Dropping it gives it back.
///
/// Whoever holds it *is* the cycle: states are read, published and counted in its turns and nowhere else.
pub struct Lease<C: Core = Driver> {
    desk: Arc<Desk<C>>,
    /// `None` only while it is dropped.
    cycle: Option<Box<Cycle<C>>>,
}

impl<C: Core> Lease<C> {
    /// Waits for a state newer than all before, up to a [`TICK`], and does what the thread does with it: orders, the core,
    /// the command that this answers with at once if there is one, publishing. `None` if none came.
    ///
    /// # Errors
    /// [`BorrowError::Ended`] if the thread was told to stop: give the cycle back.
    pub fn turn(&mut self) -> Result<Option<RobotState>, BorrowError> {
        let cycle = self.cycle();
        if cycle.lifetime.stop_wanted() {
            return Err(BorrowError::Ended);
        }
        let fresh = cycle.turn();
        Ok(fresh.then(|| cycle.state()).flatten())
    }

    /// The core, to look at.
    pub fn core(&self) -> &C {
        let cycle = self.cycle.as_ref();
        &cycle.expect("it is there until the drop").core
    }

    fn cycle(&mut self) -> &mut Cycle<C> {
        self.cycle.as_mut().expect("it is there until the drop")
    }
}

/// Why a command did not leave.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteFault {
    /// The motion does not take it.
    #[error(transparent)]
    Refused(#[from] WriteError),
    /// The system did not send it.
    #[error(transparent)]
    Link(#[from] SendError),
}

impl Lease<Driver> {
    /// Sends a command for the newest state: see [`Driver::write`].
    ///
    /// # Errors
    /// [`WriteFault`]; the motion goes on.
    pub fn write(&mut self, command: &Command, finished: bool) -> Result<(), WriteFault> {
        let cycle = self.cycle();
        let command = cycle.core.write(command, finished)?;
        Ok(cycle.send(&command)?)
    }
}

impl<C: Core> Drop for Lease<C> {
    fn drop(&mut self) {
        let mut place = self.desk.lock();
        *place = match (&*place, self.cycle.take()) {
            // The core has panicked, and is not used after that.
            (Place::Lent, Some(_)) if std::thread::panicking() => Place::Ended,
            (Place::Lent, Some(cycle)) => Place::Returned(cycle),
            // The thread has ended: the cycle is freed here.
            _ => Place::Ended,
        };
        self.desk.changed.notify_all();
    }
}

impl<C: Core> core::fmt::Debug for Lease<C> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Lease").finish_non_exhaustive()
    }
}
