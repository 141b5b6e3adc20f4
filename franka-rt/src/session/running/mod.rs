//! A session under way: the reference, what moves it, and the torques that follow it.

mod chunks;
mod stages;
mod watch;

use franka_model::{EndEffector, GRAVITY_EARTH, Jacobian, JointVector, Load, Model};
use franka_proto::{RobotState, Version};
use nalgebra::Isometry3;

use crate::control::Torques;
use crate::session::reference::Reference;

use super::backend::Backend;
use super::chunk::ChunkReader;
use super::course;
use super::effort::Effort;
use super::goal::{Goal, OnArrival, Target};
use super::guard::clearance::{Clearance, KeepOut};
use super::guard::deviation::Deviation;
use super::guard::watchdog::OnTimeout;
use super::guard::{Bindings, Guard, leash};
use super::landing;
use super::route::Route;
use super::setpoint_stream::SetpointStream;
use super::{Lapse, SessionCommand, SessionStep, Trace, end_effector_of, load_of, rigid};
use stages::GoalStage;

/// The part of a session that exists from its first state on.
#[derive(Debug)]
pub(super) struct RunningSession {
    ee: EndEffector,
    load: Load,
    posture: JointVector,
    pub(super) goal: Goal,
    /// Whether a course has been planned since the last answer, as before the first one.
    planned: bool,
    /// Whether the last cycle was used for planning, and the reference stayed. Two cycles in a row
    /// are never used in this way, even if a goal comes in each.
    stayed: bool,
    /// When the goal was first seen, `message_id` of the state.
    since: u64,
    /// What the reference heads for: the goal's target, or one nearer, or rest.
    aim: Target,
    route: Route,
    reference: Reference,
    drive: Drive,
    deviation: Deviation,
    /// What follows a goal that is held and has to be given up.
    afterwards: OnArrival,
    stage: GoalStage,
    /// When the session last heard of its goal, `message_id` of the state.
    heard: u64,
    standing: Standing,
    /// Grows by 1 in a cycle in which the course is held back, and falls by 1 in any other.
    held_back: u64,
}

/// How the goal stands.
#[derive(Clone, Copy, Debug)]
enum Standing {
    /// It is pursued.
    InForce,
    /// It was changed to one of coming to rest. Chunks that wait for their time are discarded.
    TakenBack,
    /// It was given up for `cause`: the arm holds the last target, or brakes.
    GivenUp { action: OnTimeout, cause: Lapse },
}

/// What follows the reference.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per session, inside its box; a box in here would allocate"
)]
enum Drive {
    Torques(Effort),
    Setpoints(SetpointStream),
}

/// The arm as it was measured.
#[derive(Debug)]
pub(super) struct Measured {
    /// `message_id` of the state.
    pub(super) time: u64,
    pub(super) q: JointVector,
    /// `O_T_EE`.
    pub(super) pose: Isometry3<f64>,
    /// Of the end effector in the base frame.
    pub(super) jacobian: Jacobian,
}

impl RunningSession {
    pub(super) fn begin(
        model: &Model,
        goal: Goal,
        backend: Backend,
        version: Version,
        keep_out: KeepOut,
        afterwards: OnArrival,
        state: &RobotState,
    ) -> Option<Self> {
        let (q, drive) = match backend {
            Backend::Torques => (state.q, Drive::Torques(Effort::new(&goal))),
            Backend::RobotController(setpoints) => {
                let stream = SetpointStream::new(setpoints, version, model.joint_limits());
                (state.q_d, Drive::Setpoints(stream))
            }
        };
        let q = JointVector::from(q);
        let reference = Reference::at_rest(q);
        let ee = end_effector_of(state)?;
        let load = load_of(state, version)?;
        let mut this = Self {
            drive,
            aim: goal.target,
            // The state shows that a tool is mounted, but not which one: the Hand is assumed.
            route: Route::new(
                Clearance::new(model.kind(), state.m_ee > 0.0, keep_out),
                goal.budget,
            ),
            deviation: Deviation::at(q),
            afterwards,
            stage: GoalStage::UnderWay,
            held_back: 0,
            planned: true,
            stayed: false,
            since: state.message_id,
            heard: state.message_id,
            standing: Standing::InForce,
            posture: q,
            reference,
            goal,
            load,
            ee,
        };
        this.set_out(model);
        Some(this)
    }

    /// Takes a goal that was read from the slot: tunes the present goal, or replaces it and plans
    /// anew.
    pub(super) fn take_up(&mut self, model: &Model, goal: Goal, now: u64) {
        if matches!(self.stage, GoalStage::Finished) {
            return;
        }
        let named = goal.id == self.goal.id;
        let taken_back = goal.target == Target::Rest && goal.on_arrival != OnArrival::Hold;
        // Tuning leaves the revision as it is.
        let tuned = goal.revision == self.goal.revision;
        // The caller has not yet seen the abort: ignore where the update leads.
        let aborted = !taken_back && self.is_given_up_for_good();
        if named && (tuned || aborted) {
            return self.tune(model, goal);
        }
        self.heard = now;
        let same = named
            && !self.is_given_up()
            && goal.target == self.goal.target
            && goal.on_arrival == self.goal.on_arrival;
        if same && !matches!(self.stage, GoalStage::Releasing(_)) {
            return self.tune(model, goal);
        }
        if !named {
            self.since = now;
        }
        self.goal = goal;
        self.fade_gains();
        self.standing = if named && taken_back {
            Standing::TakenBack
        } else {
            Standing::InForce
        };
        self.set_out(model);
    }

    /// Keeps the target, and takes budget, gains, tolerance and guards from `goal`. Gains for
    /// guiding would release an arm that is held by now.
    fn tune(&mut self, model: &Model, goal: Goal) {
        let Goal {
            target, on_arrival, ..
        } = self.goal;
        let gains = match target {
            Target::Guide(_) => goal.gains,
            Target::Rest | Target::Joints(_) | Target::Pose(_) => goal.at_rest(on_arrival).gains,
        };
        let before = core::mem::replace(
            &mut self.goal,
            Goal {
                target,
                on_arrival,
                gains,
                ..goal
            },
        );
        self.fade_gains();
        if goal.budget != before.budget && !matches!(self.stage, GoalStage::Releasing(_)) {
            let aim = Goal {
                target: self.aim,
                ..self.goal
            };
            self.route.tune(model, &self.ee, &self.reference, &aim);
        }
    }

    /// Starts the fade of gains and force cap to those of the goal.
    fn fade_gains(&mut self) {
        if let Drive::Torques(effort) = &mut self.drive {
            effort.take_up(&self.goal);
        }
    }

    /// Sets out for the target of the goal.
    fn set_out(&mut self, model: &Model) {
        self.stage = GoalStage::UnderWay;
        self.held_back = 0;
        self.route.chunk_end = None;
        self.turn_to(model, self.goal.target);
    }

    /// Plans the course to `target`, in place of the one before.
    fn turn_to(&mut self, model: &Model, target: Target) {
        self.route.retire_chunk();
        self.aim = target;
        let goal = Goal {
            target,
            ..self.goal
        };
        self.route.head_for(model, &self.ee, &self.reference, &goal);
        self.planned |= matches!(target, Target::Pose(_) | Target::Joints(_));
    }

    /// Answers one state; `alive` is false once the deadman of the session is silent or dropped.
    pub(super) fn step(
        &mut self,
        model: &Model,
        alive: bool,
        chunks: Option<&mut ChunkReader>,
        state: &RobotState,
    ) -> SessionStep {
        let q = JointVector::from(state.q);
        let dq = JointVector::from(state.dq);
        let dynamics = model.dynamics(&q, &dq, &self.ee, &self.load, &GRAVITY_EARTH);
        let arm = Measured {
            time: state.message_id,
            q,
            pose: rigid(&dynamics.pose),
            jacobian: dynamics.jacobian,
        };
        let mut bindings = Bindings::default();

        if let Some(chunks) = chunks {
            self.follow_chunks(model, chunks, state.message_id);
        }
        self.watch(model, alive, state.message_id);
        bindings.set(Guard::Deadman, !alive);
        bindings.set(
            Guard::Watchdog,
            matches!(
                self.standing,
                Standing::GivenUp {
                    cause: Lapse::Silent { .. },
                    ..
                }
            ),
        );

        self.reanchor(model, state);
        let drawn = self.draw_nearer(model, &arm, state.message_id);
        bindings.set(Guard::Lead, drawn);
        let aim = Goal {
            target: self.aim,
            ..self.goal
        };
        // A plan takes as long to compute as a step. A reference at rest stays for one cycle after
        // a new plan and steps in the next, so that the first answer starts with zero torque.
        let at_rest = self.reference == Reference::at_rest(self.reference.q);
        self.stayed = core::mem::take(&mut self.planned) && at_rest && !self.stayed;
        let course::CourseStep {
            reference,
            bounds,
            held,
            leashed: guided,
            failed,
        } = if self.stayed {
            self.route.stay(&self.reference)
        } else {
            self.route
                .step(model, &self.ee, &self.posture, &self.reference, &arm, &aim)
        };
        self.reference = reference;
        bindings.set(Guard::Clearance, self.route.is_bound());
        bindings.set(Guard::InverseKinematics, bounds.acceleration);
        bindings.set(Guard::JointVelocity, bounds.velocity);
        bindings.set(Guard::PositionEnvelope, bounds.position);
        let at_rest = dq.amax() < landing::REST_VELOCITY;
        let event = self.advance_stage(model, &arm, at_rest, state.message_id);
        let leash = match self.drive {
            Drive::Torques(_) => {
                leash::hold(&mut self.route.course, &mut self.reference, &q, &arm.pose)
            }
            // What pulls is the robot's own controller, on whose setpoint the reference is
            // anchored.
            Drive::Setpoints(_) => Ok(false),
        };
        let leashed = leash.unwrap_or(true);
        bindings.set(Guard::Leash, leashed || guided);
        let displaced = self.watch_deviation(model, &arm, leashed);
        bindings.set(Guard::Deviation, displaced);
        self.held_back = if leashed || held || self.route.is_hindered() {
            self.held_back + 1
        } else {
            self.held_back.saturating_sub(1)
        };
        let answer = match &mut self.drive {
            Drive::Torques(effort) => {
                let limits = model.joint_limits();
                let tau = effort.step(&self.reference, state, &dynamics, limits, &mut bindings);
                SessionCommand::Torques(Torques(tau.into()))
            }
            Drive::Setpoints(stream) => {
                let (command, changed) = stream.command(model, &self.ee, &self.reference, state);
                bindings.set(Guard::Backstop, changed);
                SessionCommand::Setpoint(command)
            }
        };

        let failed = failed || leash.is_err() || self.route.take_failure();
        bindings.set(Guard::PlanFailure, failed);
        SessionStep {
            answer,
            trace: Trace {
                goal: self.goal.id,
                reference: self.reference,
                bindings,
            },
            finished: matches!(self.stage, GoalStage::Finished),
            event,
        }
    }

    /// Puts the reference at the setpoint that the robot's controller has, and goes on from there.
    fn reanchor(&mut self, model: &Model, state: &RobotState) {
        let Drive::Setpoints(stream) = &self.drive else {
            return;
        };
        if let Some(echo) = stream.echo(model, &self.ee, &self.reference, state) {
            self.reference = echo;
            let target = match self.stage {
                GoalStage::UnderWay => self.aim,
                GoalStage::Landing(_)
                | GoalStage::Staying
                | GoalStage::Releasing(_)
                | GoalStage::Finished => Target::Rest,
            };
            let aim = Goal {
                target,
                ..self.goal
            };
            self.route
                .begin_again(model, &self.ee, &self.reference, &aim);
        }
    }
}
