//! A session under way: the reference, what moves it, and the torques that follow it.

use core::time::Duration;

use franka_model::{EndEffector, Frame, GRAVITY_EARTH, Jacobian, JointVector, Load, Model};
use franka_proto::{RobotState, Version};
use nalgebra::Isometry3;

use crate::control::Torques;
use crate::driver::Record;
use crate::law::hybrid::Reference;

use super::backend::{Backend, Stream};
use super::chunk::{ChunkCourse, ChunkReader, ChunkStart};
use super::course::{self, Course};
use super::effort::Effort;
use super::goal::{Goal, Stale, Target, Then, Watchdog};
use super::guard::clearance::{Clearance, KeepOut};
use super::guard::deviation::Deviation;
use super::guard::lead::LEAD_FRESH_MS;
use super::guard::{Bindings, Guard, leash};
use super::landing::{self, Landing, Release, Verdict};
use super::route::Route;
use super::{
    Answer, Lapse, STALL_TIMEOUT, SessionEvent, Settlement, Step, end_effector_of, load_of, rigid,
};

/// Joint velocity, `[rad/s]`, below which the reference may be stopped in one cycle. Joints at their bounds may still creep
/// after a pose has come to its end.
const REFERENCE_REST: f64 = 1e-3;

/// What exists once the first state has been seen.
#[derive(Debug)]
pub(super) struct Active {
    ee: EndEffector,
    load: Load,
    posture: JointVector,
    pub(super) goal: Goal,
    /// Whether no state has been answered: the first answer holds the arm, and begins with no torque.
    first: bool,
    /// When the goal was first seen, `message_id` of the state.
    since: u64,
    /// What the reference heads for: the goal's target, or one nearer, or rest.
    aim: Target,
    route: Route,
    reference: Reference,
    drive: Drive,
    deviation: Deviation,
    /// What follows a goal that is held and has to be given up.
    afterwards: Then,
    stage: Stage,
    /// When the session last heard of its goal, `message_id` of the state.
    heard: u64,
    /// Why the goal was given up, and what the arm does since.
    lapse: Option<(Stale, Lapse)>,
    /// Cycles in which the course was held back, less those since in which it was not.
    held_back: u64,
    /// Where the goal's last chunk has ended, if none runs.
    chunk_end: Option<Target>,
    /// A chunk that another course has taken the place of: it goes back in the next cycle.
    left: Option<ChunkCourse>,
}

/// What follows the reference.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per session, inside its box; a box in here would allocate"
)]
enum Drive {
    Torques(Effort),
    Setpoints(Stream),
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

/// What the session does about its goal.
#[derive(Debug)]
enum Stage {
    /// The reference moves, or holds a goal that is to be held.
    UnderWay,
    /// The reference has arrived; the arm settles.
    Landing(Landing),
    /// The goal has come to its end, and is held.
    Staying,
    /// The spring is being let go, so that the torques end at zero.
    Releasing(Release),
    /// The last command is out.
    Finished,
}

impl Active {
    pub(super) fn begin(
        model: &Model,
        goal: Goal,
        backend: Backend,
        version: Version,
        keep_out: KeepOut,
        afterwards: Then,
        state: &RobotState,
    ) -> Option<Self> {
        let (q, drive) = match backend {
            Backend::Torques => (state.q, Drive::Torques(Effort::new(&goal))),
            Backend::RobotController(setpoints) => {
                let stream = Stream::new(setpoints, version, model.joint_limits());
                (state.q_d, Drive::Setpoints(stream))
            }
        };
        let q = JointVector::from(q);
        let reference = Reference::at_rest(q);
        let ee = end_effector_of(state)?;
        let load = load_of(state)?;
        let mut this = Self {
            drive,
            aim: goal.target,
            // Nothing tells which tool is mounted, but that one is: the Hand stands for it.
            route: Route::new(Clearance::new(model.kind(), state.m_ee > 0.0, keep_out)),
            deviation: Deviation::at(q),
            afterwards,
            stage: Stage::UnderWay,
            held_back: 0,
            first: true,
            since: state.message_id,
            heard: state.message_id,
            lapse: None,
            chunk_end: None,
            left: None,
            posture: q,
            reference,
            goal,
            load,
            ee,
        };
        this.set_out(model);
        Some(this)
    }

    pub(super) fn take_up(&mut self, model: &Model, goal: Goal, now: u64) {
        if matches!(self.stage, Stage::Finished) {
            return;
        }
        if goal.id == self.goal.id && matches!(self.lapse, Some((_, lapse)) if lapse.is_final()) {
            return;
        }
        self.heard = now;
        if let Drive::Torques(effort) = &mut self.drive {
            effort.take_up(&goal);
        }
        let same = goal.id == self.goal.id
            && goal.target == self.goal.target
            && goal.then == self.goal.then
            && goal.budget == self.goal.budget;
        if goal.id != self.goal.id {
            self.since = now;
        }
        self.goal = goal;
        if same && self.lapse.is_none() && !matches!(self.stage, Stage::Releasing(_)) {
            return; // Tuned, or a sign of life.
        }
        self.lapse = None;
        self.set_out(model);
    }

    fn set_out(&mut self, model: &Model) {
        self.stage = Stage::UnderWay;
        self.held_back = 0;
        self.chunk_end = None;
        self.turn_to(model, self.goal.target);
    }

    /// Takes up a newer chunk of the goal if there is one, and goes on to rest from one that is over.
    fn follow_chunks(&mut self, model: &Model, chunks: &mut ChunkReader, now: u64) {
        if let Some(left) = self.left.take() {
            left.end(chunks, now);
        }
        let gone = matches!(self.stage, Stage::Releasing(_) | Stage::Finished);
        let given_up = |(_, lapse): &(Stale, Lapse)| *lapse == Lapse::Deadman || lapse.is_final();
        if gone || self.lapse.as_ref().is_some_and(given_up) {
            chunks.discard(self.goal.id);
            return;
        }
        let over = match &self.route.course {
            Course::Chunk(chunk) => chunk.is_over(now),
            _ => true,
        };
        if let Some(chunk) = chunks.poll(self.goal.id, now, over) {
            let (pose, drift) = self.route.course.pose(model, &self.ee, &self.reference);
            let start = ChunkStart {
                reference: &self.reference,
                pose,
                drift,
                now,
            };
            let next = ChunkCourse::new(model, self.goal.id, self.goal.budget, chunk, start);
            if let Course::Chunk(before) =
                core::mem::replace(&mut self.route.course, Course::Chunk(next))
            {
                before.end(chunks, now);
            }
            self.aim = self.heading();
            // A goal that had fallen silent was to be held until a newer one.
            if self.lapse.take().is_some() {
                self.goal.then = Then::Hold;
            }
            self.heard = now;
            self.stage = Stage::UnderWay;
        } else if over && let Course::Chunk(chunk) = &self.route.course {
            let target = chunk.target();
            self.turn_to(model, target);
            self.chunk_end = Some(target);
        }
    }

    /// Where the reference is to come to rest.
    fn heading(&self) -> Target {
        match &self.route.course {
            Course::Chunk(chunk) => chunk.target(),
            _ => self.chunk_end.unwrap_or(self.goal.target),
        }
    }

    fn turn_to(&mut self, model: &Model, target: Target) {
        if matches!(self.route.course, Course::Chunk(_))
            && let Course::Chunk(chunk) = core::mem::replace(&mut self.route.course, Course::Rest)
        {
            self.left = Some(chunk);
        }
        self.aim = target;
        let goal = Goal {
            target,
            ..self.goal
        };
        self.route.head_for(model, &self.ee, &self.reference, &goal);
    }

    /// Draws a target nearer that is too far ahead of the arm; tells whether it is.
    fn draw_nearer(&mut self, model: &Model, arm: &Measured, now: u64) -> bool {
        let Some(lead) = self.goal.lead else {
            return false;
        };
        let chunks = matches!(self.route.course, Course::Chunk(_)) || self.chunk_end.is_some();
        if chunks || !matches!(self.stage, Stage::UnderWay) {
            return false;
        }
        if now.saturating_sub(self.heard) <= LEAD_FRESH_MS {
            let drawn = lead.drawn(&self.goal.target, &arm.q, &arm.pose);
            let target = drawn.unwrap_or(self.goal.target);
            if target != self.aim {
                self.turn_to(model, target);
            }
        }
        self.aim != self.goal.target
    }

    /// Gives the goal up, and brakes.
    fn give_up(&mut self, model: &Model, lapse: Lapse) {
        self.goal.target = Target::Rest;
        self.set_out(model);
        if self.goal.then == Then::Hold {
            self.goal.then = self.afterwards;
        }
        self.lapse = Some((Stale::Brake, lapse));
    }

    /// Gives up a goal whose arm is being carried off; tells whether it is.
    fn watch_deviation(&mut self, model: &Model, arm: &Measured, leashed: bool) -> bool {
        if !leashed {
            self.deviation.set_free(&self.reference.q);
            return false;
        }
        if matches!(self.heading(), Target::Rest | Target::Guide(_)) {
            return matches!(self.lapse, Some((_, Lapse::CarriedOff)));
        }
        let exceeded = self
            .deviation
            .is_exceeded(model, &self.ee, &arm.q, &arm.pose, &self.aim);
        let follows = matches!(
            self.stage,
            Stage::UnderWay | Stage::Landing(_) | Stage::Staying
        );
        if exceeded && follows {
            self.give_up(model, Lapse::CarriedOff);
        }
        exceeded
    }

    /// Gives the goal up: its updates stay away, or its deadman is silent.
    fn watch(&mut self, model: &Model, alive: bool, now: u64) {
        let given_up = matches!(self.lapse, Some((Stale::Brake, _)));
        // Whoever asks for rest gets it, with or without a deadman.
        let comes_to_rest = self.goal.target == Target::Rest && self.goal.then != Then::Hold;
        if given_up || comes_to_rest || matches!(self.stage, Stage::Releasing(_) | Stage::Finished)
        {
            return;
        }
        let silence = Duration::from_millis(now.saturating_sub(self.heard));
        let lapse = match self.goal.watchdog {
            _ if !alive => (Stale::Brake, Lapse::Deadman),
            Some(Watchdog {
                silence: most,
                stale,
                then,
            }) if self.goal.then == Then::Hold && silence >= most => {
                self.goal.then = then;
                (stale, Lapse::Silent { silence })
            }
            _ => return,
        };
        if lapse.0 == Stale::Brake {
            self.goal.target = Target::Rest;
            self.set_out(model);
        }
        if self.goal.then == Then::Hold {
            self.goal.then = Then::Stay;
        }
        self.lapse = Some(lapse);
    }

    /// Answers one state; `alive` is whether nobody has let go of the deadman that it is bound to.
    pub(super) fn step(
        &mut self,
        model: &Model,
        alive: bool,
        chunks: Option<&mut ChunkReader>,
        state: &RobotState,
        record: &mut Record,
    ) -> Step {
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
            matches!(self.lapse, Some((_, Lapse::Silent { .. }))),
        );

        self.reanchor(model, state);
        let drawn = self.draw_nearer(model, &arm, state.message_id);
        bindings.set(Guard::Lead, drawn);
        let aim = Goal {
            target: self.aim,
            ..self.goal
        };
        let course::Step {
            reference,
            bounds,
            held,
        } = if core::mem::take(&mut self.first) {
            course::Step::free(self.reference)
        } else {
            self.route
                .step(model, &self.ee, &self.posture, &self.reference, &arm, &aim)
        };
        if let Some(chunk) = self.route.left.take() {
            self.chunk_end = Some(chunk.target());
            self.left = Some(chunk);
        }
        self.reference = reference;
        bindings.set(Guard::Clearance, self.route.is_bound());
        bindings.set(Guard::InverseKinematics, bounds.acceleration);
        bindings.set(Guard::JointVelocity, bounds.velocity);
        bindings.set(Guard::PositionEnvelope, bounds.position);
        let at_rest = dq.amax() < landing::REST_VELOCITY;
        let event = self.advance_stage(model, &arm, at_rest, state.message_id);
        let leashed = match self.drive {
            Drive::Torques(_) => {
                leash::hold(&mut self.route.course, &mut self.reference, &q, &arm.pose)
            }
            // What pulls is the robot's own controller, on whose setpoint the reference is anchored.
            Drive::Setpoints(_) => false,
        };
        bindings.set(Guard::Leash, leashed);
        let carried_off = self.watch_deviation(model, &arm, leashed);
        bindings.set(Guard::Deviation, carried_off);
        self.held_back = if leashed || held || self.route.is_hindered() {
            self.held_back + 1
        } else {
            self.held_back.saturating_sub(1)
        };
        let answer = match &mut self.drive {
            Drive::Torques(effort) => {
                let limits = model.joint_limits();
                let tau = effort.step(&self.reference, state, &dynamics, limits, &mut bindings);
                Answer::Torques(Torques(tau.into()))
            }
            Drive::Setpoints(stream) => {
                let (command, changed) = stream.command(model, &self.ee, &self.reference, state);
                bindings.set(Guard::Backstop, changed);
                Answer::Setpoint(command)
            }
        };

        record.goal = self.goal.id.0;
        record.q_ref = self.reference.q.into();
        record.dq_ref = self.reference.dq.into();
        record.ddq_ref = self.reference.ddq.into();
        record.bindings = bindings;
        Step {
            answer,
            finished: matches!(self.stage, Stage::Finished),
            event,
        }
    }

    /// Puts the reference where the robot's controller takes its setpoint to be, and goes on from there.
    fn reanchor(&mut self, model: &Model, state: &RobotState) {
        let Drive::Setpoints(stream) = &self.drive else {
            return;
        };
        if let Some(echo) = stream.echo(model, &self.ee, &self.reference, state) {
            self.reference = echo;
            let target = match self.stage {
                Stage::UnderWay => self.aim,
                Stage::Landing(_) | Stage::Staying | Stage::Releasing(_) | Stage::Finished => {
                    Target::Rest
                }
            };
            let aim = Goal {
                target,
                ..self.goal
            };
            self.route
                .begin_again(model, &self.ee, &self.reference, &aim);
        }
    }

    /// Moves through the stages of a goal that is to come to an end. The only place where the stage advances.
    fn advance_stage(
        &mut self,
        model: &Model,
        arm: &Measured,
        at_rest: bool,
        now: u64,
    ) -> Option<SessionEvent> {
        let heading = self.heading();
        match &mut self.stage {
            Stage::UnderWay => {
                let stalled = u128::from(self.held_back) >= STALL_TIMEOUT.as_millis();
                if self.goal.then != Then::Hold && (self.route.is_done() || stalled) {
                    if stalled && self.route.is_hindered() {
                        self.give_up(model, Lapse::Blocked);
                    } else if stalled && heading != Target::Rest {
                        self.turn_to(model, Target::Rest);
                    }
                    let target = match heading {
                        // Wherever it stands, it counts as held.
                        _ if self.lapse.is_some() => None,
                        Target::Rest | Target::Guide(_) => None,
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
                let (settlement, held) = match landing.judge(&arm.pose, at_rest) {
                    Verdict::Settling => return None,
                    Verdict::Settled(settlement, held) => (settlement, held),
                };
                if self.goal.then == Then::Finish && self.reference.dq.amax() > REFERENCE_REST {
                    if self.aim != Target::Rest {
                        self.turn_to(model, Target::Rest);
                    }
                    return None;
                }
                self.stage = match (self.goal.then, &self.drive) {
                    (Then::Hold | Then::Stay, _) => Stage::Staying,
                    (Then::Finish, Drive::Torques(_)) => {
                        self.route.rest();
                        Stage::Releasing(Release::new(self.reference.q - arm.q))
                    }
                    // The robot holds the arm at its setpoint as it is.
                    (Then::Finish, Drive::Setpoints(_)) => Stage::Finished,
                };
                Some(SessionEvent::Settled {
                    goal: self.goal.id,
                    settlement: match self.lapse {
                        Some((Stale::Hold, lapse)) => Settlement::Held(lapse),
                        Some((Stale::Brake, Lapse::Deadman)) => Settlement::Held(Lapse::Deadman),
                        Some((Stale::Brake, lapse)) => Settlement::Braked(lapse),
                        None => settlement,
                    },
                    duration_ms: (now - self.since).saturating_sub(held),
                })
            }
            Stage::Releasing(release) => {
                self.reference = Reference::at_rest(arm.q + release.offset());
                self.route.rest();
                if release.is_over(at_rest) {
                    self.stage = Stage::Finished;
                }
                None
            }
            Stage::Staying | Stage::Finished => None,
        }
    }
}
