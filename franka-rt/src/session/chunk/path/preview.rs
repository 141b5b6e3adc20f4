//! What an arm does along a path, before it does it.

use core::time::Duration;

use franka_model::collision::Obstacle;
use franka_model::{JointVector, Model};
use franka_proto::RobotState;

use super::{PathError, Waypoint};
use crate::session::check::check_keep_out;
use crate::session::guard::clearance::Clearance;
use crate::session::{Chunk, Goal, GoalError};

/// What an arm does along a path: its joint positions at times. Between two of them no joint turns
/// by more than a few hundredths of a radian, and the end effector goes by 5 mm at most if the path
/// is one of poses.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Preview {
    /// Times from the begin of the motion on, which grow, and joint positions, `[rad]`. The first
    /// are those of the begin, the last those at the end of the path.
    pub postures: Vec<(Duration, [f64; 7])>,
}

impl Preview {
    /// What an arm at the joint positions `q`, `[rad]`, would do. It takes as long as
    /// [`Chunk::through`], and refuses the same paths.
    ///
    /// # Errors
    /// [`PathError`].
    pub fn of(
        waypoints: &[Waypoint],
        q: &[f64; 7],
        goal: &Goal,
        model: &Model,
        state: &RobotState,
    ) -> Result<Self, PathError> {
        let mut postures = vec![(Duration::ZERO, *q)];
        Chunk::planned(waypoints, q, goal, model, state, |time, q: &JointVector| {
            // Where nothing is to be done there is one place with the time of the begin.
            let time = Duration::try_from_secs_f64(time).unwrap_or_default();
            if postures.last().is_some_and(|(before, _)| time > *before) {
                postures.push((time, (*q).into()));
            }
        })?;
        Ok(Self { postures })
    }

    /// Until the reference is at the end, if nothing holds it up: guards that bind and joints that
    /// are asked for more than their limits do. The arm settles after that.
    pub fn duration(&self) -> Duration {
        self.postures
            .last()
            .map_or(Duration::ZERO, |(time, _)| *time)
    }

    /// Where the arm would come nearer than the guards allow to itself, or to one of the regions
    /// that a session keeps out of; `None` if nowhere. The guards have the arm stop before that.
    /// `state` says whether a hand is mounted.
    ///
    /// # Errors
    /// [`GoalError::KeepOut`], as for the session.
    pub fn blocked(
        &self,
        model: &Model,
        state: &RobotState,
        keep_out: &[Obstacle],
    ) -> Result<Option<Blocked>, GoalError> {
        let regions = check_keep_out(keep_out)?;
        let clearance = Clearance::new(model, state.m_ee > 0.0, regions);
        let mut ways = self.postures.windows(2);
        Ok(ways.find_map(|ends| {
            let [(_, now), (time, next)] = [ends[0], ends[1]];
            let near = clearance.too_near(&now.into(), &next.into())?;
            Some(Blocked {
                time,
                q: next,
                region: near.region().map(|index| index + 1),
            })
        }))
    }

    /// The joint positions at the end, `[rad]`.
    pub fn end(&self) -> [f64; 7] {
        self.postures.last().map_or([0.0; 7], |(_, q)| *q)
    }
}

/// Where an arm would come too near something.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Blocked {
    /// Since the begin of the motion.
    pub time: Duration,
    /// The joint positions there, `[rad]`.
    pub q: [f64; 7],
    /// The region, from 1; `None` where a link comes near another.
    pub region: Option<usize>,
}
