//! Conditions that end a motion ([`until`](crate::Motion::until)), and the values that were seen
//! when one became true.
//!
//! The control thread looks at the condition in every cycle: however busy the program is, the arm
//! brakes within the next millisecond.

pub use franka_rt::session::condition::{
    Axis, Condition, Quantity, cartesian_contact, collision, contact, elapsed, force, force_x,
    force_y, force_z, joint_contact, joint_torques, torque,
};
pub use franka_rt::session::{Reacted, Reaction};
