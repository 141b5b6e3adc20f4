//! Limits for motions in which no point of the arm may exceed a given speed.

use franka_async::goal::Budget;
use franka_async::model::Model;
use franka_async::model::geometry::{FLANGE, Lengths};
use franka_async::nalgebra::Vector3;
use franka_async::state::RobotState;

/// Half the width of a hand, `[m]`. This is more than the radius of any link.
const BODY: f64 = 0.11;

/// Returns the largest distance that any point of an arm with these lengths can have from the axis
/// of each joint, in any posture, `[m]`. It is the sum of the lengths after the joint, with a tool
/// that extends `tool` from the flange.
fn reach(lengths: &Lengths, tool: f64) -> [f64; 7] {
    let origins = lengths.joint_origins();
    let mut rest = FLANGE + tool + BODY;
    let mut reach = [rest; 7];
    for joint in (0..6).rev() {
        rest += origins[joint + 1].translation.norm();
        reach[joint] = rest;
    }
    reach
}

fn tool_length(state: &RobotState) -> f64 {
    Vector3::new(state.F_T_EE[12], state.F_T_EE[13], state.F_T_EE[14]).norm()
}

/// Returns the limits for a joint motion with the displacement `way`, `[rad]`, in which no point of
/// the arm is faster than `speed`, `[m/s]`. Each joint's share of the speed equals its share of the
/// displacement.
pub(crate) fn joints(model: &Model, state: &RobotState, way: [f64; 7], speed: f64) -> Budget {
    let reach = reach(model.lengths(), tool_length(state));
    let way = way.map(|joint| joint.abs().max(SHORTEST));
    let swept: f64 = (0..7).map(|i| way[i] * reach[i]).sum();
    let mut budget = Budget::of(model.joint_limits());
    for (joint, way) in budget.joints.iter_mut().zip(way) {
        joint.velocity = joint.velocity.min(speed * way / swept);
    }
    budget
}

/// Returns the limits for an end effector that moves at `speed`, `[m/s]`. In a rotation, points at
/// [`TURNING_RADIUS`] have this speed. These limits apply only to the end effector. The session's
/// speed cap applies to the rest of the arm.
pub(crate) fn end_effector_at(model: &Model, speed: f64) -> Budget {
    let mut budget = Budget::of(model.joint_limits());
    budget.translation.velocity = speed;
    budget.rotation.velocity = speed / TURNING_RADIUS;
    budget
}

/// Smallest displacement of a joint in the computation, `[rad]`. It is not zero because velocities
/// must be above zero.
const SHORTEST: f64 = 1e-3;

/// Distance from the end effector at which points have the requested speed during a rotation,
/// `[m]`.
pub(crate) const TURNING_RADIUS: f64 = 0.25;

#[cfg(test)]
mod tests {
    use franka_async::READY;
    use franka_async::model::collision::Shape;
    use franka_async::model::{EndEffector, Frame, JointVector, RobotKind};

    use super::*;

    /// Returns postures over the whole ranges of the joints, from a repeatable sequence.
    fn postures(model: &Model) -> impl Iterator<Item = JointVector> + '_ {
        let limits = model.joint_limits();
        (0..500u32).map(|k| {
            JointVector::from_fn(|i, _| {
                let share =
                    (f64::from(k) * [0.618, 0.755, 0.57, 0.819, 0.43, 0.91, 0.33][i]).fract();
                limits.lower[i] + share * (limits.upper[i] - limits.lower[i])
            })
        })
    }

    #[test]
    fn reach_covers_every_point_of_the_guard_capsules() {
        let model = Model::fr3();
        let reach = reach(model.lengths(), 0.1034);
        for q in postures(model) {
            let placed = Shape::covering(RobotKind::Fr3).with_hand().at(&q);
            for (joint, reach) in reach.iter().enumerate() {
                let pose = model.pose(Frame::ALL[joint], &q, &EndEffector::default());
                let (origin, axis) = (pose.fixed_view::<3, 1>(0, 3), pose.fixed_view::<3, 1>(0, 2));
                for (body, capsule) in placed.capsules() {
                    if usize::from(body.number()) <= joint {
                        continue; // this joint does not move it
                    }
                    for end in [capsule.start, capsule.end] {
                        let off = (end - origin).cross(&axis).norm();
                        // Uses the axis of the capsule, because links are thinner than their
                        // capsules.
                        assert!(off <= *reach, "{body:?} {joint} {off}");
                    }
                }
            }
        }
    }

    #[test]
    fn joints_at_their_budgets_move_nothing_faster_than_asked() {
        let model = Model::fr3();
        for (k, q) in postures(model).enumerate() {
            let way: [f64; 7] = (q - READY).into();
            let state = RobotState::default();
            let speed = 0.01 + 0.24 * (k as f64 / 500.0);
            let budget = joints(model, &state, way, speed);
            let dq = JointVector::from_fn(|i, _| budget.joints[i].velocity * way[i].signum());
            let fastest = model.fastest_point(&q, &dq, &EndEffector::default());
            assert!(fastest <= speed && fastest > 0.0, "{fastest} above {speed}");
        }
    }
}
