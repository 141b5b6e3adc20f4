//! Cartesian impedance control.

use franka_model::{
    Dynamics, EndEffector, Frame, Jacobian, JointVector, MassMatrix, Model, Twist, rotation,
    transform,
};
use nalgebra::{Cholesky, Isometry3, SMatrix};

use super::{Law, Spring};
use crate::signal::{JointSignal, stack};

#[derive(Debug, Clone, Copy)]
pub(crate) struct Firmness {
    /// Stiffness of the stiffness frame, in its axes, `[N/m, N·m/rad]`.
    pub(crate) task: Twist,
    /// Stiffness of joint motions that do not move the end effector, `[N·m/rad]`.
    pub(crate) posture: f64,
}

/// A spring and critical damper between the stiffness frame and its desired pose, and a joint
/// spring in the null space.
///
/// `pose` is the desired pose of the end effector, `desired` are the joint positions for this pose,
/// and `q` are the current joint positions.
#[allow(clippy::too_many_arguments)] // the two halves of the error and their inputs
pub(crate) fn cartesian_impedance(
    firmness: &Firmness,
    pose: &Isometry3<f64>,
    desired: &JointSignal,
    q: &JointVector,
    model: &Model,
    frames: &EndEffector,
    dynamics: &Dynamics,
    armature: &JointVector,
) -> Law {
    let jacobian = model.body_jacobian(Frame::Stiffness, q, frames);
    let error = stiffness_frame_error(pose, q, model, frames);
    let mut inertia = dynamics.mass;
    for i in 0..7 {
        inertia[(i, i)] += armature[i];
    }

    let task_stiffness = SMatrix::<f64, 6, 6>::from_diagonal(&firmness.task);
    let damping = task_damping(&firmness.task, &jacobian, &inertia);
    let task_damping = SMatrix::<f64, 6, 6>::from_diagonal(&damping);
    let free = null_space(&jacobian);

    let to_pose = jacobian.tr_mul(&(task_stiffness * error));
    let to_posture = free * ((desired.q - q) * firmness.posture);
    Law {
        feedforward: dynamics.coriolis + inertia * desired.ddq + to_pose + to_posture,
        spring: Some(Spring {
            stiffness: jacobian.tr_mul(&(task_stiffness * jacobian)) + free * firmness.posture,
            damping: jacobian.tr_mul(&(task_damping * jacobian))
                + free * (firmness.posture * POSTURE_DAMPING),
            q: *q,
            dq: desired.dq,
        }),
    }
}

/// Error of the stiffness frame, in its own axes, `[m, rad]`.
fn stiffness_frame_error(
    pose: &Isometry3<f64>,
    q: &JointVector,
    model: &Model,
    frames: &EndEffector,
) -> Twist {
    let actual = transform::isometry(&model.pose(Frame::Stiffness, q, frames));
    let offset = transform::isometry(&frames.ee_t_k);
    // Frames are rigid transforms, because setters refuse all others.
    let (Some(actual), Some(offset)) = (actual, offset) else {
        return Twist::zeros();
    };
    let target = pose * offset;
    let back = actual.rotation.inverse();
    stack(
        &(back * (target.translation.vector - actual.translation.vector)),
        &(back * rotation::error(&target.rotation, &actual.rotation)),
    )
}

/// Critical damping of each axis for the inertia along this axis alone, `1 / (J M⁻¹ Jᵀ)_ii`.
fn task_damping(stiffness: &Twist, jacobian: &Jacobian, inertia: &MassMatrix) -> Twist {
    let Some(factor) = Cholesky::new(*inertia) else {
        return Twist::zeros();
    };
    let mobility = (jacobian * factor.solve(&jacobian.transpose())).diagonal();
    Twist::from_fn(|i, _| 2.0 * (stiffness[i] / mobility[i].max(MOBILITY_MIN)).sqrt())
}

/// The orthogonal projector onto joint motions that do not move the end effector.
fn null_space(jacobian: &Jacobian) -> MassMatrix {
    let mut gram = jacobian * jacobian.transpose();
    for i in 0..6 {
        gram[(i, i)] += GRAM_DAMPING;
    }
    match Cholesky::new(gram) {
        Some(factor) => MassMatrix::identity() - jacobian.tr_mul(&factor.solve(jacobian)),
        None => MassMatrix::zeros(),
    }
}

/// Posture stiffness in a motion, `[N·m/rad]`: a choice of the simulator, low in comparison with
/// the joint impedance.
pub(crate) const POSTURE_STIFFNESS: f64 = 50.0;

/// Damping per stiffness, `[s]`. At 50 N·m/rad, it overdamps the arm's inertia of 1 to 2 kg·m².
const POSTURE_DAMPING: f64 = 0.4;

/// Smallest mobility, `[1/kg, 1/(kg·m²)]`, because the apparent inertia grows without bound near a
/// singularity.
const MOBILITY_MIN: f64 = 0.02;

/// Term that keeps the projector finite in a singularity.
const GRAM_DAMPING: f64 = 1e-8;
