//! The joint reference of a session: what its courses move and its law follows.

use franka_model::JointVector;

/// Where the joints are to be in a cycle, and how they are to move there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Reference {
    /// Positions, `[rad]`.
    pub(crate) q: JointVector,
    /// Velocities, `[rad/s]`.
    pub(crate) dq: JointVector,
    /// Accelerations, `[rad/s^2]`. Their inertia is fed forward beside the law, and the next
    /// generator starts from them.
    pub(crate) ddq: JointVector,
}

impl Reference {
    /// At rest at `q`.
    pub(crate) fn at_rest(q: JointVector) -> Self {
        Self {
            q,
            dq: JointVector::zeros(),
            ddq: JointVector::zeros(),
        }
    }
}
