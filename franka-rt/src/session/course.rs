//! The course of the reference: its planned motion, in joint space or as poses of the end effector.

use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, GRAVITY_EARTH, JointVector, Load, Model};
use franka_otg::{AxisLimits, AxisState, PlanError};

use crate::session::aim::Aim;
use crate::session::chunk::ChunkCourse;
use crate::session::guard::joint_bounds::BoundsReached;
use crate::session::guard::leash::{self, Leash};
use crate::session::guard::speed_cap::SpeedCap;
use crate::session::guide::Guide;
use crate::session::joints::{JointGenerator, MovingJoints};
use crate::session::kinematics::{self, Drift, Posture};
use crate::session::pose::{MovingPose, PoseGenerator, PoseState};
use crate::session::reference::Reference;
use crate::session::running::Measured;
use crate::session::{Budget, Target, budget, rigid};

const _: () = assert!(
    franka_otg::CYCLE == franka_model::CYCLE,
    "generators advance by the control cycle"
);

#[derive(Debug)]
pub(super) enum Course {
    /// The reference stays at rest.
    Rest,
    Joints(JointGenerator),
    Pose(PoseGenerator, Drift),
    Guide(Guide),
    Chunk(ChunkCourse),
}

#[derive(Debug)]
pub(super) struct CourseStep {
    pub(super) reference: Reference,
    /// The bounds that limited joints on the way to a pose.
    pub(super) bounds: BoundsReached,
    /// True if the pose had to wait for joints that could not follow.
    pub(super) held: bool,
    /// True if the course's own leash moved the reference with the arm.
    pub(super) leashed: bool,
    /// True if no plan could be made for a pose that was held back.
    pub(super) failed: bool,
}

impl CourseStep {
    /// Returns a step that no bound limited.
    pub(super) fn free(reference: Reference) -> Self {
        Self {
            reference,
            bounds: BoundsReached::default(),
            held: false,
            leashed: false,
            failed: false,
        }
    }
}

impl Course {
    /// Plans a course to a new aim from the reference's present place and motion.
    ///
    /// A course takes some kilobytes. Therefore, if the kind does not change, the course is planned
    /// anew in place.
    ///
    /// # Errors
    /// Returns a [`PlanError`] only because of a defect, since goals are checked when they are
    /// accepted. The course then continues to its previous aim. This is safe, but the arm stops
    /// short of the new aim.
    pub(super) fn head_for(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        aim: &Aim,
    ) -> Result<(), PlanError> {
        let robot = model.joint_limits();
        match aim.target {
            Target::Rest => self.over_joints(robot, reference, None, aim)?,
            Target::Joints(q) => {
                let target = MovingJoints { q, dq: [0.0; 7] };
                self.over_joints(robot, reference, Some(target), aim)?;
            }
            Target::MovingJoints { q, dq } => {
                self.over_joints(robot, reference, Some(MovingJoints { q, dq }), aim)?;
            }
            Target::Pose(target) => {
                self.over_pose(model, ee, reference, target.into(), aim)?;
            }
            Target::MovingPose { pose, twist } => {
                self.over_pose(model, ee, reference, MovingPose { pose, twist }, aim)?;
            }
            Target::Guide(free) => match self {
                Self::Guide(guide) => guide.free(free),
                Self::Rest | Self::Joints(_) | Self::Pose(..) | Self::Chunk(_) => {
                    let brake = JointGenerator::new(robot, reference, None, &aim.budget)?;
                    *self = Self::Guide(Guide::new(free, brake));
                }
            },
        }
        if aim.paused { self.halt() } else { Ok(()) }
    }

    fn over_joints(
        &mut self,
        robot: &JointLimits,
        reference: &Reference,
        target: Option<MovingJoints>,
        aim: &Aim,
    ) -> Result<(), PlanError> {
        match self {
            Self::Joints(generator) => generator.head_for(robot, reference, target, &aim.budget),
            Self::Rest | Self::Pose(..) | Self::Guide(_) | Self::Chunk(_) => {
                let budget = &aim.budget;
                *self = Self::Joints(JointGenerator::new(robot, reference, target, budget)?);
                Ok(())
            }
        }
    }

    fn over_pose(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        target: MovingPose,
        aim: &Aim,
    ) -> Result<(), PlanError> {
        match self {
            Self::Pose(generator, _) => generator.retarget(target, aim.budget),
            Self::Rest | Self::Joints(_) | Self::Guide(_) | Self::Chunk(_) => {
                let start = end_effector(model, ee, reference);
                let most = model.cartesian_limits();
                let generator = PoseGenerator::new(&start, target, aim.budget, most)?;
                *self = Self::Pose(generator, Drift::of(reference.dq));
                Ok(())
            }
        }
    }

    fn halt(&mut self) -> Result<(), PlanError> {
        match self {
            Self::Joints(generator) => generator.halt(),
            Self::Pose(generator, _) => generator.halt(),
            Self::Rest | Self::Guide(_) | Self::Chunk(_) => Ok(()),
        }
    }

    /// Returns the time from `now` until the target is met, `[s]`. Without a target, returns the
    /// time until rest. Returns zero if neither is planned.
    pub(super) fn remaining(&self, now: u64) -> f64 {
        match self {
            Self::Joints(generator) => generator.remaining(),
            Self::Pose(generator, _) => generator.remaining(),
            Self::Chunk(chunk) => chunk.remaining(now),
            Self::Rest | Self::Guide(_) => 0.0,
        }
    }

    /// Returns the moving pose from which a course of poses starts, and the drift from earlier
    /// motions.
    pub(super) fn pose(
        &self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
    ) -> (PoseState, Drift) {
        let followed = match self {
            Self::Rest | Self::Joints(_) | Self::Guide(_) => None,
            Self::Pose(generator, drift) => Some((generator.state(), *drift)),
            Self::Chunk(chunk) => chunk.pose(),
        };
        followed.unwrap_or_else(|| (end_effector(model, ee, reference), Drift::of(reference.dq)))
    }

    /// Advances by one nominal millisecond, for the answer to the state with `message_id` `now`.
    pub(super) fn step(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        (posture, speed_cap): (&Posture, Option<SpeedCap<'_>>),
        reference: &Reference,
        (arm, leash): (&Measured, &Leash),
        now: u64,
    ) -> CourseStep {
        match self {
            Self::Rest => CourseStep::free(Reference::at_rest(reference.q)),
            Self::Joints(generator) => CourseStep::free(generator.step()),
            Self::Guide(guide) => {
                let (reference, leashed) = guide.step(reference, arm, leash);
                CourseStep {
                    leashed,
                    ..CourseStep::free(reference)
                }
            }
            Self::Chunk(chunk) => chunk.step(model, ee, (posture, speed_cap), reference, now),
            Self::Pose(generator, drift) => {
                let next = generator.step();
                let budget = generator.budget();
                let (reference, bounds) = kinematics::follow(
                    model,
                    ee,
                    (posture, speed_cap),
                    drift,
                    reference,
                    &next,
                    budget,
                );
                let slowed = bounds
                    .speed
                    .map_or(Ok(()), |share| generator.slow_down(share));
                let tethered = if bounds.any() {
                    let reached = rigid(&model.pose(Frame::EndEffector, &reference.q, ee));
                    leash::tether(generator, &reached)
                } else {
                    Ok(false)
                };
                CourseStep {
                    reference,
                    bounds,
                    held: tethered.unwrap_or(true),
                    leashed: false,
                    failed: slowed.and(tethered).is_err(),
                }
            }
        }
    }

    pub(super) fn is_done(&self) -> bool {
        match self {
            Self::Rest => true,
            Self::Joints(generator) => generator.is_done(),
            Self::Pose(generator, _) => generator.is_done(),
            Self::Guide(_) | Self::Chunk(_) => false,
        }
    }
}

/// Returns the positions at which the joints of a moving reference would stop if it braked now,
/// `[rad]`.
pub(super) fn end_of_brake(model: &Model, reference: &Reference, budget: &Budget) -> JointVector {
    let robot = model.joint_limits();
    JointVector::from_fn(|i, _| {
        let state = AxisState {
            position: reference.q[i],
            velocity: reference.dq[i],
            acceleration: reference.ddq[i],
        };
        let limits = limits_of_joint(i, robot, reference, budget.joints[i], true);
        franka_otg::rest_of(state, limits)
    })
}

/// Returns the limits of one joint's plan. They are the limits of the budget, or of `robot` if
/// these are narrower, because a backend may allow less than the robot. A moving joint may exceed
/// the budget in three cases: it only has to stop, it already exceeds the budget, or it would stop
/// too late for the end of its range.
pub(super) fn limits_of_joint(
    i: usize,
    robot: &JointLimits,
    reference: &Reference,
    limits: AxisLimits,
    stop: bool,
) -> AxisLimits {
    let (q, dq, ddq) = (reference.q[i], reference.dq[i], reference.ddq[i]);
    let most = AxisLimits {
        velocity: robot.velocity[i],
        acceleration: robot.acceleration[i],
        jerk: robot.jerk[i],
    };
    let limits = AxisLimits {
        velocity: limits.velocity.min(most.velocity),
        acceleration: limits.acceleration.min(most.acceleration),
        jerk: limits.jerk.min(most.jerk),
    };
    let room = if dq > 0.0 {
        robot.upper[i] - q
    } else {
        q - robot.lower[i]
    };
    // Twice the constant deceleration that stops at the end of the range, because part of the
    // distance passes while the deceleration is built up.
    let last_moment = dq * dq > limits.acceleration * room;
    if stop || last_moment || !budget::keeps(&limits, dq, ddq) {
        let deceleration = if last_moment {
            dq * dq / room.max(f64::MIN_POSITIVE)
        } else {
            0.0
        };
        budget::able_to_stop(limits, dq, ddq.abs().max(deceleration), most)
    } else {
        limits
    }
}

pub(super) fn end_effector(model: &Model, ee: &EndEffector, reference: &Reference) -> PoseState {
    let dynamics = model.dynamics(&reference.q, &reference.dq, ee, &Load::NONE, &GRAVITY_EARTH);
    PoseState {
        pose: rigid(&dynamics.pose),
        twist: dynamics.jacobian * reference.dq,
        acceleration: dynamics.jacobian * reference.ddq + dynamics.jdot_dq,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;
    use rand::rngs::SmallRng;
    use rand::{Rng, SeedableRng};

    #[test]
    fn a_brake_ends_where_its_plan_does() {
        let mut random = SmallRng::seed_from_u64(33);
        for model in [Model::fr3(), Model::fer()] {
            let robot = model.joint_limits();
            for case in 0..10_000 {
                let mut share = |most: f64| {
                    JointVector::from_fn(|_, _| most * random.random_range(-1.0..1.0_f64).powi(3))
                };
                let reference = Reference {
                    q: READY,
                    dq: robot.velocity.component_mul(&share(1.0)),
                    // Some states are outside the limits.
                    ddq: robot.acceleration.component_mul(&share(1.2)) * f64::from(case % 2),
                };
                let budget = Budget::of(robot).scaled(random.random_range(0.05..2.0));
                let plan = JointGenerator::new(robot, &reference, None, &budget).unwrap();
                let end = end_of_brake(model, &reference, &budget);
                assert_eq!(end, JointVector::from(plan.end()), "{reference:?}");
            }
        }
    }
}
