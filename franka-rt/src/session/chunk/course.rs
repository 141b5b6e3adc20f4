//! The course of a reference that follows chunks: how it advances in each cycle.

use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, Model, rotation};
use franka_otg::AxisLimits;
use nalgebra::{Isometry3, SVector, Translation3};

use super::curve_state::{CurveState, JointExtent, stacked};
use super::player::Player;
use super::quintic::PointState;
use super::ring::{ChunkReader, Fate};
use super::servo;
use super::value::{Chunk, Points};
use crate::session::course::{CourseStep, limits_of_joint};
use crate::session::guard::joint_bounds::BRAKING;
use crate::session::guard::leash;
use crate::session::guard::speed_cap::SpeedCap;
use crate::session::kinematics::{self, Drift, Posture};
use crate::session::pose::PoseState;
use crate::session::reference::Reference;
use crate::session::{Budget, GoalId, Target, approach, rigid};

/// Follows the current chunk within a budget.
#[derive(Debug)]
pub(in crate::session) struct ChunkCourse {
    goal: GoalId,
    budget: Budget,
    /// Distance of the reference behind the chunk, divided by the permitted distance.
    lag: f64,
    play: Play,
}

#[derive(Debug)]
enum Play {
    Joints {
        player: Player<Reference>,
        limits: [AxisLimits; 7],
    },
    Poses {
        player: Player<PoseState>,
        state: PoseState,
        drift: Drift,
        /// Posture with which a path was checked: the joint positions at its start. `None` for
        /// other chunks.
        posture: Option<Posture>,
        translation: AxisLimits,
        rotation: AxisLimits,
    },
}

/// Situation when the session begins to follow a chunk.
#[derive(Debug)]
pub(in crate::session) struct ChunkStart<'a> {
    /// Reference in the previous answer.
    pub(in crate::session) reference: &'a Reference,
    /// Pose that the reference follows, or otherwise the pose of its end effector.
    pub(in crate::session) pose: PoseState,
    /// Rest of a previous motion of the joints.
    pub(in crate::session) drift: Drift,
    pub(in crate::session) before: Option<&'a ChunkCourse>,
    /// `message_id` of the state that is answered.
    pub(in crate::session) now: u64,
}

impl ChunkCourse {
    pub(in crate::session) fn new(
        model: &Model,
        goal: GoalId,
        budget: Budget,
        chunk: Chunk,
        start: ChunkStart<'_>,
    ) -> Self {
        let ChunkStart {
            reference,
            pose,
            drift,
            before,
            now,
        } = start;
        let Chunk {
            points,
            origin,
            blend,
            pace,
            ..
        } = chunk;
        let asked = (origin, blend, pace);
        let play = match points {
            Points::Joints(curve) => {
                let wanted = before.and_then(|before| before.joints_at(now.saturating_sub(1)));
                Play::Joints {
                    limits: joint_limits(model.joint_limits(), curve.extent(), reference, &budget),
                    player: Player::new(curve, asked, (reference, wanted), now),
                }
            }
            Points::Poses(curve) => {
                let wanted = before.and_then(|before| before.pose_at(now.saturating_sub(1)));
                let limits = pose_limits(model, &pose, &budget);
                let posture = pace.map(|_| Posture::kept(reference.q));
                Play::Poses {
                    player: Player::new(curve, asked, (&pose, wanted), now),
                    state: pose,
                    // The motion to another posture fades out.
                    drift: posture.map_or(drift, |_| Drift::of(reference.dq)),
                    posture,
                    translation: limits.translation,
                    rotation: limits.rotation,
                }
            }
        };
        Self {
            goal,
            budget,
            lag: 0.0,
            play,
        }
    }

    /// Returns the desired joint state at the time `now`, if the chunk moves joints.
    fn joints_at(&self, now: u64) -> Option<Reference> {
        match &self.play {
            Play::Joints { player, .. } => Some(player.at(now)),
            Play::Poses { .. } => None,
        }
    }

    /// Returns the desired pose at the time `now`, if the chunk moves the end effector.
    fn pose_at(&self, now: u64) -> Option<PoseState> {
        match &self.play {
            Play::Joints { .. } => None,
            Play::Poses { player, .. } => Some(player.at(now)),
        }
    }

    /// Continues from `reference` within another budget. The times of the chunk do not change, so a
    /// lag from a slower budget is later caught up.
    pub(in crate::session) fn keep_to(
        &mut self,
        model: &Model,
        reference: &Reference,
        changed: Budget,
    ) {
        self.budget = changed;
        match &mut self.play {
            Play::Joints { player, limits } => {
                let extent = player.curve().extent();
                *limits = joint_limits(model.joint_limits(), extent, reference, &changed);
            }
            Play::Poses {
                state,
                translation,
                rotation,
                ..
            } => {
                let limits = pose_limits(model, state, &changed);
                (*translation, *rotation) = (limits.translation, limits.rotation);
            }
        }
    }

    /// Pauses on a path, or resumes.
    pub(in crate::session) fn set_paused(&mut self, paused: bool) {
        match &mut self.play {
            Play::Joints { player, .. } => player.set_paused(paused),
            Play::Poses { player, .. } => player.set_paused(paused),
        }
    }

    /// Continues from `reference`, and from the `pose` of its end effector, after something else
    /// has moved them.
    pub(in crate::session) fn begin_again(
        &mut self,
        model: &Model,
        reference: &Reference,
        pose: PoseState,
    ) {
        if let Play::Poses { state, drift, .. } = &mut self.play {
            (*state, *drift) = (pose, Drift::of(reference.dq));
        }
        self.keep_to(model, reference, self.budget);
    }

    /// Advances by one cycle from `reference`, while the state `now` is answered.
    pub(in crate::session) fn step(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        (posture, speed_cap): (&Posture, Option<SpeedCap<'_>>),
        reference: &Reference,
        now: u64,
    ) -> CourseStep {
        match &mut self.play {
            Play::Joints { player, limits } => {
                player.step(self.lag);
                let there = player.at(now);
                let next = follow_joints(model.joint_limits(), limits, reference, &there);
                self.lag = next.lag(&there);
                CourseStep::free(next)
            }
            Play::Poses {
                player,
                state,
                drift,
                posture: own,
                translation,
                rotation,
            } => {
                let posture = match own {
                    Some(kept) if !posture.is_asked() => kept,
                    _ => posture,
                };
                player.step(self.lag);
                let there = player.at(now);
                *state = follow_pose(translation, rotation, state, &there);
                let next = state.moving();
                let (reference, bounds) = kinematics::follow(
                    model,
                    ee,
                    (posture, speed_cap),
                    drift,
                    reference,
                    &next,
                    &self.budget,
                );
                state.twist *= bounds.speed.unwrap_or(1.0);
                let mut held = false;
                if bounds.any() {
                    let reached = rigid(&model.pose(Frame::EndEffector, &reference.q, ee));
                    if let Some(pose) = leash::tethered(&state.pose, &reached) {
                        state.pose = pose;
                        held = true;
                    }
                }
                self.lag = state.lag(&there);
                CourseStep {
                    reference,
                    bounds,
                    held,
                    leashed: false,
                    failed: false,
                }
            }
        }
    }

    /// Returns the pose that the joint reference follows, and the rest of a previous motion of the
    /// joints. Returns `None` if the chunk moves joints.
    pub(in crate::session) fn pose(&self) -> Option<(PoseState, Drift)> {
        match &self.play {
            Play::Joints { .. } => None,
            Play::Poses { state, drift, .. } => Some((*state, *drift)),
        }
    }

    /// Sets that pose to `pose` and keeps its velocity. The course then catches up the resulting
    /// lag.
    pub(in crate::session) fn reanchor(&mut self, pose: Isometry3<f64>) {
        if let Play::Poses { state, .. } = &mut self.play {
            state.pose = pose;
        }
    }

    pub(in crate::session) fn is_over(&self, now: u64) -> bool {
        match &self.play {
            Play::Joints { player, .. } => player.is_over(now),
            Play::Poses { player, .. } => player.is_over(now),
        }
    }

    pub(in crate::session) fn remaining(&self, now: u64) -> f64 {
        match &self.play {
            Play::Joints { player, .. } => player.remaining(now),
            Play::Poses { player, .. } => player.remaining(now),
        }
    }

    pub(in crate::session) fn target(&self) -> Target {
        match &self.play {
            Play::Joints { player, .. } => Target::Joints(player.curve().last().q.into()),
            Play::Poses { player, .. } => Target::Pose(player.curve().last().pose),
        }
    }

    /// Returns the chunk to the writer. The course must have ended by `now`.
    pub(in crate::session) fn end(self, chunks: &mut ChunkReader, now: u64) {
        let fate = if self.is_over(now) {
            Fate::Ended
        } else {
            Fate::Replaced
        };
        let chunk = match self.play {
            Play::Joints { player, .. } => player.into_chunk(),
            Play::Poses { player, .. } => player.into_chunk(),
        };
        chunks.give_back(self.goal, chunk, fate);
    }
}

/// Returns the limits of the end effector: its budget, or more if its present motion exceeds the
/// budget.
fn pose_limits(model: &Model, now: &PoseState, budget: &Budget) -> Budget {
    budget.able_to_stop(&now.twist, &now.acceleration, model.cartesian_limits())
}

/// Returns the limits of each joint on a path through points of this `extent`. They are the joint's
/// budget, or more if its present motion exceeds the budget. They are low enough for the points
/// nearest to the ends of its range.
fn joint_limits(
    robot: &JointLimits,
    extent: &JointExtent,
    reference: &Reference,
    budget: &Budget,
) -> [AxisLimits; 7] {
    core::array::from_fn(|i| {
        let q = reference.q[i];
        let (lower, upper) = (extent.lower[i].min(q), extent.upper[i].max(q));
        let limits = limits_of_joint(i, robot, reference, budget.joints[i], false);
        let limits = approach::limits(i, robot, q, upper, limits);
        if lower < q {
            approach::limits(i, robot, q, lower, limits)
        } else {
            limits
        }
    })
}

/// Advances each joint separately. If the motion between points leaves a joint's range, the joint
/// waits at the end of the range.
fn follow_joints(
    robot: &JointLimits,
    limits: &[AxisLimits; 7],
    now: &Reference,
    target: &Reference,
) -> Reference {
    let mut next = *now;
    for (i, limits) in limits.iter().enumerate() {
        let (lower, upper) = approach::range(i, robot);
        let here = PointState {
            p: SVector::from([now.q[i]]),
            v: SVector::from([now.dq[i]]),
            a: SVector::from([now.ddq[i]]),
        };
        let there = PointState {
            p: SVector::from([target.q[i].clamp(lower, upper)]),
            v: SVector::from([target.dq[i]]),
            a: SVector::from([target.ddq[i]]),
        };
        let stoppable = |room: f64| (2.0 * BRAKING * room.max(0.0)).sqrt();
        let (back, on) = (stoppable(now.q[i] - lower), stoppable(upper - now.q[i]));
        let moved = servo::follow(&here, &there, limits, |v| v.map(|v| v.clamp(-back, on)));
        (next.q[i], next.dq[i], next.ddq[i]) = (moved.p[0], moved.v[0], moved.a[0]);
    }
    next
}

/// Advances translation and rotation; a limit applies to the norm of each. Angular velocity and
/// acceleration are in base axes, so that they stay within the budget there. In one cycle, the
/// rotation vector differs from them only in the third order.
fn follow_pose(
    translation: &AxisLimits,
    turning: &AxisLimits,
    now: &PoseState,
    target: &PoseState,
) -> PoseState {
    let way = servo::follow(
        &now.translation(),
        &target.translation(),
        translation,
        |v| v,
    );
    let there = PointState {
        p: rotation::error(&target.pose.rotation, &now.pose.rotation),
        ..target.rotation()
    };
    let turn = servo::follow(&now.rotation(), &there, turning, |v| v);
    PoseState {
        pose: Isometry3::from_parts(
            Translation3::from(way.p),
            rotation::exp(&turn.p) * now.pose.rotation,
        ),
        twist: stacked(&way.v, &turn.v),
        acceleration: stacked(&way.a, &turn.a),
    }
}
