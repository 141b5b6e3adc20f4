//! Straight lines to a pose. This file checks that the arm can follow a line from its present
//! place, and finds an elbow with which it can.
//!
//! If the arm can reach a pose, it may still be unable to reach it on a straight line. On a line
//! that rotates the hand far, joints may reach the ends of their ranges with the present elbow, but
//! not with another elbow. Therefore the line is simulated before anything moves, as for a path:
//! first with the present elbow, then with the elbow moved to each of the postures that reach the
//! pose.

use core::ops::ControlFlow;

use franka_model::{EndEffector, Frame, JointVector, Model, analytic_ik, rotation};
use franka_proto::RobotState;
use nalgebra::{Isometry3, Translation3};

use super::Waypoint;
use super::fastest::Timed;
use super::poses::through_poses;
use super::reach::Arm;
use crate::session::chunk::value::TURN_MAX;
use crate::session::geometry::reported_end_effector;
use crate::session::guard::clearance::{Clearance, KeepOut};
use crate::session::guard::joint_bounds;
use crate::session::kinematics::Posture;
use crate::session::pose::PoseState;
use crate::session::{Budget, Goal, GoalError, Hindrance, OnArrival, Target, rigid};

impl Goal {
    /// Searches for a straight line from the joint positions `q`, `[rad]`, to the pose at which the
    /// goal ends. If the arm cannot follow the line with its elbow near `kept`, `[rad]`, but can
    /// with its elbow moved to another posture, sets that posture as the goal's
    /// [posture](Self::posture).
    ///
    /// The goal does not change if it does not end at a pose, if it has a
    /// [reaction](Self::reaction) or an object in the hand, or if [`check`](Self::check) refuses
    /// it. Keep-out regions are not considered.
    ///
    /// This usually takes a millisecond, and rarely more than four. Do not call it on the control
    /// thread.
    ///
    /// # Errors
    /// Returns [`GoalError::NoLine`] if the arm cannot follow the line with any of these postures,
    /// even if it can reach the pose in another way.
    pub fn plan_line(
        &mut self,
        q: &[f64; 7],
        kept: &[f64; 7],
        model: &Model,
        state: &RobotState,
    ) -> Result<(), GoalError> {
        let Target::Pose(there) = self.target else {
            return Ok(());
        };
        let arrives = self.on_arrival != OnArrival::Hold && self.reaction.is_none();
        if !arrives || self.along_path || self.grasp.is_some() || self.check(model, state).is_err()
        {
            return Ok(());
        }
        let ee = reported_end_effector(model, state).unwrap_or_default();
        let q = JointVector::from(*q);
        let Some(line) = Line::new(&there, q, &self.budget, model, (ee, state.m_ee > 0.0)) else {
            return Ok(());
        };
        let own = match self.posture {
            Some(posture) => Posture::asked(posture.into()),
            None => Posture::kept((*kept).into()),
        };
        let Err(hindrance) = line.follow(&own, 1.0) else {
            return Ok(());
        };
        let postures = postures(model, &there, &line.ee, &q);
        if self.posture.is_none() {
            let leads = |q: &&JointVector| {
                let posture = Posture::asked(**q);
                line.follow(&posture, GLANCE).is_ok() && line.follow(&posture, 1.0).is_ok()
            };
            if let Some(posture) = postures.iter().take(LED).find(leads) {
                self.posture = Some((*posture).into());
                return Ok(());
            }
        }
        let reached = |to: &&JointVector| line.is_clear_over_joints(to);
        let p = there.translation.vector;
        Err(GoalError::NoLine {
            x: p.x,
            y: p.y,
            z: p.z,
            hindrance,
            posture: postures.iter().find(reached).map(|q| (*q).into()),
        })
    }
}

/// Number of postures that are tried for the elbow, beginning with the nearest.
const LED: usize = 8;

/// Step length of the first, coarse check of a line, as a multiple of the usual step.
const GLANCE: f64 = 4.0;

/// Distance of each joint from the ends of its range along the line, `[rad]`, unless the joint is
/// nearer at the start or at the target. In the motion, the joints differ slightly from the plan.
const SPARE: f64 = 0.1;

/// Least distance of each joint from the ends of its range, `[rad]`, even at the target, unless
/// the joint is nearer at the start.
const LEAST: f64 = 0.03;

/// Part of the distance at the start or at the target that a joint may lose on the way, `[rad]`.
const NEARER: f64 = 0.02;

/// Greatest rotation of a joint between two checks of the arm's distance to itself, `[rad]`.
const TURN: f64 = 0.03;

/// A straight line, combined with a rotation about one axis.
struct Line<'a> {
    way: Timed<PoseState>,
    q: JointVector,
    budget: &'a Budget,
    model: &'a Model,
    ee: EndEffector,
    clearance: Clearance,
}

impl<'a> Line<'a> {
    /// Creates the line from the joint positions `q` to the pose `there`. Returns `None` if no plan
    /// can be made.
    fn new(
        there: &Isometry3<f64>,
        q: JointVector,
        budget: &'a Budget,
        model: &'a Model,
        (ee, hand): (EndEffector, bool),
    ) -> Option<Self> {
        let start = rigid(&model.pose(Frame::EndEffector, &q, &ee));
        let turn = rotation::error(&there.rotation, &start.rotation);
        // Between two waypoints, a path must rotate less.
        let middle = (turn.norm() >= TURN_MAX).then(|| {
            let middle = start
                .translation
                .vector
                .lerp(&there.translation.vector, 0.5);
            let turned = rotation::exp(&(turn * 0.5)) * start.rotation;
            Isometry3::from_parts(Translation3::from(middle), turned)
        });
        let places = middle.into_iter().chain([*there]);
        let waypoints: Vec<Waypoint> = places.map(Waypoint::new).collect();
        let way = through_poses(&waypoints, start, budget).ok()?;
        Some(Self {
            way,
            q,
            budget,
            model,
            ee,
            clearance: Clearance::new(model, hand, KeepOut::default()),
        })
    }

    /// Follows the line to its end. The steps are `stride` times as long as in a full check.
    fn follow(&self, posture: &Posture, stride: f64) -> Result<(), Hindrance> {
        let limits = self.model.joint_limits();
        let start = joint_bounds::distance_to_end(limits, &self.q);
        let floor = start.map(|start| LEAST.min(start - NEARER));
        let mut last = self.q;
        let mut least = start;
        let way = self.arm(posture, stride).along(&self.way, self.q, |step| {
            let before = core::mem::replace(&mut last, step.q);
            least = least.inf(&joint_bounds::distance_to_end(limits, &last));
            if step.off.size() > 1.0 {
                let joint = joint_bounds::at_end(limits, &step.q);
                return ControlFlow::Break(Hindrance::Range(joint.map(|joint| joint as u8)));
            }
            if let Some(i) = (0..7).find(|&i| least[i] < floor[i]) {
                return ControlFlow::Break(Hindrance::Range(Some(i as u8 + 1)));
            }
            match self.is_clear(&before, &step.q) {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(Hindrance::Itself),
            }
        });
        if let ControlFlow::Break(hindrance) = way {
            return Err(hindrance);
        }
        let end = joint_bounds::distance_to_end(limits, &last);
        let strained = (0..7).find(|&i| {
            let room = (start[i].min(end[i]) - NEARER).min(SPARE);
            least[i] < room.max(floor[i])
        });
        strained.map_or(Ok(()), |i| Err(Hindrance::Range(Some(i as u8 + 1))))
    }

    /// True if the arm keeps clear of itself while all joints move to `to` at the same time.
    fn is_clear_over_joints(&self, to: &JointVector) -> bool {
        let turns = ((to - self.q).amax() / TURN).ceil().max(1.0);
        let mut last = self.q;
        (1..=turns as u32).all(|turn| {
            let next = self.q.lerp(to, f64::from(turn) / turns);
            self.is_clear(&core::mem::replace(&mut last, next), &next)
        })
    }

    /// True if the arm is not too near to itself at `next`, or no nearer than at `now`.
    fn is_clear(&self, now: &JointVector, next: &JointVector) -> bool {
        self.clearance.too_near(now, next).is_none()
    }

    fn arm<'b>(&'b self, posture: &'b Posture, stride: f64) -> Arm<'b> {
        Arm {
            posture,
            budget: self.budget,
            model: self.model,
            ee: &self.ee,
            stride,
        }
    }
}

/// Returns postures that reach a pose with room to the ends of the joints' ranges, beginning with
/// the nearest to `q`. Each branch of solutions contributes two: its nearest posture, and its
/// posture with the most room.
fn postures(
    model: &Model,
    there: &Isometry3<f64>,
    ee: &EndEffector,
    q: &JointVector,
) -> Vec<JointVector> {
    let limits = model.joint_limits();
    let [lower, upper] = [limits.lower[6], limits.upper[6]];
    let mut found: [[Option<(f64, JointVector)>; 2]; 8] = Default::default();
    for step in 0..=SWEEP {
        let joint_7 = lower + (upper - lower) * f64::from(step) / f64::from(SWEEP);
        let given = analytic_ik::Redundancy::Joint7(joint_7);
        let Ok(solutions) = analytic_ik::solve(model, there, ee, given) else {
            break;
        };
        for solution in solutions.iter() {
            let room = solution.limit_margin(limits);
            if room < ROOM {
                continue;
            }
            let [nearest, roomiest] = &mut found[solution.branch.index()];
            for (best, worth) in [(nearest, -(solution.q - q).norm()), (roomiest, room)] {
                if best.is_none_or(|(least, _)| worth > least) {
                    *best = Some((worth, solution.q));
                }
            }
        }
    }
    let mut postures: Vec<_> = found.iter().flatten().flatten().map(|(_, q)| *q).collect();
    let away = |posture: &JointVector| (posture - q).norm();
    postures.sort_by(|a, b| away(a).total_cmp(&away(b)));
    postures.dedup();
    postures
}

/// Number of intervals in which joint 7 sweeps its range.
const SWEEP: u32 = 64;

/// Room between a posture and the ends of the joints' ranges, `[rad]`. It is slightly more than the
/// joints keep on the way to a pose.
const ROOM: f64 = 0.06;
