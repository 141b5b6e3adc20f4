//! The same names for programs without async: [`Wait::wait`] in the place of `.await`.
//!
//! ```no_run
//! use franka_async::blocking::Wait;
//! use franka_async::{Engage, Pose, Robot};
//!
//! # fn run() -> Result<(), Box<dyn std::error::Error>> {
//! let robot = Robot::connect("172.16.0.2").wait()?;
//! let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
//! robot.move_to(up).speed(0.5).wait()?;
//!
//! let arm = robot.engage(Engage::default()).wait()?;
//! for step in 0..100 {
//!     // Never waits: for loops at a rate of their own.
//!     arm.try_set(Pose::translation(0.0, 1e-3 * f64::from(step), 0.0) * up)?;
//!     std::thread::sleep(std::time::Duration::from_millis(10));
//! }
//! arm.disengage().wait()?;
//! robot.shutdown().wait();
//! # Ok(())
//! # }
//! ```
//!
//! The tasks of a connection run on a thread in the background, one for all connections of the
//! process. It is started by the first wait.

use std::future::IntoFuture;
use std::sync::OnceLock;
use std::time::Duration;

use tokio::runtime::{Builder, Runtime};

/// Waits for a future on the calling thread. For everything in this crate that can be awaited.
pub trait Wait: IntoFuture + Sized {
    /// Waits until the future resolves.
    ///
    /// # Panics
    /// On a thread that runs async tasks, which it would block: `.await` it there. If the system
    /// starts no thread for the background.
    fn wait(self) -> Self::Output {
        background().block_on(self.into_future())
    }

    /// Waits for `timeout` at most. After that the future is dropped, which brakes the arm if it is
    /// a motion, and this returns `None`.
    ///
    /// # Panics
    /// As [`Self::wait`].
    fn wait_for(self, timeout: Duration) -> Option<Self::Output> {
        let future = self.into_future();
        // The timer begins within the runtime.
        background().block_on(async move { tokio::time::timeout(timeout, future).await.ok() })
    }
}

impl<F: IntoFuture> Wait for F {}

fn background() -> &'static Runtime {
    static BACKGROUND: OnceLock<Runtime> = OnceLock::new();
    BACKGROUND.get_or_init(|| {
        Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("franka-async")
            .enable_all()
            .build()
            .expect("a thread for the background")
    })
}
