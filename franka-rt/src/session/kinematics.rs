//! From a moving pose to moving joints: one step of differential inverse kinematics, inside the joints' bounds.

use franka_model::differential_ik::{DifferentialIk, JointBox, Side};
use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, JointVector, Model, Twist, rotation};

use crate::law::hybrid::Reference;
use crate::session::pose::PoseState;
use crate::session::{Budget, rigid};

/// Nominal length of a cycle, `[s]`.
const CYCLE: f64 = 1e-3;

/// Share of each joint's velocity limit that the reference may use.
const VELOCITY_CAP: f64 = 0.7;

/// How much faster than its budget a joint may move for the sake of a pose. On a straight line near a singular posture
/// joints have to turn fast while the hand hardly moves, which nobody beside the arm expects. At 2 an arm that stretches
/// at the default pace is held back needlessly.
const HASTE: f64 = 3.0;

/// Share of each joint's acceleration limit that the reference may use.
const ACCELERATION_CAP: f64 = 0.9;

/// Distance kept from the ends of each joint's range, `[rad]`.
const POSITION_MARGIN: f64 = 0.05;

/// Deceleration, `[rad/s^2]`, with which a joint has to be able to stop before that margin. Less than half of what the
/// robot's velocity envelope reckons with at joint 2, its gentlest (2.585): the arm is a spring behind the reference and
/// swings past it where it slows down.
const BRAKING: f64 = 1.2;

/// Rate, `[1/s]`, at which an error between the joints and the pose that they follow dies out. It is fed only by
/// rounding and by bounds that bound; a faster rate would turn those into jerks.
const FEEDBACK: f64 = 100.0;

/// Rate, `[1/s]`, at which the free direction of the arm returns to the posture where the motion began.
const POSTURE: f64 = 1.0;

/// Speed of the end effector, `[m/s]`, from which on the posture is followed at the full rate. It fades with the
/// speed, so that an arm at its target rests.
const POSTURE_SPEED: f64 = 0.1;

/// Moves the joints of `reference` towards `pose` for one cycle, and tells whether a bound held any of them back.
pub(super) fn follow(
    model: &Model,
    ee: &EndEffector,
    posture: &JointVector,
    reference: &Reference,
    pose: &PoseState,
    budget: &Budget,
) -> (Reference, bool) {
    let now = rigid(&model.pose(Frame::EndEffector, &reference.q, ee));
    let jacobian = model.zero_jacobian(Frame::EndEffector, &reference.q, ee);
    let offset = pose.pose.translation.vector - now.translation.vector;
    let turn = rotation::error(&pose.pose.rotation, &now.rotation);
    let twist =
        pose.twist + Twist::new(offset.x, offset.y, offset.z, turn.x, turn.y, turn.z) * FEEDBACK;

    let fade = (pose.twist.fixed_rows::<3>(0).norm() / POSTURE_SPEED).min(1.0);
    let back = (posture - reference.q) * (POSTURE * fade);
    let bounds = bounds(model.joint_limits(), reference, budget);
    let solution =
        DifferentialIk::smooth().solve(&jacobian, &twist, &back, &bounds, [Side::Free; 7]);

    let dq = solution.velocity;
    let next = Reference {
        q: reference.q + dq * CYCLE,
        dq,
        ddq: (dq - reference.dq) / CYCLE,
    };
    (next, solution.active != [Side::Free; 7])
}

/// Velocities open to each joint in the next cycle: below the cap, able to stop before the end of its range, and within
/// one cycle's acceleration of the present velocity. Where these contradict each other the acceleration wins: it is
/// what the robot feels at once.
fn bounds(limits: &JointLimits, reference: &Reference, budget: &Budget) -> JointBox {
    let towards = |i: usize, distance: f64| {
        let stopping = (2.0 * BRAKING * (distance - POSITION_MARGIN).max(0.0)).sqrt();
        stopping
            .min(VELOCITY_CAP * limits.velocity[i])
            .min(HASTE * budget.joints[i].velocity)
    };
    let interval = |i: usize| {
        let (q, dq) = (reference.q[i], reference.dq[i]);
        let change = ACCELERATION_CAP * limits.acceleration[i] * CYCLE;
        let open = |v: f64| v.clamp(dq - change, dq + change);
        (
            open(-towards(i, q - limits.lower[i])),
            open(towards(i, limits.upper[i] - q)),
        )
    };
    JointBox::new(
        &JointVector::from_fn(|i, _| interval(i).0),
        &JointVector::from_fn(|i, _| interval(i).1),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;

    #[test]
    fn an_interval_is_never_wider_than_one_cycle_of_acceleration() {
        let limits = Model::fr3().joint_limits();
        let moving = Reference {
            dq: JointVector::from_fn(|i, _| 3.0 - i as f64),
            ..Reference::at_rest(READY)
        };
        let bounds = bounds(limits, &moving, &Budget::of(limits));
        for i in 0..7 {
            let change = ACCELERATION_CAP * limits.acceleration[i] * CYCLE + 1e-12;
            for bound in [bounds.lower()[i], bounds.upper()[i]] {
                assert!((bound - moving.dq[i]).abs() <= change);
            }
        }
    }

    #[test]
    fn a_joint_inside_its_margin_may_only_leave_it() {
        let limits = Model::fr3().joint_limits();
        let mut q = READY;
        q[3] = limits.upper[3] - 0.5 * POSITION_MARGIN;
        let bounds = bounds(limits, &Reference::at_rest(q), &Budget::of(limits));
        assert_eq!(bounds.upper()[3], 0.0);
        assert!(bounds.lower()[3] < 0.0);
    }
}
