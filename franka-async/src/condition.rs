//! Conditions that end a motion ([`until`](crate::Motion::until)), and the values that were
//! measured when a condition became true.
//!
//! The control thread checks the condition in every cycle. The arm brakes within the next
//! millisecond, even if the program is busy.

pub use franka_rt::session::condition::{
    Axis, Condition, Quantity, cartesian_contact, collision, contact, elapsed, force, force_x,
    force_y, force_z, joint_contact, joint_torques, torque,
};
pub use franka_rt::session::{Reacted, Reaction};
