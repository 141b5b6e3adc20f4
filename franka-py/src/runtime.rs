//! The Tokio runtime of the module, and waiting for its futures on Python threads.

use std::future::Future;
use std::ops::Deref;
use std::sync::OnceLock;
use std::time::Duration;

use pyo3::exceptions::{PyRuntimeError, PyTimeoutError};
use pyo3::prelude::*;
use tokio::runtime::{Builder, Runtime};
use tokio::time::Instant;

/// The runtime, and the process that owns its threads.
static RUNTIME: OnceLock<(&'static Runtime, u32)> = OnceLock::new();

/// Returns the runtime shared by all robots of the process. The first call starts its threads.
///
/// # Errors
/// `RuntimeError` in a process that was forked after the first call, because the threads do not
/// exist there.
pub(crate) fn runtime() -> PyResult<&'static Runtime> {
    let (runtime, process) = RUNTIME.get_or_init(|| {
        let runtime = Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("franka-async")
            .enable_all()
            .build()
            .expect("threads for the background");
        let runtime: &Runtime = Box::leak(Box::new(runtime));
        (runtime, std::process::id())
    });
    if *process != std::process::id() {
        return Err(PyRuntimeError::new_err(
            "this process was forked after franka_async had been used in its parent: use the start \
             method 'spawn' or 'forkserver', or fork before the first call",
        ));
    }
    Ok(runtime)
}

/// Returns the runtime, if it was started in this process.
pub(crate) fn started() -> Option<&'static Runtime> {
    RUNTIME.get()?;
    runtime().ok()
}

/// A value with threads behind it. It is not dropped in a forked child, where no thread would
/// answer it.
pub(crate) struct Threaded<T>(Option<T>);

impl<T> Threaded<T> {
    pub(crate) fn new(value: T) -> Self {
        Self(Some(value))
    }

    pub(crate) fn into_inner(mut self) -> T {
        self.0.take().expect("taken by `drop` only")
    }
}

impl<T> Deref for Threaded<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0.as_ref().expect("taken by `drop` only")
    }
}

impl<T> Drop for Threaded<T> {
    fn drop(&mut self) {
        if RUNTIME.get().is_some() && started().is_none() {
            std::mem::forget(self.0.take());
        }
    }
}

/// Waits for `work` on the calling thread, with the interpreter released. After `timeout`, and when
/// a signal handler raises (Ctrl-C), `work` is dropped first: a motion brakes.
///
/// # Errors
/// `TimeoutError`, and what the signal handler raised.
pub(crate) fn wait<T: Send + 'static>(
    py: Python<'_>,
    runtime: &'static Runtime,
    work: impl Future<Output = T> + Send + 'static,
    timeout: Option<Duration>,
) -> PyResult<T> {
    py.detach(|| {
        // A task, so that its work continues while this thread waits for the interpreter.
        let mut task = runtime.spawn(work);
        let outcome = runtime.block_on(async {
            // A time beyond the range of the clock never expires.
            let deadline = timeout.and_then(|timeout| Instant::now().checked_add(timeout));
            loop {
                let next = Instant::now() + SIGNALS_EVERY;
                let until = deadline.map_or(next, |deadline| deadline.min(next));
                match tokio::time::timeout_at(until, &mut task).await {
                    Ok(outcome) => return Ok(outcome),
                    Err(_) if deadline.is_some_and(|deadline| deadline <= Instant::now()) => {
                        return Err(PyTimeoutError::new_err(
                            "not done within the timeout, and \
                            cancelled",
                        ));
                    }
                    Err(_) => Python::attach(|py| py.check_signals())?,
                }
            }
        });
        match outcome {
            Ok(Ok(value)) => Ok(value),
            Ok(Err(panicked)) => Err(PyRuntimeError::new_err(panicked.to_string())),
            Err(raised) => {
                task.abort();
                // Resolves once the work has been dropped.
                let _ = runtime.block_on(task);
                Err(raised)
            }
        }
    })
}

/// Returns the runtime, for [`wait`] on this thread.
///
/// # Errors
/// The errors of [`runtime`], and `RuntimeError` on a thread that runs an event loop: a waiting
/// thread would block it, timeouts and cancellation included.
pub(crate) fn may_wait(py: Python<'_>) -> PyResult<&'static Runtime> {
    let runtime = runtime()?;
    let running = py.import("asyncio")?.call_method0("_get_running_loop")?;
    if running.is_none() {
        return Ok(runtime);
    }
    Err(PyRuntimeError::new_err(
        "waiting would block the event loop of this thread: use 'await' here, and \
         franka_async.Robot in place of franka_async.sync.Robot",
    ))
}

/// Interval at which a waiting thread checks for signals.
const SIGNALS_EVERY: Duration = Duration::from_millis(50);

/// Runs a short operation on the calling thread, with the interpreter released.
pub(crate) fn blocking<T: Send>(
    py: Python<'_>,
    work: impl Future<Output = T> + Send,
) -> PyResult<T> {
    let runtime = runtime()?;
    Ok(py.detach(|| runtime.block_on(work)))
}
