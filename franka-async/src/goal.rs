//! Goals of target control: targets, limits, gains, chunks, guards.

pub use crate::destination::Destination;
pub use franka_otg::AxisLimits;
pub use franka_rt::law::{Gains, Law};
pub use franka_rt::lifecycle::Tuning;
pub use franka_rt::session::{
    Backend, Budget, Chunk, Deadman, DeadmanMonitor, ForceCap, Free, JOINT_DEVIATION, JOINT_LEASH,
    KEEP_OUT_MAX, KEEP_OUT_STOP, Lead, Margin, OnTimeout, ROTATION_DEVIATION, ROTATION_LEASH,
    SELF_STOP, SLOW_ZONE, STALL_TIMEOUT, Setpoints, TRANSLATION_DEVIATION, TRANSLATION_LEASH,
    Target, Tolerance, VELOCITY_BARRIER_ONSET, Waypoint,
};
