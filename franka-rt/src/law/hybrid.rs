//! The hybrid impedance law: springs and dampers at the end effector and at the joints, summed in
//! joint space.
//!
//! ```text
//! tau = Kp (q_ref - q) + Kd (g dq_ref - dq) + coriolis
//! Kp  = J' Kx J + Kq        Kd = J' Kxd J + Kqd
//! ```
//!
//! With the reference in joint space the spring at the end effector needs no pose error of its own:
//! `J (q_ref - q)` is that error to first order, and the leash keeps it small. Gravity and friction
//! are compensated by the robot.
//!
//! `g` and the low-pass on `dq_ref` are [`Gains::feedforward`](crate::law::Gains::feedforward) and
//! its cutoff. With [`Gains::project_joint_gains`](crate::law::Gains::project_joint_gains) the
//! torques of `Kq` and `Kqd` pass through the null-space projection of the [operational-space
//! law](crate::law::operational) first.

use franka_model::JointVector;

/// Where the law wants the joints to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Positions, `[rad]`.
    pub q: JointVector,
    /// Velocities, `[rad/s]`.
    pub dq: JointVector,
    /// Accelerations, `[rad/s^2]`, whose inertia is fed forward beside the law, and from which the
    /// next generator starts.
    pub ddq: JointVector,
}

impl Reference {
    /// At rest at `q`.
    pub fn at_rest(q: JointVector) -> Self {
        Self {
            q,
            dq: JointVector::zeros(),
            ddq: JointVector::zeros(),
        }
    }
}
