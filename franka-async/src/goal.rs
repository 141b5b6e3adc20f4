//! Goals of target control: targets, limits, gains, chunks, guards.

pub use crate::destination::Destination;
pub use franka_otg::AxisLimits;
pub use franka_rt::law::{Gains, Law};
pub use franka_rt::lifecycle::Tuning;
pub use franka_rt::session::{
    Backend, Budget, Chunk, Controller, Deadman, DeadmanMonitor, Deviation, ForceCap, Free,
    KEEP_OUT_MAX, KEEP_OUT_STOP, Lead, Leash, Margin, OnTimeout, SELF_STOP, SLOW_ZONE,
    STALL_TIMEOUT, Setpoints, Settling, Target, Tolerance, VELOCITY_BARRIER_ONSET, Waypoint,
    target_range, target_range_of,
};
