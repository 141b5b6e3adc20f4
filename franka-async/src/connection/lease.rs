//! The lease of an arm: one holder at a time commands it, by name, for as long as heartbeats come.
//!
//! ```text
//!             take                    keep_alive in time
//!  free ────────────────> held ─────────────────────────┐
//!    ^   release, drop,   │  ^──────────────────────────┘
//!    └────── silence ─────┘
//! ```
//!
//! A service that passes a robot on to clients takes the lease of [`Robot::lease`] for each client
//! that should move the arm. It binds the client's session to the lease by [`Holder::deadman`]. All
//! services of a process that share the robot share its lease: a dashboard, a teleoperation. A
//! second client is refused with the name of the first.
//!
//! Silence counts, not the connection: only messages of the client's own program should call
//! [`Holder::keep_alive`]. When they stop, two clocks notice. The control thread brakes the arm by
//! the robot's clock, also when the rest of the process hangs. The lease is free by the host's
//! clock, and later requests of the former holder are refused.
//!
//! The lease binds services, not the program itself: a motion that the program begins needs none.
//! Neither does a stop: [`Robot::stop`] is open to every client.
//!
//! Time is an argument, so that a test needs no clock. A time before the newest one counts as that
//! one.
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
