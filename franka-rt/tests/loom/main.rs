//! Every interleaving of what crosses threads, and every value that the memory model lets a load
//! return.
//!
//! Run with `cargo xtask test --only loom`, or
//! `RUSTFLAGS="--cfg loom" cargo test --release -p franka-rt --test loom`.
//!
//! | module | crossing |
//! |---|---|
//! | [`slot`] | newest values: goals in, states out |
//! | [`desk`] | the cycle, lent to a thread of the user's |
//! | [`bell`] | "look", and "it has ended" |
//! | [`together`] | motions of several robots that begin together, or not at all |
//! | [`audience`] | whether to ring for every state |
//!
//! The queues are rtrb's and not explored here: nothing of ours is inside them, and loom cannot see
//! into a crate that is not built for it. rtrb 0.4 has no loom models; its own tests are written
//! for Miri and the thread sanitizer. Counters and histograms are relaxed on purpose: each number
//! stands for itself, and nothing is concluded from two.
#![cfg(loom)]

mod audience;
mod bell;
mod desk;
mod slot;
mod together;
