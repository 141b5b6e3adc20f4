//! External torques on the links.

use franka_model::{JointVector, MassMatrix};

/// Torques that external objects exert on the links over one step: `torque − slope · q̈`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct External {
    /// Torques on the joints, `[N·m]`. Positive torques push the joint towards positive angles.
    pub torque: JointVector,
    /// Resistance of springs and dampers to the change of position and velocity in the step,
    /// `[kg·m²]`. The matrix is symmetric and positive semidefinite. `None` means no resistance.
    pub slope: Option<MassMatrix>,
}

impl External {
    /// Nothing acts on the links.
    pub const NONE: Self = Self {
        torque: franka_model::joint_vector([0.0; 7]),
        slope: None,
    };

    /// Diagonal matrix that resists every acceleration at least as much as the slope.
    #[cfg(feature = "mujoco")]
    pub(super) fn diagonal(&self) -> JointVector {
        let Some(slope) = self.slope else {
            return JointVector::zeros();
        };
        // The matrix minus the slope is diagonally dominant.
        JointVector::from_fn(|i, _| slope.row(i).iter().map(|s| s.abs()).sum())
    }

    /// Sum of two external actions.
    pub(crate) fn and(self, other: &Self) -> Self {
        let slope = match (self.slope, other.slope) {
            (Some(one), Some(another)) => Some(one + another),
            (one, another) => one.or(another),
        };
        Self {
            torque: self.torque + other.torque,
            slope,
        }
    }
}

impl From<JointVector> for External {
    fn from(torque: JointVector) -> Self {
        Self {
            torque,
            slope: None,
        }
    }
}
