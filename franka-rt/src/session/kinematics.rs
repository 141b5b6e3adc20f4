//! From a moving pose to moving joints: one step of differential inverse kinematics, inside the
//! joints' bounds.

use franka_model::differential_ik::{DifferentialIk, JointBox, Side};
use franka_model::{EndEffector, Frame, JointVector, Model, Twist, rotation};

use crate::session::guard::joint_bounds::{BoundsReached, Cause, OpenVelocities};
use crate::session::pose::MovingPose;
use crate::session::reference::Reference;
use crate::session::{Budget, rigid};
use crate::shaping::CYCLE;

/// Rate, `[1/s]`, at which an error between the joints and the pose that they follow dies out. It
/// is fed only by rounding and by bounds that bound; a faster rate would turn those into jerks.
const FEEDBACK: f64 = 100.0;

/// Rate, `[1/s]`, at which the free direction of the arm returns to the posture where the motion
/// began.
const POSTURE: f64 = 1.0;

/// Speed of the end effector, `[m/s]`, from which on the posture is followed at the full rate. It
/// fades with the speed, so that an arm at its target rests.
const POSTURE_SPEED: f64 = 0.1;

/// Time, `[s]`, in which a motion of the arm's free direction fades that a pose takes over from
/// joints.
const FADE: f64 = 0.3;

/// What is left of a motion over the joints that a pose has taken over: its part in the arm's free
/// direction, which the pose says nothing about. It fades; dropped at once it would step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift {
    velocity: JointVector,
    cycle: u32,
}

impl Drift {
    /// Of joints that move at `velocity`, `[rad/s]`.
    pub(super) fn of(velocity: JointVector) -> Self {
        Self { velocity, cycle: 0 }
    }

    /// The share that remains in the next cycle: from 1 to 0, at either end without a slope.
    fn share(&mut self) -> f64 {
        self.cycle = self.cycle.saturating_add(1);
        let gone = (f64::from(self.cycle) * CYCLE / FADE).min(1.0);
        1.0 - gone * gone * (3.0 - 2.0 * gone)
    }
}

/// Moves the joints of `reference` towards `pose` for one cycle. Returns also which bounds held
/// them back.
pub(super) fn follow(
    model: &Model,
    ee: &EndEffector,
    posture: &JointVector,
    drift: &mut Drift,
    reference: &Reference,
    pose: &MovingPose,
    budget: &Budget,
) -> (Reference, BoundsReached) {
    let (now, jacobian) = model.pose_and_jacobian(Frame::EndEffector, &reference.q, ee);
    let now = rigid(&now);
    let offset = pose.pose.translation.vector - now.translation.vector;
    let turn = rotation::error(&pose.pose.rotation, &now.rotation);
    // The motion of the pose in this cycle is not an error. Counted as one, it would make the
    // velocity step where following begins.
    let error =
        Twist::new(offset.x, offset.y, offset.z, turn.x, turn.y, turn.z) - pose.twist * CYCLE;
    let twist = pose.twist + error * FEEDBACK;

    let fade = (pose.twist.fixed_rows::<3>(0).norm() / POSTURE_SPEED).min(1.0);
    let back = (posture - reference.q) * (POSTURE * fade);
    let remaining = drift.share();
    let free = drift.velocity * remaining + back * (1.0 - remaining);
    let open: [OpenVelocities; 7] =
        core::array::from_fn(|i| OpenVelocities::of(i, model.joint_limits(), reference, budget));
    let bounds = JointBox::new(
        &JointVector::from_fn(|i, _| open[i].lower.velocity),
        &JointVector::from_fn(|i, _| open[i].upper.velocity),
    );
    let solution =
        DifferentialIk::smooth().solve(&jacobian, &twist, &free, &bounds, [Side::Free; 7]);

    let mut held = BoundsReached::default();
    for (side, open) in solution.active.into_iter().zip(&open) {
        let cause = match side {
            Side::Free => continue,
            Side::Lower => open.lower.cause,
            Side::Upper => open.upper.cause,
        };
        match cause {
            Cause::Velocity => held.velocity = true,
            Cause::Position => held.position = true,
            Cause::Acceleration => held.acceleration = true,
        }
    }
    let dq = solution.velocity;
    let next = Reference {
        // The same rule as in a plan of the joints, which may have come before: the robot
        // differences positions, and would see a change of rule as half of the acceleration in one
        // cycle.
        q: reference.q + (reference.dq + dq) * (0.5 * CYCLE),
        dq,
        ddq: (dq - reference.dq) / CYCLE,
    };
    (next, held)
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;
    use nalgebra::{Isometry3, Translation3, Vector3};

    /// A pose that moves on from that of `reference` as its joints move it.
    fn taken_up(model: &Model, ee: &EndEffector, reference: &Reference) -> MovingPose {
        let twist = model.zero_jacobian(Frame::EndEffector, &reference.q, ee) * reference.dq;
        let now = rigid(&model.pose(Frame::EndEffector, &reference.q, ee));
        let turn = Vector3::new(twist[3], twist[4], twist[5]) * CYCLE;
        MovingPose {
            pose: Isometry3::from_parts(
                Translation3::from(
                    now.translation.vector + twist.fixed_rows::<3>(0).into_owned() * CYCLE,
                ),
                rotation::exp(&turn) * now.rotation,
            ),
            twist,
        }
    }

    #[test]
    fn joints_that_begin_to_follow_their_own_pose_go_on_without_a_kick() {
        for model in [Model::fr3(), Model::fer()] {
            let (ee, budget) = (EndEffector::default(), Budget::of(model.joint_limits()));
            let moving = Reference {
                dq: JointVector::from_fn(|i, _| 0.1 * (i as f64 - 3.0)),
                ..Reference::at_rest(READY)
            };
            let pose = taken_up(model, &ee, &moving);
            let mut drift = Drift::of(moving.dq);
            let (next, held) = follow(model, &ee, &READY, &mut drift, &moving, &pose, &budget);
            assert!(!held.any(), "{held:?}");
            // What is left is the fading drift, and the curvature of the way.
            assert!(next.ddq.amax() < 0.3, "{}", next.ddq);
        }
    }

    #[test]
    fn what_is_left_of_a_motion_over_the_joints_fades_without_a_step() {
        let mut drift = Drift::of(JointVector::repeat(1.0));
        let mut last = 1.0;
        for _ in 0..300 {
            let share = drift.share();
            assert!(share <= last && last - share < 1.5 * CYCLE / FADE + 1e-12);
            last = share;
        }
        assert!(last < 1e-9);
        assert!(drift.share() < 1e-12);
    }
}
