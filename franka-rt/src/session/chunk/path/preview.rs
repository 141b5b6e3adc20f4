//! Preview of the motion along a path.

use core::time::Duration;

use franka_model::collision::Obstacle;
use franka_model::{JointVector, Model};
use franka_proto::RobotState;

use super::{PathError, Waypoint};
use crate::session::check::check_keep_out;
use crate::session::guard::clearance::Clearance;
use crate::session::{Chunk, Goal, GoalError};

/// Predicted motion of an arm along a path: its joint positions at a sequence of times. Between two
/// entries, no joint moves by more than a few hundredths of a radian. On a path of poses, the end
/// effector moves by at most 5 mm between two entries.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Preview {
    /// Times from the start of the motion, in increasing order, and joint positions, `[rad]`. The
    /// first entry is the start, and the last entry is the end of the path.
    pub postures: Vec<(Duration, [f64; 7])>,
}

impl Preview {
    /// Predicts the motion of an arm from the joint positions `q`, `[rad]`. The call takes as long
    /// as [`Chunk::through`], and refuses the same paths.
    ///
    /// # Errors
    /// Returns the same [`PathError`] as [`Chunk::through`].
    pub fn of(
        waypoints: &[Waypoint],
        q: &[f64; 7],
        goal: &Goal,
        model: &Model,
        state: &RobotState,
    ) -> Result<Self, PathError> {
        let mut postures = vec![(Duration::ZERO, *q)];
        Chunk::planned(waypoints, q, goal, model, state, |time, q: &JointVector| {
            // An empty motion has one place, at the start time.
            let time = Duration::try_from_secs_f64(time).unwrap_or_default();
            if postures.last().is_some_and(|(before, _)| time > *before) {
                postures.push((time, (*q).into()));
            }
        })?;
        Ok(Self { postures })
    }

    /// Returns the time until the reference is at the end, if nothing delays it. Guards that hold
    /// the reference back delay it, and so do poses that demand more than a joint's limits. The arm
    /// settles after that time.
    pub fn duration(&self) -> Duration {
        self.postures
            .last()
            .map_or(Duration::ZERO, |(time, _)| *time)
    }

    /// Returns the first place where the arm would come nearer to itself, or to a keep-out region
    /// of a session, than the guards allow. Returns `None` if there is no such place. The guards
    /// stop the arm before that place. `state` shows if a hand is mounted.
    ///
    /// # Errors
    /// Returns [`GoalError::KeepOut`] if the session would refuse the regions.
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

    /// Returns the joint positions at the end of the path, `[rad]`.
    pub fn end(&self) -> [f64; 7] {
        self.postures.last().map_or([0.0; 7], |(_, q)| *q)
    }
}

/// Place where an arm would come too near to itself or to a keep-out region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Blocked {
    /// Time from the start of the motion to this place.
    pub time: Duration,
    /// Joint positions at this place, `[rad]`.
    pub q: [f64; 7],
    /// Number of the keep-out region, from 1; `None` if a link comes near another link.
    pub region: Option<usize>,
}
