//! Control laws: joint torques from the error between a reference and a state.
//!
//! ```text
//! Gains -> BlendedGains -> Fade -------+-> wrench at the end effector: hybrid or operational -> J' --+
//! errors of q and dq -----------------+-> springs and dampers of the joints -> null space ---------+-> Interaction
//! springs, dq_ref ----------------------> Compensation of friction and bias
//! ```
//!
//! A goal requests [`Gains`]. `blended_gains` converts them to numbers (a choice becomes a weight
//! between 0 and 1), so that `fade` can change them continuously from one goal to the next.
//! `interaction` turns the gains into torques with one of two laws. The two laws compute different
//! wrenches at the end effector, and their joint springs act in different directions.
//! `compensation` adds torques against friction and against an undeclared load, which springs
//! cannot exert. The session's guards bound these torques.
//!
//! # The hybrid law
//!
//! This law adds the torques of springs and dampers at the end effector and at the joints:
//!
//! ```text
//! tau = Kp (q_ref - q) + Kd (g dq_ref - dq) + coriolis
//! Kp  = J' Kx J + Kq        Kd = J' Kxd J + Kqd
//! ```
//!
//! The reference is in joint space, so the spring at the end effector needs no separate pose error:
//! `J (q_ref - q)` is that error to first order, and the leash keeps it small. The robot
//! compensates gravity and part of the friction.
//!
//! `g` is [`Gains::feedforward`]; its cutoff sets the low-pass on `dq_ref`. With
//! [`Gains::project_joint_gains`], the null-space projection of the [operational-space
//! law](operational) is applied to the torques of `Kq` and `Kqd`.

pub(crate) mod blended_gains;
pub(crate) mod compensation;
pub(crate) mod fade;
mod gains;
pub(crate) mod interaction;
pub mod operational;
pub(crate) mod task_space;

pub use gains::{GainError, Gains, Law};
