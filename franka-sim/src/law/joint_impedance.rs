//! Joint impedance control.

use franka_model::{Dynamics, JointVector, MassMatrix};

use super::{Law, Spring};
use crate::signal::JointSignal;

/// For each joint, a spring and a critical damper towards `desired`, in addition to the torques for
/// the desired motion.
///
/// `stiffness` in `[N·m/rad]`, `armature` in `[kg·m²]`. The damping is critical for the joint's own
/// inertia, `2 √(K (M_ii + armature))`.
pub(crate) fn joint_impedance(
    stiffness: &JointVector,
    desired: &JointSignal,
    dynamics: &Dynamics,
    armature: &JointVector,
) -> Law {
    let inertia = dynamics.mass.diagonal() + armature;
    let damping = stiffness
        .component_mul(&inertia)
        .map(|product| 2.0 * product.sqrt());
    let accelerate = dynamics.mass * desired.ddq + armature.component_mul(&desired.ddq);
    Law {
        feedforward: dynamics.coriolis + accelerate,
        spring: Some(Spring {
            stiffness: MassMatrix::from_diagonal(stiffness),
            damping: MassMatrix::from_diagonal(&damping),
            q: desired.q,
            dq: desired.dq,
        }),
    }
}
