//! Poses in which a motion is difficult.

use franka_model::{Frame, JointVector, elbow};
use franka_proto::RobotState;

use super::cause::Cause;
use super::commanded::end_effector;
use super::evidence::Evidence;
use super::finding::{Finding, Origin, Quantity, Subject};

/// Returns the singularity near the last desired pose of a Cartesian motion, if any.
pub(super) fn singularity(evidence: &Evidence<'_>) -> Option<Cause> {
    evidence.is_cartesian().then(|| singular_pose(evidence))?
}

/// Returns the singularity near the last desired pose, if any. Near a singularity, small torques
/// look like large forces.
pub(super) fn singular_pose(evidence: &Evidence<'_>) -> Option<Cause> {
    let state = evidence.last_running()?;
    let q = JointVector::from(state.q_d);
    if !q.iter().all(|angle| angle.is_finite()) {
        return None;
    }
    let ee = end_effector(state);
    let jacobian = evidence.model.zero_jacobian(Frame::EndEffector, &q, &ee);
    let gram = jacobian * jacobian.transpose();
    let smallest = gram.symmetric_eigenvalues().min().max(0.0).sqrt();
    (smallest < SINGULAR).then_some(Cause::Singularity {
        smallest,
        stretch: q[3] - elbow::FLIP_ANGLE,
        cycle: state.message_id,
    })
}

/// Returns the position limit towards which the finding's joint moves, if this limit is near.
pub(super) fn limit(evidence: &Evidence<'_>, finding: &Finding) -> Option<Cause> {
    let Subject::Joint(joint) = finding.subject else {
        return None;
    };
    let state = evidence
        .states()
        .find(|state| state.message_id == finding.since)
        .or_else(|| evidence.last_running())?;
    let q = position(state, finding.origin);
    let i = usize::from(joint) - 1;
    let limits = evidence.model.joint_limits();
    let (to_lower, to_upper) = (q[i] - limits.hard_lower[i], limits.hard_upper[i] - q[i]);
    let upper = match finding.quantity {
        Quantity::Velocity => finding.value > 0.0,
        _ => to_upper < to_lower,
    };
    let (lower_speed, upper_speed) = limits.velocity_envelope(&q, 0.0);
    let (distance, speed) = if upper {
        (to_upper, upper_speed[i])
    } else {
        (to_lower, -lower_speed[i])
    };
    let slowed = finding.quantity == Quantity::Velocity && speed < limits.velocity[i];
    (distance < NEAR || slowed).then_some(Cause::Limit {
        joint,
        upper,
        distance,
        speed,
        cycle: state.message_id,
    })
}

fn position(state: &RobotState, origin: Origin) -> JointVector {
    match origin {
        Origin::Measured | Origin::Estimated => state.q,
        Origin::Commanded | Origin::Desired => state.q_d,
    }
    .into()
}

/// Singular value below which a pose counts as singular. Ordinary poses have 0.14 or more.
const SINGULAR: f64 = 0.1;

/// Distance below which a joint is near the end of its range, `[rad]`.
const NEAR: f64 = 0.05;
