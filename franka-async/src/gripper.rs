//! The Franka Hand, which has its own connection.

pub use crate::franka_hand::Gripper;
pub use franka_proto::gripper::{Grasp, State};
