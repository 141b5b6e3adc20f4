//! The steps of `cargo xtask test`, and the parts that the tasks of `xtask-tools` share with them.
//!
//! | module | content |
//! |---|---|
//! | [`peers`] | other clients against the simulator |
//! | [`python`] | virtual environments |
//! | [`realtime`] | the right to real-time scheduling |
//! | [`running`] | programs whose output is read while they run |
//! | [`selection`] | selections of tests by package |
//! | [`step`] | steps with headers, times and a summary |
//! | [`test_steps`] | the steps of `cargo xtask test` |
//! | [`workspace`] | directories of the workspace, and running a program |

pub mod peers;
pub mod python;
pub mod realtime;
pub mod running;
pub mod selection;
pub mod step;
pub mod test_steps;
pub mod workspace;
