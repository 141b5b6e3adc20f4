//! What becomes of robots when the interpreter exits.

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
    /// Whether threads of this module may take the interpreter. Held while one does.
    interpreter: RwLock<bool>,
}

static LIVE: LazyLock<Live> = LazyLock::new(|| Live {
    exit: CancellationToken::new(),
    robots: TaskTracker::new(),
    interpreter: RwLock::new(true),
});

/// What every connection is to be given, so that it ends with the interpreter.
pub(crate) fn cancellation() -> CancellationToken {
    LIVE.exit.clone()
}

/// Has the exit of the interpreter wait for this robot. Called on the runtime.
pub(crate) fn wait_for(robot: &Robot) {
    // The task holds no handle, so that a robot without handles closes.
    let mut health = robot.health();
    LIVE.robots
        .spawn(async move { while health.changed().await.is_ok() {} });
}

/// Does what takes the interpreter on a thread that Python does not know. `None` once it exits:
/// threads that it takes by surprise would be torn out of the middle of what they do.
pub(crate) fn in_python<T>(work: impl FnOnce(Python<'_>) -> T) -> Option<T> {
    let is_open = LIVE
        .interpreter
        .read()
        .unwrap_or_else(PoisonError::into_inner);
    is_open.then(|| Python::attach(work))
}

/// Has `atexit` call [`shut_down`], before the interpreter is taken apart.
pub(crate) fn register(py: Python<'_>) -> PyResult<()> {
    let function = wrap_pyfunction!(shut_down, py)?;
    py.import("atexit")?.call_method1("register", (function,))?;
    Ok(())
}

/// Brakes every robot and closes its connection; waits for that for a bounded time. In a forked
/// child it does nothing: the robots are the parent's.
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

/// A motion brakes within a quarter of a second; a robot that does not answer is given up after
/// two.
const BRAKED: Duration = Duration::from_secs(4);

/// What has the interpreter then delivers a result, or is code of the program that may take any
/// time.
const GIVEN_BACK: Duration = Duration::from_secs(1);
