//! Lends the cycle of the control thread to a thread of the program.
//!
//! ```text
//!             borrow                        drop
//!   Running ----------> Lent (this thread waits) ------> Running
//! ```
//!
//! The control thread lends the cycle between two turns. It then waits until the cycle comes back,
//! or until it is asked to stop. Only the two hand-overs take the lock of the [`Handoff`]; a turn
//! takes no lock on either thread.

use std::sync::Arc;

use franka_proto::RobotState;

use super::Core;
use super::cycle::Cycle;
use super::handoff::{BorrowError, Handoff};
use crate::control::{Command, WriteError};
use crate::driver::Driver;
use crate::exchange::SendError;

/// Lends the cycle of one thread. Clones lend the same cycle.
pub struct Lender<C: Core = Driver> {
    handoff: Arc<Handoff<Box<Cycle<C>>>>,
}

impl<C: Core> Lender<C> {
    pub(super) fn new(handoff: Arc<Handoff<Box<Cycle<C>>>>) -> Self {
        Self { handoff }
    }

    /// Borrows the cycle from its thread. Blocks until the thread has finished its turn, which
    /// lasts a cycle, or a [`TICK`](crate::exchange::TICK) if the robot is silent.
    ///
    /// # Errors
    /// Returns [`BorrowError`] if the cycle is not available.
    pub fn borrow(&self) -> Result<Lease<C>, BorrowError> {
        Ok(Lease {
            cycle: Some(self.handoff.borrow()?),
            handoff: self.handoff.clone(),
            is_unsound: false,
        })
    }
}

impl<C: Core> Clone for Lender<C> {
    fn clone(&self) -> Self {
        Self::new(self.handoff.clone())
    }
}

impl<C: Core> core::fmt::Debug for Lender<C> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Lender").finish_non_exhaustive()
    }
}

/// The cycle of a control thread, borrowed by another thread. Dropping the lease returns the cycle.
///
/// While the lease exists, only its turns read, publish and count states. If the lease runs no turn
/// for the link timeout, [`Thread::stalled`](super::Thread::stalled) reports this.
///
/// If the borrowing thread panics, the cycle is returned as well. If the core itself panics, in a
/// [`turn`](Self::turn) or a [`write`](Lease::write), the cycle is destroyed and the control thread
/// ends.
pub struct Lease<C: Core = Driver> {
    handoff: Arc<Handoff<Box<Cycle<C>>>>,
    /// The cycle; `None` only while the lease is dropped.
    cycle: Option<Box<Cycle<C>>>,
    /// True while a method of the core runs, and if a method has panicked.
    is_unsound: bool,
}

impl<C: Core> Lease<C> {
    /// Waits up to a [`TICK`](crate::exchange::TICK) for a state that is newer than all previous
    /// states. Then does the work of the thread: carries out orders, calls the core, sends the
    /// core's command if there is one, and publishes. Returns `None` if no state came.
    ///
    /// # Errors
    /// Returns [`BorrowError::Ended`] if the thread was asked to stop or the core has panicked.
    /// Then drop the lease.
    pub fn turn(&mut self) -> Result<Option<RobotState>, BorrowError> {
        if self.cycle().lifetime.stop_wanted() || self.is_unsound {
            return Err(BorrowError::Ended);
        }
        self.cycle().lifetime.note_turn();
        Ok(self.guarded(|cycle| cycle.turn().then(|| cycle.state()).flatten()))
    }

    /// Calls methods of the core. If a call panics, the cycle remains marked as unsound.
    fn guarded<T>(&mut self, call: impl FnOnce(&mut Cycle<C>) -> T) -> T {
        self.is_unsound = true;
        let returned = call(self.cycle());
        self.is_unsound = false;
        returned
    }

    /// Returns the core.
    pub fn core(&self) -> &C {
        let cycle = self.cycle.as_ref();
        &cycle.expect("it is there until the drop").core
    }

    fn cycle(&mut self) -> &mut Cycle<C> {
        self.cycle.as_mut().expect("it is there until the drop")
    }
}

/// Reason why a command was not sent.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteFault {
    /// The motion refused the command.
    #[error(transparent)]
    Refused(#[from] WriteError),
    /// The command could not be sent.
    #[error(transparent)]
    Link(#[from] SendError),
}

impl Lease<Driver> {
    /// Sends a command for the newest state: see [`Driver::write`].
    ///
    /// # Errors
    /// Returns [`WriteFault`] if the command was not sent; the motion continues.
    pub fn write(&mut self, command: &Command, finished: bool) -> Result<(), WriteFault> {
        if self.is_unsound {
            return Err(WriteError::NotRunning.into());
        }
        self.guarded(|cycle| {
            let command = cycle.core.write(command, finished)?;
            Ok(cycle.send(&command)?)
        })
    }
}

impl<C: Core> Drop for Lease<C> {
    fn drop(&mut self) {
        let cycle = self.cycle.take();
        if let Some(cycle) = &cycle {
            cycle.lifetime.set_stalled(false);
        }
        self.handoff.give_back(cycle.filter(|_| !self.is_unsound));
    }
}

impl<C: Core> core::fmt::Debug for Lease<C> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Lease").finish_non_exhaustive()
    }
}
