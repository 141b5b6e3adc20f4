//! A running session: the reference, the course that moves it, and the torques that follow it.
//!
//! The law, the leash and the decision about the arrival need the newest state, so they run while
//! that state is answered. Goals, plans and the reference's next step are prepared before, after
//! the previous answer.

mod carry;
mod chunks;
mod correction;
mod goals;
mod line;
mod progress;
mod react;
mod stages;
mod watch;

use core::time::Duration;

use franka_model::{EndEffector, Frame, GRAVITY_EARTH, Jacobian, JointVector, Load, Model};
use franka_proto::{RobotState, Version};
use nalgebra::Isometry3;

use crate::control::Torques;
use crate::law::compensation::Learned;
use crate::law::fade::Fade;
use crate::session::reference::Reference;
use crate::team::TeamStop;

use super::aim::Aim;
use super::arrival::{self, PoseError};
use super::backend::Backend;
use super::chunk::ChunkReader;
use super::course::{Course, CourseStep};
use super::effort::{Effort, Resistance};
use super::goal::{Goal, OnArrival, Target};
use super::guard::clearance::{Clearance, KeepOut};
use super::guard::deviation::Displacement;
use super::guard::leash::{self, Held, Leash};
use super::guard::obstacle_braking::ObstacleBraking;
use super::guard::speed_cap::SpeedCap;
use super::guard::unresponsive::{Commanded, Unresponsive};
use super::guard::watchdog::OnTimeout;
use super::guard::{Bindings, Guard};
use super::kinematics::Posture;
use super::setpoint_stream::SetpointStream;
use super::{
    Lapse, Reacted, SessionCommand, SessionEvent, SessionStep, Trace, end_effector_of, load_of,
    rigid,
};
use correction::moved;
use goals::Bearing;
use line::Line;
use progress::Progress;
use react::Reacting;
use stages::GoalStage;

/// The part of a session that exists once the first state has arrived.
#[derive(Debug)]
pub(super) struct RunningSession {
    /// Hand according to the robot's state. Springs and dampers act there.
    hand: EndEffector,
    /// Frame that goals move: the hand as the robot reports it, or an object in the hand.
    ee: EndEffector,
    /// Pose of the reported hand relative to the modelled hand.
    correction: Option<Isometry3<f64>>,
    /// True if the correction was renewed after the reference had arrived.
    is_refined: bool,
    grasp: Option<Isometry3<f64>>,
    load: Load,
    /// Joint positions at the session's start, `[rad]`: the default posture of goals.
    posture: JointVector,
    pub(super) goal: Goal,
    /// The arm in the newest state that was answered.
    arm: Measured,
    next: Option<Next>,
    /// Leash, fading to the goal's value.
    leash: Fade<Leash>,
    /// Parts that the leash held in the last answer, if any.
    held: Option<Held>,
    /// `message_id` of the state in which the goal was first seen.
    since: u64,
    /// Aim of the reference: the goal's target, a target that the lead moved closer, or rest.
    aim: Bearing,
    route: ObstacleBraking,
    reference: Reference,
    drive: Drive,
    displacement: Displacement,
    response: Unresponsive,
    /// True if the arm ignored its commands in the last answer.
    ignores: bool,
    /// Action of the session after a held goal had to be given up.
    afterwards: OnArrival,
    stage: GoalStage,
    /// `message_id` of the state at the goal's last update.
    heard: u64,
    standing: Standing,
    /// The reaction of the goal, until its condition becomes true.
    reacting: Option<Reacting>,
    /// True if the arm stops or rests at a possible contact after a reaction.
    yields: bool,
    progress: Progress,
    /// The straight line of the goal, if it has one.
    line: Option<Line>,
    /// True if the goal landed short of its target because the course was held back.
    obstructed: bool,
    /// True if the reference waits for the other arms that carry the same object.
    waits: bool,
    /// True if something holds the arm back from the reference of a carried object.
    lags: bool,
    /// Greatest speed of any point of the arm, `[m/s]`.
    speed_cap: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Standing {
    /// The session pursues the goal.
    InForce,
    /// The goal was replaced by a stop. Chunks that wait for their start time are discarded.
    TakenBack,
    /// The goal was given up for `cause`. The arm holds the last target, or brakes.
    GivenUp {
        action: OnTimeout,
        cause: Lapse,
        /// Measurements when the goal's condition became true; `None` if it had not become true.
        reacted: Option<Reacted>,
    },
    /// The goal's condition became true. The arm brakes, and then moves to the other target if
    /// there is one.
    Reacted(Reacted),
}

/// Output that follows the reference: the law's torques, or setpoints.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per session, inside its box; a box in here would allocate"
)]
enum Drive {
    Torques(Effort),
    Setpoints(SetpointStream),
}

/// Prepared values for the answer to the next state.
#[derive(Debug, Default)]
struct Next {
    /// Step of the course; `None` if the reference follows the measured position.
    step: Option<CourseStep>,
    /// The guards that have limited the command so far.
    bindings: Bindings,
}

#[derive(Debug)]
pub(super) struct Measured {
    /// `message_id` of the measured state.
    pub(super) time: u64,
    pub(super) q: JointVector,
    pub(super) dq: JointVector,
    /// Pose of the end effector according to the model.
    pub(super) modelled: Isometry3<f64>,
    /// `O_T_EE` in column-major order, not validated.
    pub(super) reported: [f64; 16],
    /// Pose of the hand as the robot reports it, computed from the model and the correction.
    pub(super) pose: Isometry3<f64>,
    /// Pose of the frame that goals move: the object in the hand, or the hand.
    pub(super) object: Isometry3<f64>,
    /// Jacobian of the end effector in the base frame.
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
            Backend::RobotController {
                controller,
                setpoints,
            } => {
                let limits = model.joint_limits();
                let stream = SetpointStream::new(controller, setpoints, version, limits);
                (state.q_d, Drive::Setpoints(stream))
            }
        };
        let q = JointVector::from(q);
        let reference = Reference::at_rest(q);
        let ee = end_effector_of(state)?;
        let load = load_of(state, version)?;
        let measured = JointVector::from(state.q);
        let (pose, jacobian) = model.pose_and_jacobian(Frame::EndEffector, &measured, &ee);
        let mut this = Self {
            drive,
            aim: Bearing::Followed(goal.target),
            // The state shows that a tool is mounted, but not the tool's shape. Therefore the Hand
            // is assumed.
            route: ObstacleBraking::new(
                Clearance::new(model, state.m_ee > 0.0, keep_out),
                goal.budget,
            ),
            displacement: Displacement::at(q),
            response: Unresponsive::default(),
            ignores: false,
            afterwards,
            stage: GoalStage::UnderWay,
            progress: Progress::default(),
            line: None,
            obstructed: false,
            arm: Measured {
                time: state.message_id,
                q: measured,
                dq: state.dq.into(),
                modelled: rigid(&pose),
                reported: state.O_T_EE,
                pose: rigid(&pose),
                object: rigid(&pose),
                jacobian,
            },
            // The first answer holds the arm without torques.
            next: Some(Next {
                step: Some(CourseStep::free(reference)),
                bindings: Bindings::default(),
            }),
            leash: Fade::at(goal.leash),
            held: None,
            since: state.message_id,
            heard: state.message_id,
            standing: Standing::InForce,
            reacting: Reacting::to(&goal, state.message_id),
            yields: false,
            posture: q,
            reference,
            goal,
            load,
            hand: ee,
            ee,
            correction: None,
            is_refined: false,
            grasp: None,
            waits: false,
            lags: false,
            speed_cap: None,
        };
        this.renew_correction();
        this.take_hold();
        this.set_out();
        Some(this)
    }

    /// Returns the `message_id` of the newest state that was answered.
    pub(super) fn newest(&self) -> u64 {
        self.arm.time
    }

    /// True if the answer to the next state is prepared.
    pub(super) fn is_prepared(&self) -> bool {
        self.next.is_some()
    }

    /// Begins with the values that earlier sessions learned about the arm.
    pub(super) fn knowing(mut self, known: Learned) -> Self {
        if let Drive::Torques(effort) = &mut self.drive {
            effort.know(known);
        }
        self
    }

    /// Sets the speed cap for every point of the arm, `[m/s]`.
    pub(super) fn no_faster_than(mut self, speed_cap: Option<f64>) -> Self {
        self.speed_cap = speed_cap;
        self
    }

    /// Returns the values learned about the arm so far. `known` are the values at the session's
    /// start.
    pub(super) fn learned(&self, known: Learned) -> Learned {
        match &self.drive {
            Drive::Torques(effort) => effort.learned(),
            Drive::Setpoints(_) => known,
        }
    }

    /// Prepares the answer to the state with `message_id` `now`: begins a `newer` goal, if there is
    /// one, plans, and moves the reference by one step. `alive` is false once the session's deadman
    /// is silent or dropped. `stop` is `Some` in the cycle that sees that the session's team has
    /// stopped. `waits` is true while the reference waits for other arms that carry the same
    /// object.
    pub(super) fn prepare(
        &mut self,
        model: &Model,
        newer: Option<&Goal>,
        (alive, stop, waits): (bool, Option<TeamStop>, bool),
        chunks: Option<&mut ChunkReader>,
        now: u64,
    ) {
        let held = self.held.take();
        let leashed = held.is_some();
        let moved = held.map_or(Ok(()), |held| held.move_course(&mut self.route.course));
        let mut bindings = Bindings::default();
        bindings.set(Guard::PlanFailure, moved.is_err());
        bindings.set(Guard::Deviation, self.watch_deviation(model, leashed));
        bindings.set(Guard::SpeedCap, self.watch_speed(model));
        bindings.set(Guard::Unresponsive, self.watch_response());
        self.react();
        if let Some(goal) = newer {
            self.take_up(goal, now);
        }
        if let Some(chunks) = chunks {
            self.follow_chunks(model, chunks, now);
        }
        self.watch(alive, now);
        self.stop_with_team(stop);
        self.wait_for_team(waits);
        bindings.set(Guard::Deadman, !alive);
        bindings.set(Guard::Team, self.has_stopped_with_team());
        let silent = matches!(
            self.standing,
            Standing::GivenUp {
                cause: Lapse::Silent { .. },
                ..
            }
        );
        bindings.set(Guard::Watchdog, silent);
        bindings.set(Guard::Lead, self.draw_nearer(now));
        self.halt_without_news(now);
        bindings.set(Guard::Reaction, self.has_reacted());
        self.yields &= self.aim.target() == Target::Rest;
        self.leash.step();
        let aim = self.aim(model, now);
        self.route.renew(model, &self.ee, &self.reference, &aim);
        let guided = matches!(self.route.course, Course::Guide(_));
        let step = (!guided).then(|| self.advance(model, &aim, now, &mut bindings));
        self.next = Some(Next { step, bindings });
    }

    /// Moves the course by one step toward `aim`, for the answer to the state `now`.
    fn advance(
        &mut self,
        model: &Model,
        aim: &Aim,
        now: u64,
        bindings: &mut Bindings,
    ) -> CourseStep {
        let posture = match self.goal.posture {
            Some(q) => Posture::asked(q.into()),
            None => Posture::kept(self.posture),
        };
        let hand = &self.hand;
        let speed_cap = self.speed_cap.map(|speed| SpeedCap { speed, hand });
        let step = self.route.step(
            model,
            &self.ee,
            (&posture, speed_cap),
            &self.reference,
            &self.arm,
            aim,
            now,
        );
        let bounds = &step.bounds;
        bindings.set(Guard::Clearance, self.route.is_bound());
        bindings.set(Guard::InverseKinematics, bounds.acceleration);
        bindings.set(Guard::JointVelocity, bounds.velocity);
        bindings.set(Guard::PositionEnvelope, bounds.position);
        bindings.set(Guard::SpeedCap, bounds.speed.is_some());
        let failed = self.route.take_failure();
        bindings.set(Guard::PlanFailure, step.failed || failed);
        step
    }

    /// Returns how far the arm was from its target when it was released.
    pub(super) fn released(&self) -> Option<PoseError> {
        match self.stage {
            GoalStage::Finished(released) => released,
            _ => None,
        }
    }

    /// Answers one state with the prepared values.
    pub(super) fn answer(
        &mut self,
        model: &Model,
        state: &RobotState,
        event: &mut Option<SessionEvent>,
    ) -> SessionStep {
        let q = JointVector::from(state.q);
        let dq = JointVector::from(state.dq);
        let dynamics = model.dynamics(&q, &dq, &self.hand, &self.load, &GRAVITY_EARTH);
        let modelled = rigid(&dynamics.pose);
        let pose = moved(modelled, self.correction.as_ref());
        self.arm = Measured {
            time: state.message_id,
            q,
            dq,
            modelled,
            reported: state.O_T_EE,
            pose,
            object: moved(pose, self.grasp.as_ref()),
            jacobian: dynamics.jacobian,
        };
        self.watch_line();
        let Next { step, mut bindings } = self.next.take().unwrap_or_default();
        let anchored = self.reanchor(model, state);
        let step = match step {
            Some(step) if !anchored => step,
            _ => {
                let aim = self.aim(model, state.message_id);
                self.advance(model, &aim, state.message_id, &mut bindings)
            }
        };
        self.reference = step.reference;
        let at_rest = dq.amax() < arrival::REST_VELOCITY;
        self.advance_stage(model, at_rest, state.message_id, event);
        self.observe(state);
        // Under the robot's own controller, the reference starts from the robot's setpoint.
        if let Drive::Torques(_) = self.drive {
            self.held = leash::hold(
                &self.leash.now(),
                &self.route.course,
                &mut self.reference,
                &self.arm,
            );
        }
        let leashed = self.held.is_some();
        bindings.set(Guard::Leash, leashed || step.leashed);
        self.watch_progress(leashed, step.held, state.message_id);
        let met = self.reacted().is_some();
        let answer = match &mut self.drive {
            Drive::Torques(effort) => {
                let limits = model.joint_limits();
                let resistance = if self.stage.lets_go() {
                    Resistance::Release
                } else if self.yields {
                    Resistance::Yield
                } else {
                    Resistance::Overcome
                };
                let reference = &self.reference;
                let tau = effort.step(
                    reference,
                    state,
                    &dynamics,
                    limits,
                    (resistance, met),
                    &mut bindings,
                );
                let demanded = Commanded::Torques(effort.demanded());
                self.ignores = self.response.watch(state, demanded);
                SessionCommand::Torques(Torques(tau.into()))
            }
            Drive::Setpoints(stream) => {
                let last = matches!(self.stage, GoalStage::Finished(_));
                let (command, changed) =
                    stream.command(model, &self.ee, &self.reference, last, state);
                bindings.set(Guard::Backstop, changed);
                let setpoint = Commanded::Setpoint {
                    controller: stream.controller(),
                    differs: anchored,
                    changed,
                };
                self.ignores = self.response.watch(state, setpoint);
                SessionCommand::Setpoint(command)
            }
        };
        SessionStep {
            answer,
            trace: Trace {
                goal: self.goal.id,
                reference: self.reference,
                target: Some(self.target_at(state.message_id)),
                elapsed: Duration::from_millis(state.message_id - self.since),
                remaining: Duration::try_from_secs_f64(
                    self.route.course.remaining(state.message_id),
                )
                .unwrap_or(Duration::MAX),
                compensation: match &self.drive {
                    Drive::Torques(effort) => effort.compensated(),
                    Drive::Setpoints(_) => JointVector::zeros(),
                },
                bindings,
            },
            finished: matches!(self.stage, GoalStage::Finished(_)),
        }
    }

    /// Moves the reference to the setpoint of the robot's controller, if the two differ, and plans
    /// the course anew from there. Returns true if the reference was moved.
    fn reanchor(&mut self, model: &Model, state: &RobotState) -> bool {
        let Drive::Setpoints(stream) = &mut self.drive else {
            return false;
        };
        let Some(echo) = stream.echo(model, &self.ee, &self.reference, state) else {
            return false;
        };
        let correction = stream.correction(model, &self.hand, &echo.q, state);
        self.reference = echo;
        if let Some(correction) = correction {
            self.correct(correction);
        }
        let mut aim = self.aim(model, state.message_id);
        let target = match self.stage {
            GoalStage::UnderWay => aim.target,
            GoalStage::Landing(_)
            | GoalStage::Staying
            | GoalStage::Releasing(_)
            | GoalStage::Restless
            | GoalStage::Finished(_) => Target::Rest,
        };
        aim.target = target;
        self.route
            .begin_again(model, &self.ee, &self.reference, &aim);
        true
    }
}
