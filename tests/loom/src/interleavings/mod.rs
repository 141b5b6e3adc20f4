//! Every interleaving of the data that crosses threads, and every value that the memory model
//! permits a load to return.
//!
//! | module | crossing |
//! |---|---|
//! | [`slot`] | newest values for several readers: states out |
//! | [`triple_buffer`] | newest values for one reader: goals in |
//! | [`handoff`] | the cycle, lent to a thread of the user's |
//! | [`event_fd`] | wake-ups, and the end of the thread |
//! | [`together`] | motions of several robots that begin together, or not at all |
//! | [`team`] | motions of several robots that begin together, again and again, and stop together |
//! | [`state_wakeups`] | whether to send a wake-up for every state |
//!
//! The queues are rtrb's and not explored here: nothing of ours is inside them, and loom cannot see
//! into a crate that is not built for it. rtrb 0.4 has no loom models; its own tests are written
//! for Miri and the thread sanitizer. Counters and histograms are relaxed on purpose: each number
//! stands for itself, and nothing is concluded from two.

mod event_fd;
mod handoff;
mod slot;
mod state_wakeups;
mod team;
mod together;
mod triple_buffer;
