//! Joint reference of a session. Courses move it, and the law follows it.

use franka_model::JointVector;

/// Wanted positions and motion of the joints in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Reference {
    /// Positions, `[rad]`.
    pub(crate) q: JointVector,
    /// Velocities, `[rad/s]`.
    pub(crate) dq: JointVector,
    /// Accelerations, `[rad/s^2]`. Their inertia is fed forward in addition to the law, and the
    /// next generator starts from them.
    pub(crate) ddq: JointVector,
}

impl Reference {
    /// Returns the reference at rest at `q`.
    pub(crate) fn at_rest(q: JointVector) -> Self {
        Self {
            q,
            dq: JointVector::zeros(),
            ddq: JointVector::zeros(),
        }
    }
}
