//! A session under way: the reference, what moves it, and the torques that follow it.

use franka_model::{EndEffector, Frame, GRAVITY_EARTH, JointVector, Load, Model};
use franka_proto::RobotState;
use nalgebra::Isometry3;

use crate::control::Torques;
use crate::driver::Record;
use crate::law::hybrid::{self, Reference};
use crate::law::shaping;

use super::course::{self, Course};
use super::fade::Fade;
use super::goal::{Goal, Target, Then};
use super::guard::{Bindings, Guard, leash};
use super::landing::{self, Landing, Release, Verdict};
use super::{STALL_TIMEOUT, SessionEvent, Step, end_effector_of, load_of, rigid};

/// What exists once the first state has been seen.
#[derive(Debug)]
pub(super) struct Active {
    ee: EndEffector,
    load: Load,
    posture: JointVector,
    pub(super) goal: Goal,
    /// When the goal was first seen, `message_id` of the state.
    since: u64,
    course: Course,
    reference: Reference,
    gains: Fade,
    stage: Stage,
    /// Cycles in which the course was held back, less those since in which it was not.
    held_back: u64,
}

/// What the session does about its goal.
#[derive(Debug)]
enum Stage {
    /// The reference moves, or holds a goal that is to be held.
    UnderWay,
    /// The reference has arrived; the arm settles.
    Landing(Landing),
    /// The spring is being let go, so that the torques end at zero.
    Releasing(Release),
    /// The last command is out.
    Finished,
}

impl Active {
    pub(super) fn begin(model: &Model, goal: Goal, state: &RobotState) -> Option<Self> {
        let q = JointVector::from(state.q);
        let reference = Reference::at_rest(q);
        let ee = end_effector_of(state)?;
        let load = load_of(state)?;
        let mut this = Self {
            course: Course::Rest,
            gains: Fade::at(goal.gains),
            stage: Stage::UnderWay,
            held_back: 0,
            since: state.message_id,
            posture: q,
            reference,
            goal,
            load,
            ee,
        };
        this.take_up(model, goal, state.message_id);
        Some(this)
    }

    pub(super) fn take_up(&mut self, model: &Model, goal: Goal, now: u64) {
        if matches!(self.stage, Stage::Finished) {
            return;
        }
        if goal.id != self.goal.id {
            self.since = now;
        }
        self.goal = goal;
        self.gains.towards(goal.gains);
        self.stage = Stage::UnderWay;
        self.held_back = 0;
        self.course
            .head_for(model, &self.ee, &self.reference, &goal);
    }

    pub(super) fn step(&mut self, model: &Model, state: &RobotState, record: &mut Record) -> Step {
        let q = JointVector::from(state.q);
        let dq = JointVector::from(state.dq);
        let dynamics = model.dynamics(&q, &dq, &self.ee, &self.load, &GRAVITY_EARTH);
        let measured = rigid(&dynamics.pose);
        let mut bindings = Bindings::default();

        let course::Step {
            reference,
            bounded,
            held,
        } = self
            .course
            .step(model, &self.ee, &self.posture, &self.reference);
        self.reference = reference;
        bindings.set(Guard::InverseKinematics, bounded);
        let at_rest = dq.amax() < landing::REST_VELOCITY;
        let event = self.advance_stage(model, &q, &measured, at_rest, state.message_id);
        let leashed = leash::hold(&mut self.course, &mut self.reference, &q, &measured);
        bindings.set(Guard::Leash, leashed);
        self.held_back = if leashed || held {
            self.held_back + 1
        } else {
            self.held_back.saturating_sub(1)
        };

        let gains = self.gains.step();
        let last = JointVector::from(state.tau_J_d);
        let (tau, clamped) = hybrid::torques(&gains, &self.reference, &q, &dq, &dynamics);
        // The Coriolis torques come on top of the clamped ones, which leave them little room.
        let (tau, full) = shaping::clamp(&tau, &model.joint_limits().torque);
        let (tau, slowed) = shaping::limit_rate(
            &shaping::low_pass(&tau, &last),
            &last,
            &model.joint_limits().torque_rate,
        );
        bindings.set(Guard::TorqueClamp, clamped || full);
        bindings.set(Guard::TorqueRate, slowed);

        record.goal = self.goal.id.0;
        record.q_ref = self.reference.q.into();
        record.dq_ref = self.reference.dq.into();
        record.ddq_ref = self.reference.ddq.into();
        record.bindings = bindings;
        Step {
            torques: Torques(tau.into()),
            finished: matches!(self.stage, Stage::Finished),
            event,
        }
    }

    /// Moves through the stages of a goal that is to finish. The only place where the stage advances.
    fn advance_stage(
        &mut self,
        model: &Model,
        q: &JointVector,
        measured: &Isometry3<f64>,
        at_rest: bool,
        now: u64,
    ) -> Option<SessionEvent> {
        match &mut self.stage {
            Stage::UnderWay => {
                let stalled = u128::from(self.held_back) >= STALL_TIMEOUT.as_millis();
                if self.goal.then == Then::Finish && (self.course.is_done() || stalled) {
                    if stalled && self.goal.target != Target::Rest {
                        let rest = Goal {
                            target: Target::Rest,
                            ..self.goal
                        };
                        self.course
                            .head_for(model, &self.ee, &self.reference, &rest);
                    }
                    let target = match self.goal.target {
                        Target::Rest => None,
                        Target::Pose(pose) => Some(pose),
                        Target::Joints(q) => {
                            Some(rigid(&model.pose(Frame::EndEffector, &q.into(), &self.ee)))
                        }
                    };
                    self.stage = Stage::Landing(Landing::new(target, self.goal.tolerance));
                }
                None
            }
            Stage::Landing(landing) => {
                let verdict = landing.judge(measured, at_rest);
                let (settlement, held) = match verdict {
                    Verdict::Settling => return None,
                    Verdict::Settled(settlement, held) => (settlement, held),
                };
                self.stage = Stage::Releasing(Release::new(self.reference.q - q));
                self.course = Course::Rest;
                Some(SessionEvent::Settled {
                    goal: self.goal.id,
                    settlement,
                    duration_ms: (now - self.since).saturating_sub(held),
                })
            }
            Stage::Releasing(release) => {
                self.reference = Reference::at_rest(q + release.offset());
                self.course = Course::Rest;
                if release.is_over(at_rest) {
                    self.stage = Stage::Finished;
                }
                None
            }
            Stage::Finished => None,
        }
    }
}
