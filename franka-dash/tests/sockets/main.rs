//! The server over real sockets, with a simulated robot: admission, commands, and the ends of
//! motions.

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
