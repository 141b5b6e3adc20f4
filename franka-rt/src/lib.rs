//! The real-time half of the driver: one thread per robot, and the modules without I/O that the
//! thread calls.
//!
//! ```text
//! UDP state -> exchange -> Driver::on_state -> [session: goal -> generator -> IK -> law -> guards] -> UDP command
//!                             ^        |
//!         orders, goal slot --+        +--> newest state, records, events -> eventfd
//! ```
//!
//! * [`driver`]: computes the answer to each robot state. It contains the phases of a motion, from
//!   watching to finishing, but no clock and no socket.
//! * [`session`]: target control. Turns goals into one continuous joint-space reference.
//! * [`control`]: commands, and control at 1 kHz by the user's own functions.
//! * [`law`]: joint torques from a reference and a state.
//! * [`identify`]: estimates friction, bias and load of an arm from the records of some motions.
//!   Without I/O.
//! * [`shaping`]: filter, limiter and check of commands, as in the vendor's control loops.
//! * [`lifecycle`]: follows one motion from the first goal to the robot's last reply, across TCP
//!   and UDP. Without I/O.
//! * [`supervision`]: handles lost connections, reconnects, reflexes and recovery. Without I/O.
//! * [`together`]: makes motions of several robots begin at the same time.
//! * [`team`]: combines sessions of several robots. Their motions begin together, and if one robot
//!   has a fault, all of them brake.
//! * [`thread`]: the only loop. It owns the socket and reads the clock.
//! * [`slot`], [`queue`], [`event_fd`], [`state_wakeups`], [`exchange`], [`sched`], [`stats`]: the
//!   parts of the loop. [`stats`] defines when a state is late.
//!
//! Modules with a socket or a thread need Unix; all other modules build everywhere, also for
//! WebAssembly.
//!
//! This crate uses no async runtime, opens no TCP connection, and reads only the files that
//! identify a real-time kernel.

#![cfg_attr(docsrs, feature(doc_cfg))]
// Without the thread, its items are unused.
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
