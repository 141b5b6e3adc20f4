//! The modules of franka-rt that threads share, with the atomics and locks of loom in place of the
//! standard library's. They need no other module of their crate.
#![cfg(test)]
#![allow(dead_code, reason = "not all of it takes part in an interleaving")]
#![allow(unreachable_pub, reason = "what franka-rt exports is exported there")]

#[path = "../../../franka-rt/src/thread/handoff.rs"]
mod handoff;
#[path = "../../../franka-rt/src/thread/lifetime.rs"]
mod lifetime;
#[path = "../../../franka-rt/src/slot.rs"]
mod slot;
#[path = "../../../franka-rt/src/state_wakeups.rs"]
mod state_wakeups;
#[path = "../../../franka-rt/src/team.rs"]
mod team;
#[path = "../../../franka-rt/src/together.rs"]
mod together;

#[cfg(not(loom))]
compile_error!("without cfg(loom) a test would explore a single interleaving");

mod interleavings;
