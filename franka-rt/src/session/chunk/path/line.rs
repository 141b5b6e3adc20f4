//! Straight lines to a pose: checks that the arm can follow a line from its present place, and
//! finds the elbow for it.
//!
//! A reachable pose does not guarantee a straight path to it. On a line that turns the hand far,
//! joints may reach the ends of their ranges with the present elbow, but not with another one.
//! Therefore the line is followed before anything moves, as for a path: first with the elbow kept,
//! then with the elbow drawn to each of the postures that reach the pose.

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
    /// Searches a straight line from the joint positions `q`, `[rad]`, to the pose of a goal that
    /// ends there. If the arm cannot follow the line with its elbow near `kept`, `[rad]`, but can
    /// with its elbow drawn to another posture, the goal gets that [posture](Self::posture).
    ///
    /// A goal that the arm can reach, although not on the line, stays as it is. The same applies to
    /// goals that do not end at a pose, to goals with a [reaction](Self::reaction) or with an
    /// object in the hand, and to goals that [`check`](Self::check) refuses. Keep-out regions are
    /// not considered.
    ///
    /// This usually takes a millisecond, and at most ten. Do not call it on the control thread.
    ///
    /// # Errors
    /// [`GoalError::NoLine`] if the arm does not reach the pose with any of these postures.
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
        if matches!(hindrance, Hindrance::Range(_)) && line.ends_there(&own) {
            return Ok(());
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

/// Number of postures that are tried for the elbow, nearest first.
const LED: usize = 8;

/// Number of steps along a line that the first, coarse check combines.
const GLANCE: f64 = 4.0;

/// Greatest turn of a joint between two checks of the arm's distance to itself, `[rad]`.
const TURN: f64 = 0.03;

/// A straight line and a turn about one axis.
struct Line<'a> {
    way: Timed<PoseState>,
    q: JointVector,
    budget: &'a Budget,
    model: &'a Model,
    ee: EndEffector,
    clearance: Clearance,
}

impl<'a> Line<'a> {
    /// Creates the line from the joint positions `q` to the pose `there`; `None` if it has no plan.
    fn new(
        there: &Isometry3<f64>,
        q: JointVector,
        budget: &'a Budget,
        model: &'a Model,
        (ee, hand): (EndEffector, bool),
    ) -> Option<Self> {
        let start = rigid(&model.pose(Frame::EndEffector, &q, &ee));
        let turn = rotation::error(&there.rotation, &start.rotation);
        // A path turns less between two waypoints.
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

    /// Follows the line to its end, in steps `stride` times as long as the steps of a check.
    fn follow(&self, posture: &Posture, stride: f64) -> Result<(), Hindrance> {
        let mut last = self.q;
        let way = self.arm(posture, stride).along(&self.way, self.q, |step| {
            let before = core::mem::replace(&mut last, step.q);
            if step.off.size() > 1.0 {
                let joint = joint_bounds::at_end(self.model.joint_limits(), &step.q);
                return ControlFlow::Break(Hindrance::Range(joint.map(|joint| joint as u8)));
            }
            match self.is_clear(&before, &step.q) {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(Hindrance::Itself),
            }
        });
        way.break_value().map_or(Ok(()), Err)
    }

    /// True if the arm, when it may leave the line, reaches the end of the line without coming too
    /// close to itself.
    fn ends_there(&self, posture: &Posture) -> bool {
        let (mut last, mut off) = (self.q, 0.0);
        let way = self.arm(posture, 1.0).along(&self.way, self.q, |step| {
            let before = core::mem::replace(&mut last, step.q);
            off = step.off.size();
            match self.is_clear(&before, &step.q) {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        way.is_continue() && off <= 1.0
    }

    /// True if the arm keeps clear of itself while its joints move to `to` together.
    fn is_clear_over_joints(&self, to: &JointVector) -> bool {
        let turns = ((to - self.q).amax() / TURN).ceil().max(1.0);
        let mut last = self.q;
        (1..=turns as u32).all(|turn| {
            let next = self.q.lerp(to, f64::from(turn) / turns);
            self.is_clear(&core::mem::replace(&mut last, next), &next)
        })
    }

    /// True if the arm is not too near itself at `next`, or at least no nearer than at `now`.
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

/// Returns postures that reach a pose with room to the ends of the joints' ranges, the nearest to
/// `q` first. Each branch contributes its nearest posture and the posture with the most room.
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

/// Intervals of the sweep of joint 7 through its range.
const SWEEP: u32 = 64;

/// Room of a posture to the ends of the joints' ranges, `[rad]`: a little more than the joints keep
/// on the way to a pose.
const ROOM: f64 = 0.06;
