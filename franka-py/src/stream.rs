//! Streams of the driver, item by item, for Python's iterators.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use futures::{Stream, StreamExt};
use pyo3::exceptions::PyStopAsyncIteration;
use pyo3::prelude::*;

use crate::operation::Operation;

/// Converted to an object when the interpreter is held.
type Item = Box<dyn FnOnce(Python<'_>) -> PyResult<Py<PyAny>> + Send>;

type Items = Pin<Box<dyn Stream<Item = Item> + Send>>;

/// The source of the items of `franka_async.streams.Stream`.
///
/// An item is awaited and taken in two steps, so that no item is lost if the wait is cancelled:
/// `ready()` waits and changes nothing visible, and `take()` returns at once.
#[pyclass(frozen, module = "franka_async._native")]
pub(crate) struct Source(Arc<Shared>);

struct Shared {
    items: tokio::sync::Mutex<Items>,
    next: Mutex<Next>,
}

enum Next {
    Unknown,
    Known(Item),
    /// No more items exist.
    End,
}

impl Shared {
    fn next(&self) -> MutexGuard<'_, Next> {
        self.next.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the next item is known.
    async fn ready(&self) {
        // Another waiting task finds the item there.
        let mut items = self.items.lock().await;
        if matches!(*self.next(), Next::Unknown) {
            let next = items.next().await.map_or(Next::End, Next::Known);
            *self.next() = next;
        }
    }
}

#[pymethods]
impl Source {
    /// Resolves when `take()` has an item.
    fn ready(&self) -> Operation {
        let shared = self.0.clone();
        Operation::infallible("next", async move { shared.ready().await })
    }

    /// Next item, as a tuple of one; `None` if another task has taken it. Raises
    /// `StopAsyncIteration` at the end.
    fn take(&self, py: Python<'_>) -> PyResult<Option<(Py<PyAny>,)>> {
        let mut next = self.0.next();
        match std::mem::replace(&mut *next, Next::Unknown) {
            Next::Unknown => Ok(None),
            Next::Known(item) => {
                drop(next);
                Ok(Some((item(py)?,)))
            }
            Next::End => {
                *next = Next::End;
                Err(PyStopAsyncIteration::new_err(()))
            }
        }
    }
}

/// Returns a `franka_async.streams.Stream` of the items of `stream`; `object` converts each item.
pub(crate) fn stream<'py, T: Send + 'static>(
    py: Python<'py>,
    stream: impl Stream<Item = T> + Send + 'static,
    object: impl Fn(Python<'_>, T) -> PyResult<Py<PyAny>> + Clone + Send + 'static,
) -> PyResult<Bound<'py, PyAny>> {
    let items = stream.map(move |item| {
        let object = object.clone();
        Box::new(move |py: Python<'_>| object(py, item)) as Item
    });
    let shared = Shared {
        items: tokio::sync::Mutex::new(Box::pin(items)),
        next: Mutex::new(Next::Unknown),
    };
    let class = py.import("franka_async.streams")?.getattr("Stream")?;
    class.call1((Source(Arc::new(shared)),))
}
