//! Joint reference of a session. A course moves the reference, and the control law follows it.

use franka_model::JointVector;

/// Desired positions, velocities and accelerations of the joints in one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Reference {
    /// Positions, `[rad]`.
    pub(crate) q: JointVector,
    /// Velocities, `[rad/s]`.
    pub(crate) dq: JointVector,
    /// Accelerations, `[rad/s^2]`. The law adds the torques that they need, and the next generator
    /// starts from them.
    pub(crate) ddq: JointVector,
}

impl Reference {
    pub(crate) fn at_rest(q: JointVector) -> Self {
        Self {
            q,
            dq: JointVector::zeros(),
            ddq: JointVector::zeros(),
        }
    }
}
