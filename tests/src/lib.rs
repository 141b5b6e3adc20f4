//! What the cross-crate suites share: golden vectors and the measuring frame of the benchmarks.
//!
//! | module | what it is |
//! |---|---|
//! | [`golden`] | the crates against stored vectors: wire bytes, model numbers, trajectories |

pub mod golden;
