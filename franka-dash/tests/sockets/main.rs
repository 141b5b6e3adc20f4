//! The server over real sockets, before a simulated robot: who gets in, who may move it, and what
//! ends a motion.

mod admission;
mod holding;
mod viewer;
mod watching;
