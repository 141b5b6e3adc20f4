//! Converts moving poses to moving joints, with one step of differential inverse kinematics within
//! the joints' bounds.

use franka_model::differential_ik::{DifferentialIk, JointBox, Side};
use franka_model::{EndEffector, Frame, Jacobian, JointVector, Model, Twist, rotation};
use nalgebra::Matrix6;

use crate::session::guard::joint_bounds::{BoundsReached, Cause, OpenVelocities};
use crate::session::guard::speed_cap::SpeedCap;
use crate::session::pose::MovingPose;
use crate::session::reference::Reference;
use crate::session::{Budget, rigid};
use crate::shaping::CYCLE;

/// Rate at which an error between the joints and their pose decays, `[1/s]`. Only rounding and
/// active bounds cause such errors. A faster rate would turn these errors into jerks.
const FEEDBACK: f64 = 100.0;

/// Posture for the arm's free direction, which the end effector's pose does not determine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Posture {
    q: JointVector,
    /// True if a goal requests the posture. Otherwise the arm only keeps it while the end effector
    /// moves: the rate fades with the speed, so that an arm at its target rests.
    asked: bool,
}

impl Posture {
    /// Rate at which the free direction returns to a kept posture, `[1/s]`.
    const KEPT: f64 = 1.0;

    /// Speed of the end effector above which the rate [`Self::KEPT`] applies in full, `[m/s]`.
    const SPEED: f64 = 0.1;

    /// Rate at which the free direction approaches a requested posture once it is near, `[1/s]`.
    const ASKED: f64 = 4.0;

    /// Greatest share of the joints' budget that the motion to the posture may use.
    const SHARE: f64 = 0.5;

    /// Returns the posture that the arm had when the session began, `[rad]`.
    pub(super) fn kept(q: JointVector) -> Self {
        Self { q, asked: false }
    }

    pub(super) fn asked(q: JointVector) -> Self {
        Self { q, asked: true }
    }

    pub(super) fn is_asked(&self) -> bool {
        self.asked
    }

    /// Returns the velocity at which joints at `q` move to the posture, `[rad/s]`, in steady
    /// motion. The end effector moves at `speed`, `[m/s]`.
    pub(super) fn velocity(
        &self,
        q: &JointVector,
        speed: f64,
        jacobian: &Jacobian,
        budget: &Budget,
    ) -> JointVector {
        if self.asked {
            Self::there(&(self.q - q), jacobian, budget)
        } else {
            self.back(q, speed)
        }
    }

    /// Returns the share of its velocity with which the elbow moves to the posture at `time` after
    /// the start of a motion, `[s]`.
    pub(super) fn begun(&self, time: f64) -> f64 {
        if !self.asked {
            return 1.0;
        }
        let t = time * EASE / CYCLE;
        1.0 - (1.0 + t) * (-t).exp()
    }

    /// Returns the velocity at which joints return to a kept posture, `[rad/s]`.
    fn back(&self, q: &JointVector, speed: f64) -> JointVector {
        (self.q - q) * (Self::KEPT * (speed / Self::SPEED).min(1.0))
    }

    /// Returns the velocity at which joints move to a requested posture that is `away` from them,
    /// `[rad/s]`.
    fn there(away: &JointVector, jacobian: &Jacobian, budget: &Budget) -> JointVector {
        let free = in_null_space(away, jacobian);
        let joints = free.iter().zip(&budget.joints);
        let longest = joints
            .map(|(free, limits)| free.abs() / (Self::SHARE * limits.velocity))
            .fold(0.0, f64::max);
        // Full speed far from the posture and proportional to the distance near it, with a smooth
        // transition.
        free / longest.hypot(1.0 / Self::ASKED)
    }
}

/// Weight of a request below which the posture does not count as requested.
const NEGLIGIBLE: f64 = 1e-6;

/// Returns the part of a joint motion that does not move the end effector.
fn in_null_space(motion: &JointVector, jacobian: &Jacobian) -> JointVector {
    let damped = jacobian * jacobian.transpose() + Matrix6::identity() * SQUARED_DAMPING;
    let moving = damped
        .cholesky()
        .map(|factor| factor.solve(&(jacobian * motion)));
    moving.map_or_else(JointVector::zeros, |moving| {
        motion - jacobian.tr_mul(&moving)
    })
}

/// Square of the damping in the inverse of the Jacobian, for singular postures.
const SQUARED_DAMPING: f64 = 1e-6;

/// Time in which a motion of the arm's free direction fades after poses have taken over from
/// joints, `[s]`.
const FADE: f64 = 0.3;

/// Share of the difference by which each stage of [`Drift::ease`] changes in a cycle. After a
/// change of posture, the elbow begins to move within about 100 ms.
const EASE: f64 = 0.02;

/// Motion of the arm's free direction, which the pose does not determine. It has two parts: the
/// fading rest of a joint motion that a pose has taken over, and the motion to the posture. If one
/// of them changed at once, the joints' velocity would step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift {
    velocity: JointVector,
    cycle: u32,
    /// Distance to the posture, `[rad]`, and weight of its request, each after two low-passes.
    away: [JointVector; 2],
    asked: [f64; 2],
}

impl Drift {
    /// Returns the drift when joints that move at `velocity`, `[rad/s]`, begin to follow a pose.
    pub(super) fn of(velocity: JointVector) -> Self {
        Self {
            velocity,
            cycle: 0,
            away: [JointVector::zeros(); 2],
            asked: [0.0; 2],
        }
    }

    /// True before the first cycle in which the joints follow a pose.
    fn begins(&self) -> bool {
        self.cycle == 0
    }

    /// Returns the share that remains in the next cycle. It falls from 1 to 0, with zero slope at
    /// both ends.
    fn share(&mut self) -> f64 {
        self.cycle = self.cycle.saturating_add(1);
        let gone = (f64::from(self.cycle) * CYCLE / FADE).min(1.0);
        1.0 - gone * gone * (3.0 - 2.0 * gone)
    }

    /// Returns the distance from `q` to `posture`, and the weight of the posture's request, in the
    /// next cycle.
    fn ease(&mut self, posture: &Posture, q: &JointVector) -> (JointVector, f64) {
        let [away, smooth] = &mut self.away;
        *away += (posture.q - q - *away) * EASE;
        *smooth += (*away - *smooth) * EASE;
        let [asked, weight] = &mut self.asked;
        *asked += (f64::from(u8::from(posture.asked)) - *asked) * EASE;
        *weight += (*asked - *weight) * EASE;
        (*smooth, *weight)
    }

    /// Returns the velocity of the joints in the next cycle, `[rad/s]`, along the direction that
    /// the pose leaves free.
    fn step(
        &mut self,
        posture: &Posture,
        q: &JointVector,
        speed: f64,
        jacobian: &Jacobian,
        budget: &Budget,
    ) -> JointVector {
        let kept = posture.back(q, speed);
        let there = if posture.asked || self.asked[1] > NEGLIGIBLE {
            let (away, asked) = self.ease(posture, q);
            kept + (Posture::there(&away, jacobian, budget) - kept) * asked
        } else {
            (self.away, self.asked) = Default::default();
            kept
        };
        let remaining = self.share();
        self.velocity * remaining + there * (1.0 - remaining)
    }
}

/// Moves the joints of `reference` toward `pose` for one cycle. Also returns the bounds that
/// limited them.
pub(super) fn follow(
    model: &Model,
    ee: &EndEffector,
    (posture, speed_cap): (&Posture, Option<SpeedCap<'_>>),
    drift: &mut Drift,
    reference: &Reference,
    pose: &MovingPose,
    budget: &Budget,
) -> (Reference, BoundsReached) {
    let (now, jacobian) = model.pose_and_jacobian(Frame::EndEffector, &reference.q, ee);
    let now = rigid(&now);
    let offset = pose.pose.translation.vector - now.translation.vector;
    let turn = rotation::error(&pose.pose.rotation, &now.rotation);
    // The motion of the pose in this cycle must not count as an error. Otherwise the velocity would
    // step when the joints begin to follow.
    let error =
        Twist::new(offset.x, offset.y, offset.z, turn.x, turn.y, turn.z) - pose.twist * CYCLE;
    let twist = pose.twist + error * FEEDBACK;

    let speed = pose.twist.fixed_rows::<3>(0).norm();
    let takes_over = drift.begins();
    let free = drift.step(posture, &reference.q, speed, &jacobian, budget);
    let limits = model.joint_limits();
    let open: [OpenVelocities; 7] =
        core::array::from_fn(|i| OpenVelocities::of(i, limits, reference, budget, takes_over));
    let bounds = JointBox::new(
        &JointVector::from_fn(|i, _| open[i].lower.velocity),
        &JointVector::from_fn(|i, _| open[i].upper.velocity),
    );
    let solution =
        DifferentialIk::smooth().solve(&jacobian, &twist, &free, &bounds, [Side::Free; 7]);
    let slower =
        speed_cap.and_then(|cap| cap.share(model, &reference.q, &solution.velocity, &jacobian));

    let mut held = BoundsReached {
        speed: slower,
        ..BoundsReached::default()
    };
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
    let dq = match slower {
        Some(share) => bounds.clamp(&(solution.velocity * share)),
        None => solution.velocity,
    };
    let next = Reference {
        // Uses the same rule as a plan of the joints, which may precede. The robot differentiates
        // positions, so it would see another rule as half of the acceleration in one cycle.
        q: reference.q + (reference.dq + dq) * (0.5 * CYCLE),
        dq,
        ddq: (dq - reference.dq) / CYCLE,
    };
    (next, held)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::joints::JointGenerator;
    use franka_model::READY;
    use nalgebra::{Isometry3, Translation3, Vector3};

    /// Returns a pose that continues the motion of `reference`'s end effector.
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
    fn joints_taking_up_their_own_pose_go_on_without_a_kick() {
        for model in [Model::fr3(), Model::fer()] {
            let (ee, budget) = (EndEffector::default(), Budget::of(model.joint_limits()));
            let moving = Reference {
                dq: JointVector::from_fn(|i, _| 0.1 * (i as f64 - 3.0)),
                ..Reference::at_rest(READY)
            };
            let pose = taken_up(model, &ee, &moving);
            let mut drift = Drift::of(moving.dq);
            let (next, held) = follow(
                model,
                &ee,
                (&Posture::kept(READY), None),
                &mut drift,
                &moving,
                &pose,
                &budget,
            );
            assert!(!held.any(), "{held:?}");
            // The rest is the fading drift, and the curvature of the path.
            assert!(next.ddq.amax() < 0.3, "{}", next.ddq);
        }
    }

    /// Returns the greatest jerk of a joint, divided by its limit. It is computed from differences
    /// of positions, as in the robot.
    fn worst_jerk(passed: &[JointVector], model: &Model) -> f64 {
        let jerk = |q: &[JointVector]| (q[3] - (q[2] - q[1]) * 3.0 - q[0]) / CYCLE.powi(3);
        let shares = |q: &[JointVector]| jerk(q).component_div(&model.joint_limits().jerk);
        let worst = |most: f64, q| most.max(shares(q).amax());
        passed.windows(4).fold(0.0, worst)
    }

    #[test]
    fn pose_taking_over_a_joint_plan_keeps_the_jerk_bound() {
        for model in [Model::fr3(), Model::fer()] {
            let (ee, limits) = (EndEffector::default(), model.joint_limits());
            let joints = core::array::from_fn(|i| franka_otg::AxisLimits {
                velocity: limits.velocity[i],
                acceleration: limits.acceleration[i],
                jerk: limits.jerk[i],
            });
            let budget = Budget {
                joints,
                ..Budget::of(limits)
            };
            for (brakes, on) in (0..=4).flat_map(|n| [-1.0, 1.0].map(|on| (n, on))) {
                let dq = JointVector::from_fn(|i, _| [0.2, -0.2][i % 2]);
                let mut reference = Reference {
                    dq,
                    ..Reference::at_rest(READY)
                };
                let mut passed = vec![READY - dq * 2.0 * CYCLE, READY - dq * CYCLE, READY];
                let mut brake = JointGenerator::new(limits, &reference, None, &budget).unwrap();
                for _ in 0..brakes {
                    reference = brake.step();
                    passed.push(reference.q);
                }
                let mut drift = Drift::of(reference.dq);
                for _ in 0..4 {
                    // More than the joints can do, in both directions.
                    let hurried = Reference {
                        dq: dq * (20.0 * on),
                        ..reference
                    };
                    let pose = taken_up(model, &ee, &hurried);
                    let kept = (&Posture::kept(READY), None);
                    (reference, _) =
                        follow(model, &ee, kept, &mut drift, &reference, &pose, &budget);
                    passed.push(reference.q);
                }
                let worst = worst_jerk(&passed, model);
                assert!(worst < 1.0 + 1e-6, "{brakes} cycles, {on}: {worst}");
            }
        }
    }

    #[test]
    fn drift_of_a_joint_motion_fades_without_a_step() {
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
