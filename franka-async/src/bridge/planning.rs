//! Paths are planned before they begin. Planning takes up to a hundred milliseconds. Therefore it
//! runs on threads for blocking work, and the bridge serves stops meanwhile. A path begins when its
//! plan is ready, and supersedes older goals only then. If the path is refused, the older goals
//! stay as they were.

use std::panic::resume_unwind;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::RobotState;
use franka_rt::lifecycle::{MotionError, NewMotion, Tuning};
use franka_rt::session::{Chunk, Goal, GoalId, PathError, Waypoint};
use tokio::task::JoinHandle;

use super::Bridge;
use crate::input::{Beginning, Replies};
use crate::world;

/// A motion whose path is being planned.
pub(super) struct Planning {
    motion: Beginning,
    waypoints: Arc<[Waypoint]>,
    replies: Replies,
    /// Joint positions at which the path starts, `[rad]`.
    start: [f64; 7],
    /// Number of plans that may still be made if the arm has left the start in the meantime.
    plans_left: u32,
    task: JoinHandle<Result<Chunk, PathError>>,
    /// Output of the task.
    planned: Option<Result<Chunk, PathError>>,
}

/// If a joint is further than this from the start of a path, `[rad]`, the path is planned anew. If
/// the arm moves, the path begins in motion: a joint at half of its speed moves this far in a
/// hundred milliseconds.
const LEFT_START: f64 = 0.1;

/// Number of plans after the first one. After these, the path is refused because the arm moves too
/// fast.
pub(super) const PLANS: u32 = 4;

/// Largest number of paths that are planned at the same time. A further path supersedes the oldest
/// one.
const PENDING_MAX: usize = 4;

/// Waits for the plan of the newest path. Without pending paths, this waits forever.
///
/// # Cancel safety
/// Dropping the future loses nothing.
pub(super) async fn planned(pending: &mut [Planning]) {
    let Some(newest) = pending.last_mut() else {
        return std::future::pending().await;
    };
    if newest.planned.is_some() {
        return;
    }
    newest.planned = match (&mut newest.task).await {
        Ok(planned) => Some(planned),
        Err(failed) => match failed.try_into_panic() {
            Ok(panic) => resume_unwind(panic),
            // The runtime ends, and this task ends with it.
            Err(_) => std::future::pending().await,
        },
    };
}

impl Planning {
    fn id(&self) -> GoalId {
        self.motion.motion.id()
    }

    fn session(&self) -> Option<GoalId> {
        session_of(&self.motion.motion)
    }
}

fn session_of(motion: &NewMotion) -> Option<GoalId> {
    match motion {
        NewMotion::Goal { session, .. } => *session,
        _ => None,
    }
}

impl Bridge {
    pub(super) fn plan(
        &mut self,
        motion: Beginning,
        waypoints: Arc<[Waypoint]>,
        replies: Replies,
        plans_left: u32,
    ) {
        let NewMotion::Goal { goal, .. } = &motion.motion else {
            unreachable!("only goals have paths");
        };
        let (goal, state) = (**goal, *self.publisher.state());
        let (model, start) = (self.lifecycle.model().clone(), self.start_of_a_path());
        let path = waypoints.clone();
        let plan = move || plan_path(&path, &start, &goal, &model, &state);
        if self.planning.len() == PENDING_MAX {
            let oldest = self.planning[0].id();
            self.take_back_plans(MotionError::Superseded, |plan| plan.id() == oldest);
        }
        self.planning.push(Planning {
            motion,
            waypoints,
            replies,
            start,
            plans_left,
            task: world::spawn_blocking(plan),
            planned: None,
        });
    }

    /// Begins or refuses the newest motion if its path has been planned.
    pub(super) fn on_planned(&mut self) {
        let Some(Planning {
            motion,
            waypoints,
            replies,
            start,
            plans_left,
            task: _,
            planned: Some(planned),
        }) = self.planning.pop_if(|newest| newest.planned.is_some())
        else {
            return;
        };
        let id = motion.motion.id();
        let path = match planned {
            Ok(path) => path,
            Err(error) => return self.refuse(id, replies, error.into()),
        };
        let now = self.start_of_a_path();
        let has_left = start
            .iter()
            .zip(now)
            .any(|(start, now)| (now - start).abs() > LEFT_START);
        match plans_left.checked_sub(1) {
            _ if !has_left => self.take_up(motion, Some(path), replies),
            Some(plans_left) => self.plan(motion, waypoints, replies, plans_left),
            None => self.refuse(id, replies, MotionError::Busy),
        }
    }

    /// Returns the joint positions from which a path would start now, `[rad]`.
    fn start_of_a_path(&self) -> [f64; 7] {
        let reference = self.course.reference().map(|reference| reference.q);
        reference.unwrap_or_else(|| self.publisher.state().q)
    }

    /// Checks that `motion` may supersede pending paths, by the same rules as for a running path.
    pub(super) fn check_turn_of_plan(&self, motion: &NewMotion) -> Result<(), MotionError> {
        let supersedes = matches!(motion, NewMotion::Goal { ticket: None, .. });
        match self.planning.is_empty() || supersedes {
            true => Ok(()),
            false => Err(MotionError::Busy),
        }
    }

    /// Supersedes the pending paths of this session, or the pending paths outside of a session,
    /// because a newer goal was accepted.
    pub(super) fn supersede_plans(&mut self, session: Option<GoalId>) {
        self.take_back_plans(MotionError::Superseded, |plan| plan.session() == session);
    }

    /// Cancels the path of this goal. Returns true if there is one.
    pub(super) fn cancel_plan(&mut self, goal: GoalId) -> bool {
        self.take_back_plans(MotionError::Stopped, |plan| plan.id() == goal)
    }

    pub(super) fn end_plans_of(&mut self, session: GoalId) {
        self.take_back_plans(MotionError::Stopped, |plan| plan.session() == Some(session));
    }

    pub(super) fn drop_plans(&mut self, reason: MotionError) {
        self.take_back_plans(reason, |_| true);
    }

    fn take_back_plans(&mut self, reason: MotionError, of: impl Fn(&Planning) -> bool) -> bool {
        let taken: Vec<_> = self.planning.extract_if(.., |plan| of(plan)).collect();
        let any = !taken.is_empty();
        for planning in taken {
            // The thread may continue to compute, but its result is dropped.
            planning.task.abort();
            self.refuse(planning.id(), planning.replies, reason.clone());
        }
        any
    }

    /// Pauses or resumes the path of this goal. A paused path begins paused.
    pub(super) fn pause_plan(&mut self, id: GoalId, paused: bool) {
        for planning in &mut self.planning {
            if let NewMotion::Goal { goal, .. } = &mut planning.motion.motion
                && goal.id == id
            {
                goal.paused = paused;
            }
        }
    }

    /// Changes the tuning of the paths of a session. Plans them anew if the limits or the posture
    /// change.
    pub(super) fn tune_plans(&mut self, session: GoalId, tuning: &Tuning) {
        let is_planned_anew = tuning.budget.is_some() || tuning.posture.is_some();
        for mut planning in std::mem::take(&mut self.planning) {
            if planning.session() != Some(session) {
                self.planning.push(planning);
                continue;
            }
            if let NewMotion::Goal { goal, .. } = &mut planning.motion.motion {
                **goal = tuning.apply(**goal);
            }
            if !is_planned_anew {
                self.planning.push(planning);
                continue;
            }
            planning.task.abort();
            let Planning {
                motion,
                waypoints,
                replies,
                plans_left,
                ..
            } = planning;
            self.plan(motion, waypoints, replies, plans_left);
        }
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "on a thread for work that blocks"
)]
fn plan_path(
    waypoints: &[Waypoint],
    start: &[f64; 7],
    goal: &Goal,
    model: &Model,
    state: &RobotState,
) -> Result<Chunk, PathError> {
    tracing::debug!(waypoints = waypoints.len(), "planning a path");
    Chunk::through(waypoints, start, goal, model, state)
}
