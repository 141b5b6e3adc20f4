//! Paths: places without times, which the arm goes through as fast as its budget allows.
//!
//! ```text
//! waypoints -> joints, poses -> timing  -> fastest       -> reach        -> chunk
//!              the legs         a plan     the same way     can the arm
//!                               within     in the least     follow it?
//!                               limits     time
//! ```

mod banded;
mod error;
mod fastest;
mod joints;
mod least_time;
mod legs;
mod line;
#[cfg(test)]
mod oracle;
mod poses;
mod preview;
mod reach;
mod spline;
#[cfg(test)]
mod tests;
mod timing;

use franka_model::{Frame, JointVector, Model};
use franka_proto::RobotState;

pub use self::error::PathError;
pub use self::preview::{Blocked, Preview};
use self::reach::Arm;
use super::value::{Chunk, Points};
use crate::session::geometry::reported_end_effector;
use crate::session::kinematics::Posture;
use crate::session::{Goal, Target, check, rigid};

/// A place on a path, and how far from it the path may round its corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    target: Target,
    blend: f64,
}

impl Waypoint {
    /// The most of one path.
    pub const COUNT_MAX: usize = 100;

    /// A pose of the end effector in the base frame, metres, or joint positions, `[rad]`, at which
    /// the arm stops.
    pub fn new(target: impl Into<Target>) -> Self {
        let blend = 0.0;
        Self {
            target: target.into(),
            blend,
        }
    }

    /// Rounds the corner: the path leaves the straight line to this waypoint at this distance
    /// before it, and is on the next line at this distance after it, or in the middle of a line
    /// that is shorter than twice that. For poses `[m]` of the end effector, where a turn counts as
    /// the way that the budget allows in the time of the turn; for joint positions `[rad]`, the
    /// norm over the joints. The last waypoint of a path is stopped at all the same.
    #[must_use]
    pub fn blend(mut self, distance: f64) -> Self {
        self.blend = distance;
        self
    }

    /// Where it is.
    pub fn target(&self) -> &Target {
        &self.target
    }
}

impl<T: Into<Target>> From<T> for Waypoint {
    fn from(target: T) -> Self {
        Self::new(target)
    }
}

impl Chunk {
    /// Through `waypoints` without times, within the budget of `goal`, from where the joints `q`
    /// are, `[rad]`. It begins when it is taken up, waits while the arm is held back, and can be
    /// paused.
    ///
    /// It takes some milliseconds for each waypoint that is rounded, and is not for the control
    /// thread. What is fastest, and to how much: `fastest`; what is checked: `reach`.
    ///
    /// # Errors
    /// [`PathError`].
    pub fn through(
        waypoints: &[Waypoint],
        q: &[f64; 7],
        goal: &Goal,
        model: &Model,
        state: &RobotState,
    ) -> Result<Self, PathError> {
        Self::planned(waypoints, q, goal, model, state, |_, _| {})
    }

    /// As [`Self::through`]; `pass` is called with the time, `[s]`, and the joint positions of
    /// places all along the path, in their order, which are near each other.
    fn planned(
        waypoints: &[Waypoint],
        q: &[f64; 7],
        goal: &Goal,
        model: &Model,
        state: &RobotState,
        mut pass: impl FnMut(f64, &JointVector),
    ) -> Result<Self, PathError> {
        let first = waypoints.first().ok_or(PathError::Empty)?;
        if waypoints.len() > Waypoint::COUNT_MAX {
            return Err(PathError::TooMany);
        }
        for (waypoint, place) in (1..).zip(waypoints) {
            let Waypoint { target, blend } = *place;
            let of_kind = matches!(
                (first.target, target),
                (Target::Joints(_), Target::Joints(_)) | (Target::Pose(_), Target::Pose(_))
            );
            if !of_kind {
                return Err(PathError::Kind { waypoint });
            }
            if !(blend >= 0.0 && blend.is_finite()) {
                let got = blend;
                return Err(PathError::Blend { waypoint, got });
            }
            check::target(&target, model, state)
                .map_err(|error| PathError::Waypoint { waypoint, error })?;
        }
        let (q, budget) = (JointVector::from(*q), &goal.budget);
        let (points, pace) = if let Target::Joints(_) = first.target {
            let way = joints::through_joints(waypoints, q, budget, model.joint_limits());
            way.each(SAMPLES, |time, state| pass(time, &state.q));
            let pace = joints::pace(&way.states, budget);
            (Points::Joints(way.into_curve()), pace)
        } else {
            let ee = reported_end_effector(model, state).unwrap_or_default();
            let start = rigid(&model.pose(Frame::EndEffector, &q, &ee));
            let way = poses::through_poses(waypoints, start, budget)?;
            let posture = goal
                .posture
                .map_or(Posture::kept(q), |q| Posture::asked(q.into()));
            let arm = Arm {
                posture: &posture,
                budget,
                model,
                stride: 1.0,
                ee: &ee,
            };
            reach::check(&way, q, &arm, &mut pass)?;
            let pace = poses::pace(&way.states, budget);
            (Points::Poses(way.into_curve()), pace)
        };
        Ok(Self {
            pace: Some(pace),
            ..Self::of(points)
        })
    }
}

/// Places to pass between two states of a path over joint positions.
const SAMPLES: usize = 8;
