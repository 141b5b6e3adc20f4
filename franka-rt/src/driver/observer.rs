//! A function of the user that observes every cycle of a motion.

use core::any::Any;
use core::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use franka_proto::RobotState;

use super::Record;
use crate::panic;

type Function = dyn FnMut(&Record, &RobotState) + Send;

/// Observes every cycle of a motion on the control thread, after the command has left. The function
/// receives the record of the cycle and the state.
///
/// The function may run for about 300 us, and must not lock, allocate, print or wait. If it panics,
/// it is not called again, and the motion continues.
pub struct Observer {
    function: Box<Function>,
    /// Payload of the function's panic, kept so that another thread frees it.
    panicked: Option<Box<dyn Any + Send>>,
}

impl Observer {
    /// Returns an observer that calls `function`.
    pub fn new(function: impl FnMut(&Record, &RobotState) + Send + 'static) -> Self {
        Self {
            function: Box::new(function),
            panicked: None,
        }
    }

    /// Calls the function with a cycle. Returns true if the function panics now, which can happen
    /// only once.
    pub(super) fn see(&mut self, record: &Record, state: &RobotState) -> bool {
        if self.panicked.is_some() {
            return false;
        }
        // A function that has panicked is never called again, so its inconsistent state is never
        // read.
        let seen = catch_unwind(AssertUnwindSafe(|| (self.function)(record, state)));
        self.panicked = seen.err();
        self.panicked.is_some()
    }
}

/// Frees the function. This must not happen on the control thread: see
/// [`Event::Ended`](super::Event::Ended).
impl Drop for Observer {
    fn drop(&mut self) {
        // The panic has been reported.
        let _ = panic::free(self.panicked.take());
    }
}

impl fmt::Debug for Observer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observer")
            .field("panicked", &self.panicked.is_some())
            .finish_non_exhaustive()
    }
}
