//! The lease of an arm: the right of one client at a time to command it. The client has a name, and
//! sends heartbeats to keep the lease.
//!
//! ```text
//!             take                    keep_alive in time
//!  free ────────────────> held ─────────────────────────┐
//!    ^   release, drop,   │  ^──────────────────────────┘
//!    └────── silence ─────┘
//! ```
//!
//! A service through which clients move a robot takes the lease [`Robot::lease`] for each client
//! that should move the arm. The service binds the client's session to the lease with
//! [`Holder::deadman`]. All services of a process that share the robot share its lease, for example
//! a dashboard and a teleoperation service. A second client is refused, with the name of the first
//! one.
//!
//! An open connection alone does not keep the lease: call [`Holder::keep_alive`] only for messages
//! of the client's own program. Two clocks measure the time without such a call. By the robot's
//! clock, the control thread brakes the arm, even if the rest of the process hangs. By the host's
//! clock, the lease becomes free, and later requests of the former holder are refused.
//!
//! The lease restricts clients, not the program itself: a motion that the program begins needs no
//! lease. [`Robot::stop`] needs no lease either, so the service can offer it to every client.
//!
//! Methods take the time as an argument, so a test needs no clock. A time that is earlier than in a
//! previous call is replaced by the latest time so far.
//!
//! # Example
//!
//! ```no_run
//! use std::time::{Duration, Instant};
//!
//! use franka_async::{Engage, Robot};
//!
//! # async fn serve(robot: Robot, mut messages: tokio::sync::mpsc::Receiver<()>) -> anyhow::Result<()> {
//! let silence = Duration::from_millis(300);
//! let holder = robot.lease().take("Ada", silence, Instant::now())?;
//! let arm = robot.engage(Engage::default().deadman(holder.deadman())).await?;
//! while let Some(()) = messages.recv().await {
//!     holder.keep_alive(Instant::now())?;
//!     // ... set goals of `arm` ...
//! }
//! drop(arm); // brakes, and releases the arm
//! holder.release(); // the next client can take the lease
//! # Ok(())
//! # }
//! ```
//!
//! [`Robot::lease`]: crate::Robot::lease
//! [`Robot::stop`]: crate::Robot::stop

pub use crate::lease::{Holder, Lease, Lost, Taken};
