//! Every interleaving of the data that crosses threads, and every value that the memory model
//! permits a load to return.
//!
//! | module | crossing |
//! |---|---|
//! | [`slot`] | newest values: states out |
//! | [`handoff`] | the cycle, lent to a thread of the user's |
//! | [`event_fd`] | wake-ups, and the end of the thread |
//! | [`together`] | motions of several robots that begin together, or not at all |
//! | [`team`] | motions of several robots that begin together, again and again, and stop together |
//! | [`state_wakeups`] | whether to send a wake-up for every state |
//!
//! The queues are rtrb's, and goals enter by the crate `triple_buffer`. Neither is explored here:
//! loom cannot see into a crate that is not built for it. rtrb 0.4 and `triple_buffer` 9.0 have no
//! loom models. Their own tests are written for Miri, and rtrb's also for the thread sanitizer.
//! Counters and histograms are relaxed on purpose: each number stands for itself, and nothing is
//! concluded from two.

mod event_fd;
mod handoff;
mod slot;
mod state_wakeups;
mod team;
mod together;
