//! The server over real sockets, before a simulated robot: who gets in, who may move it, and what
//! ends a motion.

mod acting;
mod admission;
mod disturbing;
mod holding;
mod malice;
mod previewing;
mod several;
mod taring;
mod viewer;
mod watching;
