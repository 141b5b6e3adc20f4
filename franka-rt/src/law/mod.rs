//! Control laws: joint torques from the error between a reference and a state.
//!
//! ```text
//! Gains -> BlendedGains -> Fade -------+-> wrench at the end effector: hybrid or operational -> J' --+
//! errors of q and dq -----------------+-> springs and dampers of the joints -> null space ---------+-> Interaction
//! springs, dq_ref ----------------------> Compensation of friction and bias
//! ```
//!
//! [`Gains`] are what a goal asks for. `blended_gains` has the same in numbers, where a choice
//! is a weight, so that `fade` leads from one to the next continuously. `interaction` makes torques
//! of them by either law; the two differ in the wrench at the end effector and in where the springs
//! of the joints act. `compensation` adds what springs cannot do on an arm that sticks or carries
//! what it does not know of. What bounds these torques are guards of the session.
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
//! With the reference in joint space the spring at the end effector needs no pose error of its own:
//! `J (q_ref - q)` is that error to first order, and the leash keeps it small. Gravity is
//! compensated by the robot, and friction in part.
//!
//! `g` and the low-pass on `dq_ref` are [`Gains::feedforward`] and its cutoff. With
//! [`Gains::project_joint_gains`] the torques of `Kq` and `Kqd` pass through the null-space
//! projection of the [operational-space law](operational) first.

pub(crate) mod blended_gains;
pub(crate) mod compensation;
pub(crate) mod fade;
mod gains;
pub(crate) mod interaction;
pub mod operational;
pub(crate) mod task_space;

pub use gains::{GainError, Gains, Law};
