//! The real-time half of the driver: one thread per robot, and the pure cores that it drives.
//!
//! ```text
//! UDP state -> exchange -> Driver::on_state -> [session: goal -> generator -> IK -> law -> guards] -> UDP command
//!                             ^        |
//!         orders, goal slot --+        +--> newest state, records, events -> eventfd
//! ```
//!
//! * [`driver`]: the answer to one robot state; phases from watching to finishing. No clock, no
//!   socket.
//! * [`session`]: target control: goals in, one continuous joint-space reference out.
//! * [`control`]: commands, and control at 1 kHz by the user's own functions.
//! * [`law`]: joint torques from a reference and a state.
//! * [`identify`]: friction, bias and load of an arm, from the records of some motions. Pure.
//! * [`shaping`]: filter, limiter and check of commands, as the vendor's control loops take them.
//! * [`lifecycle`]: one motion from the first goal to the robot's last reply, across TCP and UDP.
//!   Without I/O.
//! * [`supervision`]: lost connections, reconnects, reflexes and recovery. Without I/O.
//! * [`together`]: motions of several robots that begin at the same time. [`team`]: sessions of
//!   several robots whose motions begin together, and brake together for a fault of one.
//! * [`thread`]: the only loop; the only place with a socket and a clock.
//! * [`slot`], [`queue`], [`event_fd`], [`state_wakeups`], [`exchange`], [`sched`], [`stats`]: the
//!   parts of the loop. [`stats`] defines when a state is late.
//!
//! Modules with a socket or a thread need Unix; all others build everywhere, also for WebAssembly.
//!
//! This crate uses no async runtime, opens no TCP connection, and reads only the files that
//! identify a real-time kernel.

#![cfg_attr(docsrs, feature(doc_cfg))]
// Items that only the thread uses.
#![cfg_attr(not(unix), allow(dead_code, unused_imports))]

pub mod control;
pub mod driver;
#[cfg(unix)]
pub mod event_fd;
#[cfg(unix)]
pub mod exchange;
pub mod identify;
pub mod law;
pub mod lifecycle;
pub mod panic;
pub mod queue;
pub mod sched;
pub mod session;
pub mod shaping;
pub mod slot;
pub mod state_wakeups;
pub mod stats;
pub mod supervision;
#[cfg(unix)]
mod sys;
pub mod tare;
pub mod team;
#[cfg(unix)]
pub mod thread;
pub mod together;
pub mod triple_buffer;

// The program in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
