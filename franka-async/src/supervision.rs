//! Supervised robots: automatic reconnects, recovery, events and health.

pub use crate::supervisor::{Events, Notification};
pub use franka_rt::lifecycle::Differences;
pub use franka_rt::supervision::{
    Backoff, Condition, Event, EventKind, Health, NotRecovered, Policy, Reflex,
};
