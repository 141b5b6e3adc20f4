//! The course that the reference takes: over the joints, or over the pose of the end effector.

use franka_model::{EndEffector, GRAVITY_EARTH, JointVector, Load, Model};

use crate::law::hybrid::Reference;
use crate::otg::{Generator, Limits, PlanError, State};
use crate::session::pose::{PoseGenerator, PoseState};
use crate::session::{Budget, Goal, Target, kinematics, rigid};

/// What moves the reference.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per session, inside its box; a box in here would allocate"
)]
pub(super) enum Course {
    /// The reference rests where it is.
    Rest,
    Joints(Generator<7>),
    Pose(PoseGenerator),
}

impl Course {
    /// Turns towards a new goal from wherever the reference is and however it moves.
    ///
    /// Goals are checked where they are accepted, so planning cannot fail but by a defect; the course then goes on to
    /// where it was heading, which is safe and ends short of the goal.
    pub(super) fn head_for(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        goal: &Goal,
    ) {
        let planned = match (goal.target, &mut *self) {
            (Target::Pose(pose), Self::Pose(generator)) => {
                let retargeted = generator.retarget(pose, goal.budget);
                debug_assert!(retargeted.is_ok(), "{retargeted:?}");
                return;
            }
            (Target::Pose(pose), Self::Rest | Self::Joints(_)) => {
                let start = end_effector(model, ee, reference);
                PoseGenerator::new(&start, pose, goal.budget).map(Self::Pose)
            }
            (Target::Joints(target), _) => joints(reference, Some(target), &goal.budget),
            (Target::Rest, _) => joints(reference, None, &goal.budget),
        };
        match planned {
            Ok(course) => *self = course,
            Err(error) => debug_assert!(false, "{error}"),
        }
    }

    /// The reference one nominal millisecond on, and whether inverse kinematics had to hold it back.
    pub(super) fn step(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        posture: &JointVector,
        reference: &Reference,
    ) -> (Reference, bool) {
        match self {
            Self::Rest => (Reference::at_rest(reference.q), false),
            Self::Joints(generator) => {
                let State {
                    position,
                    velocity,
                    acceleration,
                } = *generator.step();
                (
                    Reference {
                        q: position.into(),
                        dq: velocity.into(),
                        ddq: acceleration.into(),
                    },
                    false,
                )
            }
            Self::Pose(generator) => {
                let next = generator.step();
                kinematics::follow(model, ee, posture, reference, &next)
            }
        }
    }

    /// Whether the course has come to its end.
    pub(super) fn is_done(&self) -> bool {
        match self {
            Self::Rest => true,
            Self::Joints(generator) => generator.is_done(),
            Self::Pose(generator) => generator.is_done(),
        }
    }
}

/// A course over the joints from the reference to `target`, or to rest.
fn joints(
    reference: &Reference,
    target: Option<[f64; 7]>,
    budget: &Budget,
) -> Result<Course, PlanError> {
    let state = State {
        position: reference.q.into(),
        velocity: reference.dq.into(),
        acceleration: reference.ddq.into(),
    };
    // Without a target a generator comes to rest in the least time.
    let mut generator = Generator::new(state, Limits::per_axis(budget.joints)?)?;
    if let Some(target) = target {
        generator.set_target(&target)?;
    }
    Ok(Course::Joints(generator))
}

/// The end effector of a moving reference.
fn end_effector(model: &Model, ee: &EndEffector, reference: &Reference) -> PoseState {
    let dynamics = model.dynamics(&reference.q, &reference.dq, ee, &Load::NONE, &GRAVITY_EARTH);
    PoseState {
        pose: rigid(&dynamics.pose),
        twist: dynamics.jacobian * reference.dq,
        acceleration: dynamics.jacobian * reference.ddq + dynamics.jdot_dq,
    }
}
