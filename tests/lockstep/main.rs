//! Motions in lockstep: no sockets, no sleeps, every run the same.

mod endings;
mod goals;
mod random_targets;
