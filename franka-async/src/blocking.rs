//! Blocking calls for programs without async: [`Wait::wait`] replaces `.await`, and
//! [`WaitEach::wait_each`] iterates over streams.
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
//! | with async | on a plain thread |
//! |---|---|
//! | a future, `.await` | `.wait()`, or `.wait_for(timeout)` |
//! | a stream of states, events or health, also of end effectors | `for state in robot.states().wait_each()` |
//! | [`Robot::records`](crate::Robot::records) | its `blocking_recv()` |
//! | [`Robot::follow`](crate::Robot::follow) of a `watch` channel | `follow` of a channel that [`targets`] returns |
//! | `set`, of an [`Arm`](crate::Arm) | `try_set`, which never waits |
//! | `state`, `pose`, `target`, `reference`, `stats`; [`Deadman`](crate::goal::Deadman) | the same: none of them waits |
//!
//! Two motions at the same time need two threads, just as they need two tasks in async code. A
//! motion and the sender of its targets also need two threads:
//!
//! ```no_run
//! use franka_async::blocking::{Wait, WaitEach, targets};
//! use franka_async::{Pose, Robot};
//!
//! # fn run(robot: Robot) -> Result<(), Box<dyn std::error::Error>> {
//! let start = robot.pose();
//! let (sender, targets) = targets(start);
//! let following = robot.follow(targets);
//! let following = std::thread::spawn(move || following.wait());
//! for (reading, step) in robot.state_stream().wait_each().zip(0..2000) {
//!     println!("{:?}", reading.state.q);
//!     sender.send(Pose::translation(0.0, 5e-5 * f64::from(step), 0.0) * start);
//! }
//! drop(sender); // the motion ends at the last target
//! following.join().expect("no panic")?;
//! # Ok(())
//! # }
//! ```
//!
//! The tasks of all connections of the process run on one background thread. The first wait starts
//! this thread.

use std::future::IntoFuture;
use std::sync::OnceLock;
use std::time::Duration;

use futures::{Stream, StreamExt};
use tokio::runtime::Runtime;
use tokio::sync::watch;

use crate::world;

/// Extends everything in this crate that can be awaited with methods that wait on the calling
/// thread.
pub trait Wait: IntoFuture + Sized {
    /// Waits until the future resolves.
    ///
    /// # Panics
    /// Panics on a thread that runs async tasks, because the wait would block them: use `.await` on
    /// such a thread. Also panics if the system cannot start the background thread.
    fn wait(self) -> Self::Output {
        background().block_on(self.into_future())
    }

    /// Waits until the future resolves, for at most `timeout`. After `timeout`, drops the future
    /// and returns `None`. Dropping the future of a motion brakes the arm.
    ///
    /// # Panics
    /// Panics as [`Self::wait`] does.
    fn wait_for(self, timeout: Duration) -> Option<Self::Output> {
        let future = self.into_future();
        // The timer needs the runtime.
        background().block_on(async move { world::timeout(timeout, future).await.ok() })
    }
}

impl<F: IntoFuture> Wait for F {}

/// Extends every stream of this crate with iteration on the calling thread.
pub trait WaitEach: Stream + Unpin + Sized {
    /// Returns an iterator over the items of the stream. Each step waits for the next item, and the
    /// iterator ends with the stream.
    ///
    /// # Panics
    /// [`Iterator::next`] panics as [`Wait::wait`] does.
    fn wait_each(self) -> Each<Self> {
        Each(self)
    }
}

impl<S: Stream + Unpin> WaitEach for S {}

/// Iterator over the items of a stream: see [`WaitEach::wait_each`].
#[derive(Debug)]
pub struct Each<S>(S);

impl<S: Stream + Unpin> Iterator for Each<S> {
    type Item = S::Item;

    fn next(&mut self) -> Option<S::Item> {
        background().block_on(self.0.next())
    }
}

/// Sender of targets: a motion that follows the channel reads the newest target. Dropping the
/// sender ends the motion at the last target.
#[derive(Debug)]
pub struct Targets<T>(watch::Sender<T>);

impl<T> Targets<T> {
    /// Replaces the target, even if no motion has read it yet. This never waits. Returns true while
    /// the receiver exists, even if no motion follows it yet.
    pub fn send(&self, target: T) -> bool {
        self.0.send(target).is_ok()
    }
}

/// Returns a sender of targets, and a channel that contains the newest target. The channel begins
/// with the target `first`. Pass the channel to [`Robot::follow`](crate::Robot::follow) or
/// [`Arm::follow`](crate::Arm::follow).
pub fn targets<T>(first: T) -> (Targets<T>, watch::Receiver<T>) {
    let (sender, receiver) = watch::channel(first);
    (Targets(sender), receiver)
}

fn background() -> &'static Runtime {
    static BACKGROUND: OnceLock<Runtime> = OnceLock::new();
    BACKGROUND.get_or_init(|| world::background().expect("a thread for the background"))
}
