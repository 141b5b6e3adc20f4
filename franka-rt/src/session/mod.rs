//! Target control: goals in, one continuous joint-space reference and the torques that follow it out.
//!
//! ```text
//! goal slot -> course (joint generator | pose generator -> inverse kinematics) -> leash -> law -> shaping -> torques
//! ```
//!
//! The state of a session is a joint reference `q, dq, ddq`. A course moves it: over seven joints for joint goals and
//! for braking, over three axes of translation and three of rotation for poses. When the kind of goal changes, the new
//! course starts from the position, velocity and acceleration of the reference, so nothing steps.
//!
//! A goal that is to finish passes through the stages of `Stage`: under way, landing, releasing, finished. A newer
//! goal takes the session back under way from any of them but the last.

mod approach;
mod budget;
mod check;
mod course;
mod goal;
mod guard;
mod kinematics;
mod landing;
mod pose;

use core::time::Duration;
use std::sync::Arc;

use franka_model::{EndEffector, Frame, GRAVITY_EARTH, JointVector, Load, Model, transform};
use franka_proto::RobotState;
use nalgebra::{Isometry3, Matrix4, Rotation3, Translation3, UnitQuaternion};

use crate::control::Torques;
use crate::driver::Record;
use crate::law::hybrid::{self, Reference};
use crate::law::{Gains, shaping};
use crate::slot::{Read, SlotReader};
use crate::together::StartFault;

pub use budget::Budget;
pub use check::GoalError;
pub use goal::{Goal, GoalId, Target, Then, Tolerance};
pub use guard::leash::{JOINT_LEASH, ROTATION_LEASH, TRANSLATION_LEASH};
pub use guard::{Bindings, Guard};
pub use landing::{PoseError, RELEASE_TIMEOUT, SETTLE_TIMEOUT};

use course::Course;
use guard::leash;
use landing::{Landing, Release, Verdict};

/// Cycles over which the gains go from those of one goal to those of the next.
const CROSS_FADE: u32 = 300;

/// Time for which something may hold the course back: an obstacle by the leash, or the joints' bounds. A goal that is to
/// finish and has not got on by then is braked, and lands where it is.
pub const STALL_TIMEOUT: Duration = SETTLE_TIMEOUT;

/// What a session reports of its goals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SessionEvent {
    /// A goal that was to finish has come to its end; the session releases the arm unless a newer goal comes.
    Settled {
        /// The goal.
        goal: GoalId,
        /// How it came to its end.
        settlement: Settlement,
        /// Time from the first cycle that saw the goal to the arrival, `[ms]` of the robot's clock.
        duration_ms: u64,
    },
    /// The robot's state names an end effector that is not a rigid transformation, or a load that is not finite; the
    /// session ends without a torque.
    BadTool,
}

/// How a goal came to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settlement {
    /// At the target, within the tolerance, at rest and held there.
    Arrived(PoseError),
    /// At rest where it was braked.
    AtRest,
    /// The reference reached the target, the arm did not: something holds it, or its load is not what was declared.
    Short(PoseError),
    /// At rest where it was held: those were missing that it was to begin with.
    Unstarted(StartFault),
}

/// What a session answers a state with.
#[derive(Debug)]
pub(crate) struct Step {
    pub(crate) torques: Torques,
    /// The last command: the motion ends once the robot has taken it.
    pub(crate) finished: bool,
    pub(crate) event: Option<SessionEvent>,
}

/// One torque session. Created outside the thread, moved into it, handed back when it has ended.
#[derive(Debug)]
pub struct TargetSession {
    model: Arc<Model>,
    goals: SlotReader<Goal>,
    active: Option<Active>,
    /// A goal that waits for its common start.
    held: Option<Goal>,
    /// A goal whose common start has failed, and why.
    unstarted: Option<(GoalId, StartFault)>,
}

/// What exists once the first state has been seen.
#[derive(Debug)]
struct Active {
    ee: EndEffector,
    load: Load,
    posture: JointVector,
    goal: Goal,
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

/// Gains on their way from one goal's to the next.
#[derive(Debug)]
struct Fade {
    from: Gains,
    to: Gains,
    cycle: u32,
}

impl Fade {
    fn towards(&mut self, to: Gains) {
        if to != self.to {
            *self = Self {
                from: self.now(),
                to,
                cycle: 0,
            };
        }
    }

    fn now(&self) -> Gains {
        if self.cycle >= CROSS_FADE {
            self.to
        } else {
            self.from
                .blend(&self.to, f64::from(self.cycle) / f64::from(CROSS_FADE))
        }
    }
}

impl TargetSession {
    /// A session that follows the goals written to `goals`. The first goal has to be there before the session runs.
    pub fn new(model: Arc<Model>, goals: SlotReader<Goal>) -> Self {
        Self {
            model,
            goals,
            active: None,
            held: None,
            unstarted: None,
        }
    }

    /// The newest goal that the session has taken up, for telling goals that came too late.
    pub fn last_goal(&self) -> Option<GoalId> {
        let active = self.active.as_ref().map(|active| active.goal.id);
        self.held.map(|held| held.id).or(active)
    }

    /// Answers one state. Bounded work, no allocation.
    pub(crate) fn step(&mut self, state: &RobotState, record: &mut Record) -> Step {
        let held = self.held.take();
        let newer = self.read().or(held);
        self.follow(newer, state, record)
    }

    /// Whether the goal that waits for its common start has been taken back, or another one has come in its place.
    pub(crate) fn is_withdrawn(&mut self) -> bool {
        let Some(goal) = self.read() else {
            return false;
        };
        let before = self.held.replace(goal);
        goal.target == Target::Rest || before.is_some_and(|before| before.id != goal.id)
    }

    /// Answers one state by holding the arm where it is, with the gains of the goal that waits.
    pub(crate) fn hold(&mut self, state: &RobotState, record: &mut Record) -> Step {
        let nothing = self.active.is_none();
        let rest = self.held.filter(|_| nothing).map(|held| Goal {
            id: GoalId::default(), // no goal's
            target: Target::Rest,
            then: Then::Hold,
            ..held
        });
        self.follow(rest, state, record)
    }

    /// Answers one state of a goal whose common start has failed: lands where the arm is held, unless another goal comes.
    pub(crate) fn give_up(
        &mut self,
        fault: StartFault,
        state: &RobotState,
        record: &mut Record,
    ) -> Step {
        let held = self.held.take();
        let newer = self.read().or(held).map(|goal| {
            let (unstarted, _) = *self.unstarted.get_or_insert((goal.id, fault));
            if goal.id != unstarted {
                return goal;
            }
            Goal {
                target: Target::Rest,
                then: Then::Finish,
                ..goal
            }
        });
        self.follow(newer, state, record)
    }

    fn read(&mut self) -> Option<Goal> {
        match self.goals.read_newer() {
            Read::Newer(goal) => Some(goal),
            // A torn read keeps the previous goal for this cycle; the next cycle sees the new one whole.
            Read::Same | Read::Torn => None,
        }
    }

    /// Takes up a newer goal, if there is one, and answers one state.
    fn follow(&mut self, newer: Option<Goal>, state: &RobotState, record: &mut Record) -> Step {
        let active = match (&mut self.active, newer) {
            (Some(active), newer) => {
                if let Some(goal) = newer {
                    active.take_up(&self.model, goal, state.message_id);
                }
                active
            }
            (none, Some(goal)) => match Active::begin(&self.model, goal, state) {
                Some(active) => none.insert(active),
                None => {
                    let event = Some(SessionEvent::BadTool);
                    return Step {
                        torques: Torques([0.0; 7]),
                        finished: true,
                        event,
                    };
                }
            },
            // The first goal is torn: without torques, gravity compensation holds the arm for this cycle.
            (None, None) => {
                return Step {
                    torques: Torques([0.0; 7]),
                    finished: false,
                    event: None,
                };
            }
        };
        let mut step = active.step(&self.model, state, record);
        if let Some(SessionEvent::Settled {
            goal, settlement, ..
        }) = &mut step.event
            && let Some((unstarted, fault)) = self.unstarted
            && *goal == unstarted
        {
            *settlement = Settlement::Unstarted(fault);
        }
        step
    }
}

impl Active {
    fn begin(model: &Model, goal: Goal, state: &RobotState) -> Option<Self> {
        let q = JointVector::from(state.q);
        let reference = Reference::at_rest(q);
        let ee = end_effector_of(state)?;
        let load = load_of(state)?;
        let mut this = Self {
            course: Course::Rest,
            gains: Fade {
                from: goal.gains,
                to: goal.gains,
                cycle: CROSS_FADE,
            },
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

    fn take_up(&mut self, model: &Model, goal: Goal, now: u64) {
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

    fn step(&mut self, model: &Model, state: &RobotState, record: &mut Record) -> Step {
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

        self.gains.cycle = self.gains.cycle.saturating_add(1);
        let last = JointVector::from(state.tau_J_d);
        let (tau, clamped) =
            hybrid::torques(&self.gains.now(), &self.reference, &q, &dq, &dynamics);
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

/// The end effector and stiffness frame that a state names, orthonormalised, as protocol 10 rounds them to `f32`. `None`
/// if one of them is not a rigid transformation.
fn end_effector_of(state: &RobotState) -> Option<EndEffector> {
    let rigid = |column_major| {
        transform::isometry_from_array(column_major).map(|pose| transform::matrix(&pose))
    };
    Some(EndEffector {
        f_t_ee: rigid(&state.F_T_EE)?,
        ee_t_k: rigid(&state.EE_T_K)?,
    })
}

/// The load of end effector and payload together that a state names. `None` if a number of it is not finite.
fn load_of(state: &RobotState) -> Option<Load> {
    let total = state.total_load();
    let numbers = [&[total.m_total][..], &total.F_x_Ctotal, &total.I_total];
    let finite = numbers.into_iter().flatten().all(|x| x.is_finite());
    finite.then(|| Load {
        mass: total.m_total,
        com: total.F_x_Ctotal.into(),
        inertia: nalgebra::Matrix3::from_column_slice(&total.I_total),
    })
}

/// A pose of the model as an isometry. The model's poses are products of rotations, so nothing is left to orthonormalise.
fn rigid(pose: &Matrix4<f64>) -> Isometry3<f64> {
    let rotation = Rotation3::from_matrix_unchecked(pose.fixed_view::<3, 3>(0, 0).into_owned());
    Isometry3::from_parts(
        Translation3::new(pose[(0, 3)], pose[(1, 3)], pose[(2, 3)]),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}
