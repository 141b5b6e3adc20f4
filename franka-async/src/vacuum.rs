//! The vacuum gripper, which has a connection of its own.

pub use crate::vacuum_gripper::VacuumGripper;
pub use franka_proto::vacuum::{DeviceStatus, Profile, State, Vacuum};
