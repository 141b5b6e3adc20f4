//! The Franka Hand, which has a connection of its own.

pub use crate::franka_hand::Gripper;
pub use franka_proto::gripper::{Grasp, State};
