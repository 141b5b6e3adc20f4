//! The vacuum gripper, which has its own connection.

pub use crate::vacuum_gripper::VacuumGripper;
pub use franka_proto::vacuum::{DeviceStatus, Profile, State, Vacuum};
