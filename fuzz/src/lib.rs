//! Fuzz targets of the protocol, of recordings and of the dashboard: what they check, and what they
//! start from.
//!
//! Most are the sources of tests of `franka-proto`, `franka-record` and `franka-dash`, which run
//! them on fewer inputs. Of the dashboard, only what takes messages is built.

pub mod cassettes;
#[path = "../../franka-proto/tests/protocol/any_bytes/checks.rs"]
pub mod checks;
#[path = "../../franka-record/tests/recording/any_bytes.rs"]
pub mod recordings;
#[path = "../../franka-proto/tests/protocol/any_bytes/seeds.rs"]
pub mod seeds;

#[path = "../../franka-dash/src/any_messages.rs"]
mod any_messages;
#[allow(dead_code, unused_imports)]
#[path = "../../franka-dash/src/request/mod.rs"]
mod request;
#[allow(dead_code)]
#[path = "../../franka-dash/src/viewer_lease/mod.rs"]
mod viewer_lease;

/// Has the lease of a dashboard take messages: see `any_messages`.
pub fn dashboard(bytes: &[u8]) {
    any_messages::check(bytes);
}

/// Messages of every kind that a page sends.
pub fn dashboard_sessions() -> Vec<Vec<u8>> {
    any_messages::seeds()
}
