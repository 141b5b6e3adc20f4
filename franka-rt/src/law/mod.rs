//! Control laws: joint torques from the error between a reference and a state.
//!
//! ```text
//! Gains -> BlendedGains -> Fade -------+-> wrench at the end effector: hybrid or operational -> J' --+
//! errors of q and dq -----------------+-> springs and dampers of the joints -> null space ---------+-> Interaction
//! springs, dq_ref ----------------------> Compensation of friction and bias
//! ```
//!
//! [`Gains`] are the request of a goal. `blended_gains` holds the same as numbers, with choices as
//! weights, so that `fade` changes continuously from one goal's gains to the next. `interaction`
//! turns them into torques by either law. The two laws differ in the wrench at the end effector and
//! in where the springs of the joints act. `compensation` adds torques that springs cannot exert,
//! against friction and an undeclared load. The session's guards bound these torques.
//!
//! # The hybrid law
//!
//! Springs and dampers at the end effector and at the joints, summed in joint space:
//!
//! ```text
//! tau = Kp (q_ref - q) + Kd (g dq_ref - dq) + coriolis
//! Kp  = J' Kx J + Kq        Kd = J' Kxd J + Kqd
//! ```
//!
//! The reference is in joint space, so the spring at the end effector needs no separate pose error:
//! `J (q_ref - q)` is that error to first order, and the leash keeps it small. The robot
//! compensates gravity, and part of the friction.
//!
//! `g` is [`Gains::feedforward`]; its cutoff sets the low-pass on `dq_ref`. With
//! [`Gains::project_joint_gains`] the torques of `Kq` and `Kqd` first pass through the null-space
//! projection of the [operational-space law](operational).

pub(crate) mod blended_gains;
pub(crate) mod compensation;
pub(crate) mod fade;
mod gains;
pub(crate) mod interaction;
pub mod operational;
pub(crate) mod task_space;

pub use gains::{GainError, Gains, Law};
