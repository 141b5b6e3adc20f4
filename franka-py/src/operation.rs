//! Operations that Python awaits or waits for: a Rust future that begins with the first step.

use std::any::TypeId;
use std::convert::Infallible;
use std::future::Future;
use std::panic::AssertUnwindSafe;
use std::pin::Pin;
use std::sync::{Mutex, MutexGuard, PoisonError, mpsc};
use std::time::Duration;

use futures::FutureExt;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::{PyRuntimeError, PyRuntimeWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyAny;
use tokio::sync::oneshot;

use crate::errors::Raise;
use crate::exit;
use crate::runtime::{self, Threaded};

/// A value for Python, converted to an object when the interpreter is held.
struct Delivered(Deliver);

type Deliver = Box<dyn FnOnce(Python<'_>) -> PyResult<Py<PyAny>> + Send>;

type Work = Pin<Box<dyn Future<Output = Delivered> + Send>>;

/// An operation that takes time: `await` it in a coroutine, or call `wait()` on a thread without an
/// event loop. It begins then and not before. Cancelling the wait cancels the operation; a motion
/// brakes.
///
/// It is a coroutine in the sense of `collections.abc`, so `asyncio.create_task`, `TaskGroup`,
/// `gather`, `wait_for` and `timeout` accept it.
#[pyclass(frozen, subclass, generic, module = "franka_async")]
pub(crate) struct Operation {
    name: &'static str,
    stage: Mutex<Stage>,
}

enum Stage {
    Ready(Threaded<Work>),
    /// A Python coroutine with the work, which has not begun.
    Coroutine(Py<PyAny>),
    Awaited(Awaited),
    Over,
}

/// The state that the awaiting code steps.
struct Awaited {
    iterator: Py<PyAny>,
    /// The asyncio future that represents the work; `None` for a coroutine.
    future: Option<Pending>,
}

struct Pending {
    future: Py<PyAny>,
    task: Threaded<Task>,
}

/// The task of the work.
struct Task {
    /// Dropping this drops the work.
    keep: oneshot::Sender<Infallible>,
    /// Closed once the work is dropped.
    over: mpsc::Receiver<Infallible>,
}

impl Operation {
    /// Creates an operation named `name` with `work`.
    pub(crate) fn new<T, E>(
        name: &'static str,
        work: impl Future<Output = Result<T, E>> + Send + 'static,
    ) -> Self
    where
        T: for<'py> IntoPyObject<'py> + Send + 'static,
        E: Raise,
    {
        let work = async move {
            // Tasks do not wait for the interpreter: the awaiting code creates the objects.
            let outcome = work.await;
            Delivered(Box::new(move |py| match outcome {
                Ok(_) if TypeId::of::<T>() == TypeId::of::<()>() => Ok(py.None()),
                Ok(value) => value.into_py_any(py),
                Err(error) => Err(error.raise(py)),
            }))
        };
        let stage = Stage::Ready(Threaded::new(Box::pin(work)));
        Self::in_stage(name, stage)
    }

    /// Creates an operation named `name` from a Python coroutine.
    pub(crate) fn of_coroutine(name: &'static str, coroutine: Py<PyAny>) -> Self {
        Self::in_stage(name, Stage::Coroutine(coroutine))
    }

    fn in_stage(name: &'static str, stage: Stage) -> Self {
        let stage = Mutex::new(stage);
        Self { name, stage }
    }

    /// Creates an operation named `name` with `work`, which cannot fail.
    pub(crate) fn infallible<T>(
        name: &'static str,
        work: impl Future<Output = T> + Send + 'static,
    ) -> Self
    where
        T: for<'py> IntoPyObject<'py> + Send + 'static,
    {
        Self::new(name, async move { Ok::<T, PyErr>(work.await) })
    }

    fn stage(&self) -> MutexGuard<'_, Stage> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Drops the work. Returns its iterator.
    fn give_up(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        match self.replace(Stage::Over) {
            Stage::Awaited(Awaited { iterator, future }) => {
                if let Some(future) = future {
                    future.give_up(py);
                }
                Some(iterator)
            }
            Stage::Coroutine(iterator) => Some(iterator),
            Stage::Ready(_) | Stage::Over => None,
        }
    }

    fn replace(&self, stage: Stage) -> Stage {
        std::mem::replace(&mut *self.stage(), stage)
    }

    /// Takes the work out, which begins now.
    fn begin(&self) -> PyResult<Work> {
        let begun = match self.replace(Stage::Over) {
            Stage::Ready(work) => return Ok(work.into_inner()),
            begun => begun,
        };
        let problem = match &begun {
            Stage::Coroutine(_) => {
                "needs a running event loop, since its targets come from an asynchronous iterator"
            }
            _ => "was already awaited: call it again for another motion or result",
        };
        self.replace(begun);
        Err(PyRuntimeError::new_err(format!(
            "{}() {problem}",
            self.name
        )))
    }

    /// Returns the awaited iterator; begins the work if necessary.
    fn iterator<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let awaited = match self.replace(Stage::Over) {
            Stage::Awaited(awaited) => awaited,
            Stage::Coroutine(iterator) => Awaited {
                iterator,
                future: None,
            },
            stage => {
                self.replace(stage);
                let runtime = runtime::runtime()?;
                let event_loop = py.import("asyncio")?.call_method0("get_running_loop")?;
                let future = event_loop.call_method0("create_future")?;
                let iterator = future.call_method0("__await__")?.unbind();
                let work = self.begin()?;
                let (keep, given_up) = oneshot::channel();
                let (dropped, over) = mpsc::channel();
                let waiting = (event_loop.unbind(), future.clone().unbind());
                runtime.spawn(begun(work, given_up, dropped, waiting));
                Awaited {
                    iterator,
                    future: Some(Pending {
                        future: future.unbind(),
                        task: Threaded::new(Task { keep, over }),
                    }),
                }
            }
        };
        let iterator = awaited.iterator.bind(py).clone();
        self.replace(Stage::Awaited(awaited));
        Ok(iterator)
    }
}

/// Runs the work unless it is cancelled, and completes the future of the event loop.
async fn begun(
    work: Work,
    given_up: oneshot::Receiver<Infallible>,
    dropped: mpsc::Sender<Infallible>,
    (event_loop, future): (Py<PyAny>, Py<PyAny>),
) {
    let delivered = tokio::select! {
        biased;
        _ = given_up => return,
        delivered = AssertUnwindSafe(work).catch_unwind() => delivered,
    };
    drop(dropped);
    let delivered = delivered.unwrap_or_else(|_| {
        let bug = || {
            Err(PyRuntimeError::new_err(
                "a bug in franka_async: see its panic",
            ))
        };
        Delivered(Box::new(move |_| bug()))
    });
    // A computing program may hold the interpreter: no task waits for it.
    let complete = move |py: Python<'_>| {
        let (method, value) = match (delivered.0)(py) {
            Ok(value) => ("set_result", value),
            Err(error) => ("set_exception", error.into_value(py).into_any()),
        };
        let complete = py.import("franka_async._native")?.getattr("_complete")?;
        let arguments = (complete, future, method, value);
        event_loop
            .bind(py)
            .call_method1("call_soon_threadsafe", arguments)?;
        PyResult::Ok(())
    };
    // A closed event loop awaits nothing.
    tokio::task::spawn_blocking(move || exit::in_python(complete).map(Result::ok));
}

/// Completes a future, in its event loop, unless it is done.
#[pyfunction]
pub(crate) fn _complete(
    future: &Bound<'_, PyAny>,
    method: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<()> {
    if !future.call_method0("done")?.is_truthy()? {
        future.call_method1(method, (value,))?;
    }
    Ok(())
}

impl Pending {
    /// Drops the work, even if the event loop has stopped, and waits for this: later code finds the
    /// arm already braking.
    fn give_up(self, py: Python<'_>) {
        // Fails for a closed loop, after the future is cancelled.
        let _ = self.future.bind(py).call_method0("cancel");
        if runtime::started().is_some() {
            let Task { keep, over } = self.task.into_inner();
            drop(keep);
            let Err(mpsc::RecvError) = py.detach(move || over.recv());
        }
    }
}

#[pymethods]
impl Operation {
    /// Waits on this thread, with the interpreter released, and returns the result. After `timeout`
    /// seconds the operation is cancelled (a motion brakes) and `TimeoutError` is raised; Ctrl-C
    /// cancels it and raises `KeyboardInterrupt`.
    #[pyo3(signature = (timeout = None))]
    fn wait(&self, py: Python<'_>, timeout: Option<f64>) -> PyResult<Py<PyAny>> {
        let timeout = timeout.map(|timeout| seconds("timeout", timeout));
        let timeout = timeout.transpose()?;
        // A refused operation has not begun, and can still be awaited.
        let runtime = runtime::may_wait(py)?;
        let delivered = runtime::wait(py, runtime, self.begin()?, timeout)?;
        (delivered.0)(py)
    }

    fn __await__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.send(py, py.None())
    }

    /// Coroutine protocol: continues from the last `await`.
    fn send(&self, py: Python<'_>, value: Py<PyAny>) -> PyResult<Py<PyAny>> {
        let sent = self.iterator(py)?.call_method1("send", (value,));
        if sent.is_err() {
            // It has returned, or raised.
            drop(self.replace(Stage::Over));
        }
        Ok(sent?.unbind())
    }

    /// Coroutine protocol: raises an exception inside of it.
    #[pyo3(signature = (kind, value = None, traceback = None))]
    fn throw(
        &self,
        py: Python<'_>,
        kind: Py<PyAny>,
        value: Option<Py<PyAny>>,
        traceback: Option<Py<PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        let error = raised(py, kind.bind(py), value)?;
        if matches!(*self.stage(), Stage::Ready(_) | Stage::Over) {
            self.replace(Stage::Over);
            return Err(error);
        }
        if let Some(traceback) = traceback {
            error.value(py).setattr("__traceback__", traceback)?;
        }
        let thrown = self.iterator(py)?.call_method1("throw", (error.value(py),));
        if thrown.is_err() {
            self.give_up(py);
        }
        Ok(thrown?.unbind())
    }

    /// Coroutine protocol: cancels the operation. A motion brakes.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        match self.give_up(py) {
            Some(iterator) => iterator.bind(py).call_method0("close").map(drop),
            None => Ok(()),
        }
    }

    fn __repr__(&self) -> String {
        let stage = match &*self.stage() {
            Stage::Ready(_) | Stage::Coroutine(_) => "not begun",
            Stage::Awaited(_) => "under way",
            Stage::Over => "over",
        };
        format!("<{} {stage}>", self.name)
    }
}

/// Returns the exception of `throw(kind, value)`.
fn raised(py: Python<'_>, kind: &Bound<'_, PyAny>, value: Option<Py<PyAny>>) -> PyResult<PyErr> {
    let is_exception =
        |value: &Bound<'_, PyAny>| value.is_instance_of::<pyo3::exceptions::PyBaseException>();
    Ok(PyErr::from_value(match value {
        _ if is_exception(kind) => kind.clone(),
        Some(value) if is_exception(value.bind(py)) => value.into_bound(py),
        Some(value) => kind.call1((value.bind(py),))?,
        None => kind.call0()?,
    }))
}

impl Drop for Operation {
    fn drop(&mut self) {
        let stage = self.stage.get_mut().unwrap_or_else(PoisonError::into_inner);
        let stage = std::mem::replace(stage, Stage::Over);
        if matches!(stage, Stage::Over) {
            return;
        }
        Python::attach(|py| {
            // An exception that is propagating while this object is freed continues afterwards.
            let raised = PyErr::take(py);
            match stage {
                Stage::Ready(_) => warn_of_unawaited(py, self.name),
                Stage::Awaited(Awaited {
                    future: Some(future),
                    ..
                }) => future.give_up(py),
                Stage::Awaited(_) | Stage::Coroutine(_) | Stage::Over => {}
            }
            if let Some(raised) = raised {
                raised.restore(py);
            }
        });
    }
}

fn warn_of_unawaited(py: Python<'_>, name: &str) {
    let text = format!("{name}() was never awaited, and has done nothing");
    let text = std::ffi::CString::new(text).expect("no zero in it");
    let category = py.get_type::<PyRuntimeWarning>();
    // A warning that is turned into an error cannot be raised while an object is freed.
    if let Err(error) = PyErr::warn(py, &category, &text, 1) {
        error.write_unraisable(py, None);
    }
}

/// Returns a duration in seconds, from the argument `name`.
///
/// # Errors
/// `ValueError` unless it is finite and not negative.
pub(crate) fn seconds(name: &str, seconds: f64) -> PyResult<Duration> {
    Duration::try_from_secs_f64(seconds).map_err(|_| {
        let text = format!("{name} is {seconds} s, expected a number of 0 or more");
        PyValueError::new_err(text)
    })
}
