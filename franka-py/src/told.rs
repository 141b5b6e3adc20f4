//! The errors of a session that were already raised, so that the end of its block does not repeat
//! them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_async::{Arm, MotionError};
use futures::FutureExt;
use pyo3::prelude::*;

use crate::errors::Raise;
use crate::operation::Operation;

/// The raised errors of a session. Clones belong to the same session.
#[derive(Clone, Default)]
pub(crate) struct Told(Arc<Mutex<Raised>>);

#[derive(Default)]
struct Raised {
    /// True if the end of the session was raised.
    end: bool,
    /// The newest error before the end of the session, unless the session has continued since. A
    /// motion resolves before its session, because a stop brakes first.
    newest: Option<String>,
}

impl Told {
    fn raised(&self) -> MutexGuard<'_, Raised> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Records that `error` of the session `arm` is raised.
    pub(crate) fn note(&self, arm: &Arm, error: &MotionError) {
        match arm.ended().now_or_never() {
            Some(Err(end)) => self.raised().end |= end.to_string() == error.to_string(),
            Some(Ok(_)) => {}
            None => self.raised().newest = Some(error.to_string()),
        }
    }

    /// Records the result of a later request: a success shows that the earlier error was not the
    /// end.
    pub(crate) fn saw<T, E>(&self, outcome: &Result<T, E>) {
        if outcome.is_ok() {
            self.raised().newest = None;
        }
    }

    /// True if the program already received `error` as the end of the session.
    pub(crate) fn knows(&self, error: &MotionError) -> bool {
        let raised = self.raised();
        raised.end || raised.newest.as_ref() == Some(&error.to_string())
    }

    /// True if both belong to one session.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// An error of a session, which is recorded when it is raised.
pub(crate) struct Telling {
    pub(crate) error: MotionError,
    /// `None` for a motion without a session.
    pub(crate) of: Option<(Told, Arm)>,
}

impl Raise for Telling {
    fn raise(self, py: Python<'_>) -> PyErr {
        if let Some((told, arm)) = &self.of {
            told.note(arm, &self.error);
        }
        self.error.raise(py)
    }
}

/// Creates an operation named `name` with `work` of a session.
pub(crate) fn telling<T>(
    name: &'static str,
    (told, arm): (Told, Arm),
    work: impl Future<Output = Result<T, MotionError>> + Send + 'static,
) -> Operation
where
    T: for<'py> IntoPyObject<'py> + Send + 'static,
{
    Operation::new(name, async move {
        let outcome = work.await;
        told.saw(&outcome);
        outcome.map_err(|error| Telling {
            error,
            of: Some((told, arm)),
        })
    })
}

/// Ends the session at the end of a `with` block. The block's exception is not replaced, and errors
/// that the program already received are not raised again.
pub(crate) fn leave((told, arm): (Told, Arm), raised: Option<&Bound<'_, PyAny>>) -> Operation {
    let raised = raised.is_some_and(|kind| !kind.is_none());
    Operation::new("Arm.disengage", async move {
        match arm.disengage().await {
            Err(error) if !raised && !told.knows(&error) => Err(error),
            _ => Ok(()),
        }
    })
}
