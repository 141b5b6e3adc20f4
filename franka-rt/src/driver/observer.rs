//! A function of the user's that sees every cycle of a motion.

use core::any::Any;
use core::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use franka_proto::RobotState;

use super::Record;
use crate::panic;

type Function = dyn FnMut(&Record, &RobotState) + Send;

/// Sees every cycle of a motion on the control thread, once its command has left: the record of the
/// cycle and its state.
///
/// It has some 300 us and must not lock, allocate, print or wait. If it panics it is not called
/// again; the motion continues.
pub struct Observer {
    function: Box<Function>,
    /// Payload of its panic, kept to be freed elsewhere.
    panicked: Option<Box<dyn Any + Send>>,
}

impl Observer {
    /// An observer that calls `function`.
    pub fn new(function: impl FnMut(&Record, &RobotState) + Send + 'static) -> Self {
        Self {
            function: Box::new(function),
            panicked: None,
        }
    }

    /// Shows it a cycle. Returns true if it panics, which happens once.
    pub(super) fn see(&mut self, record: &Record, state: &RobotState) -> bool {
        if self.panicked.is_some() {
            return false;
        }
        // A function that has panicked is never called again, so no caller sees its half-finished
        // state.
        let seen = catch_unwind(AssertUnwindSafe(|| (self.function)(record, state)));
        self.panicked = seen.err();
        self.panicked.is_some()
    }
}

/// Freed elsewhere: see [`Event::Ended`](super::Event::Ended).
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
