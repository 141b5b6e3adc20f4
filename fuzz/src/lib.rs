//! Fuzz targets of the protocol: what they check, and what they start from.
//!
//! Both are the sources of a test of `franka-proto`, which runs them on a fixed sequence of inputs.

#[path = "../../franka-proto/tests/protocol/any_bytes/checks.rs"]
pub mod checks;
#[path = "../../franka-proto/tests/protocol/any_bytes/seeds.rs"]
pub mod seeds;
