//! Shutdown of robots when the interpreter exits.

use std::sync::{LazyLock, PoisonError, RwLock};
use std::time::Duration;

use franka_async::Robot;
use franka_async::connection::CancellationToken;
use futures::FutureExt;
use futures::future::BoxFuture;
use pyo3::prelude::*;
use tokio_util::task::TaskTracker;

use crate::runtime;

struct Live {
    /// Cancelled when the interpreter exits: each robot then brakes and closes.
    exit: CancellationToken,
    /// A task for each connected robot, which ends when the robot has closed.
    robots: TaskTracker,
    /// True while threads of this module may take the interpreter. The lock is held while one does.
    interpreter: RwLock<bool>,
}

static LIVE: LazyLock<Live> = LazyLock::new(|| Live {
    exit: CancellationToken::new(),
    robots: TaskTracker::new(),
    interpreter: RwLock::new(true),
});

/// Returns the token of every connection, so that it ends with the interpreter.
pub(crate) fn cancellation() -> CancellationToken {
    LIVE.exit.clone()
}

/// Makes the exit of the interpreter wait for this robot. Called on the runtime.
pub(crate) fn wait_for(robot: &Robot) {
    // The task holds no handle, so that a robot without handles closes.
    let mut health = robot.health();
    LIVE.robots
        .spawn(async move { while health.changed().await.is_ok() {} });
}

/// Runs a function with the interpreter on a thread that Python does not know. `None` once the
/// interpreter exits: such threads would otherwise be stopped in mid-operation.
pub(crate) fn in_python<T>(work: impl FnOnce(Python<'_>) -> T) -> Option<T> {
    let is_open = LIVE
        .interpreter
        .read()
        .unwrap_or_else(PoisonError::into_inner);
    is_open.then(|| Python::attach(work))
}

/// Registers [`shut_down`] with `atexit`, so that it runs before the interpreter is taken apart.
pub(crate) fn register(py: Python<'_>) -> PyResult<()> {
    let function = wrap_pyfunction!(shut_down, py)?;
    py.import("atexit")?.call_method1("register", (function,))?;
    Ok(())
}

/// Brakes every robot and closes its connection, and waits for a bounded time. Does nothing in a
/// forked child: the robots belong to the parent.
#[pyfunction]
fn shut_down(py: Python<'_>) {
    let Some(runtime) = runtime::started() else {
        return;
    };
    py.detach(|| {
        LIVE.exit.cancel();
        LIVE.robots.close();
        let within = |what: &'static str, time, step: BoxFuture<'static, ()>| {
            runtime.block_on(async move {
                if tokio::time::timeout(time, step).await.is_err() {
                    eprintln!("franka_async: {what} did not end within {time:?}");
                }
            });
        };
        within("a robot", BRAKED, Box::pin(LIVE.robots.wait()));
        // Waits until no thread of this module holds the interpreter.
        let closed = runtime.spawn_blocking(|| {
            let is_open = LIVE.interpreter.write();
            *is_open.unwrap_or_else(PoisonError::into_inner) = false;
        });
        within("a thread", GIVEN_BACK, Box::pin(closed.map(drop)));
    });
}

/// Time limit: a motion brakes within a quarter of a second; a robot that does not answer is
/// abandoned after two.
const BRAKED: Duration = Duration::from_secs(4);

/// Time limit for threads with the interpreter: they deliver a result, or run code of the program
/// that may take any time.
const GIVEN_BACK: Duration = Duration::from_secs(1);
