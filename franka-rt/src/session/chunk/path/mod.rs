//! Paths: places without times, through which the arm moves as fast as its budget allows.
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

/// A place on a path, and the distance from it at which the path may begin to round the corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    target: Target,
    blend: f64,
}

impl Waypoint {
    /// Maximum number of waypoints on a path.
    pub const COUNT_MAX: usize = 100;

    /// Creates a waypoint at which the arm stops. The target is a pose of the end effector in the
    /// base frame, in metres, or joint positions, `[rad]`.
    pub fn new(target: impl Into<Target>) -> Self {
        let blend = 0.0;
        Self {
            target: target.into(),
            blend,
        }
    }

    /// Rounds the corner at this waypoint. The path leaves the straight line to the waypoint at
    /// this distance before the waypoint, and joins the next line at this distance after it. If a
    /// line is shorter than twice the distance, the path leaves or joins it in its middle.
    ///
    /// For poses, the distance is the end effector's, `[m]`; a rotation counts as the distance that
    /// the budget allows in the same time. For joint positions, it is the norm over the joints,
    /// `[rad]`. The arm always stops at the last waypoint of a path.
    #[must_use]
    pub fn blend(mut self, distance: f64) -> Self {
        self.blend = distance;
        self
    }

    /// Returns the target of the waypoint.
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
    /// Creates a path through `waypoints`, without times, within the budget of `goal`, from the
    /// joint positions `q`, `[rad]`. The path begins when the session accepts it, waits while
    /// something holds the arm back, and can be paused.
    ///
    /// This takes some milliseconds for each rounded waypoint. Do not call it on the control
    /// thread. The private module `fastest` defines how close the result is to the fastest motion;
    /// `reach` defines the checks.
    ///
    /// # Errors
    /// Returns a [`PathError`] if a waypoint is invalid or the arm cannot follow the path.
    pub fn through(
        waypoints: &[Waypoint],
        q: &[f64; 7],
        goal: &Goal,
        model: &Model,
        state: &RobotState,
    ) -> Result<Self, PathError> {
        Self::planned(waypoints, q, goal, model, state, |_, _| {})
    }

    /// Same as [`Self::through`]. Also calls `pass` for closely spaced places along the whole path,
    /// in order, with the time, `[s]`, and the joint positions.
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

/// Number of places between two states of a joint path for which `pass` is called.
const SAMPLES: usize = 8;
