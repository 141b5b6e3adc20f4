//! Settings of the robot: see [`Robot::set_load`](crate::Robot::set_load) and similar methods.

pub use franka_proto::{CollisionBehavior, Filters, Load, VirtualWall};
