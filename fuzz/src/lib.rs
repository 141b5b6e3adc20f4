//! Fuzz targets of the protocol and of recordings: what they check, and what they start from.
//!
//! Both are the sources of tests of `franka-proto` and `franka-record`, which run them on a fixed
//! sequence of inputs.

#[path = "../../franka-proto/tests/protocol/any_bytes/checks.rs"]
pub mod checks;
#[path = "../../franka-record/tests/recording/any_bytes.rs"]
pub mod recordings;
#[path = "../../franka-proto/tests/protocol/any_bytes/seeds.rs"]
pub mod seeds;
