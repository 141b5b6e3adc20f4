//! Goals of target control: they are changed, superseded and cancelled here. If a goal is
//! cancelled, or its future is dropped, the arm brakes. `cancel` and `stop` also work for programs
//! and sessions.

use core::time::Duration;

use franka_proto::RobotState;

use super::current_motion::Work;
use super::goal_progress::Goals;
use super::{Lifecycle, LifecyclePhase, MotionError, NewMotion};
use crate::session::{Backend, Chunk, Goal, GoalError, GoalId, OnArrival, Target};

impl Lifecycle {
    /// Moves the target of a goal that follows a stream. Returns true if the arm still follows the
    /// goal. Returns false if the goal was cancelled, even if targets are still queued for it. Also
    /// returns false if the arm brakes because of a stop, or because the session ends.
    ///
    /// # Errors
    /// Returns a [`GoalError`] if the target is not accepted; the previous target then stays.
    pub fn update(
        &mut self,
        id: GoalId,
        target: Target,
        state: &RobotState,
    ) -> Result<bool, GoalError> {
        let brakes = |goal: &Goal| {
            goal.target == Target::Rest && goal.on_arrival == OnArrival::ReportAndFinish
        };
        if self.newest().is_some_and(brakes) {
            return Ok(false);
        }
        let along_path = false;
        let change = |goal: &Goal| Goal {
            target,
            along_path,
            ..*goal
        };
        self.amend(id, change, Some(state))
    }

    /// Marks a goal that receives targets as complete. The arm settles at the newest target. The
    /// motion then finishes, unless its session continues without a goal. Has no effect on a path,
    /// which ends at its last point anyway.
    pub fn close(&mut self, id: GoalId) {
        let current = self.goals().map(|goals| &goals.current);
        if current.is_some_and(|goal| goal.id == id && goal.along_path) {
            return;
        }
        let on_arrival = self.end_of(id);
        let end = |goal: &Goal| Goal {
            target: match goal.target {
                Target::Guide(_) => Target::Rest, // Guiding has no target to hold.
                target => target.place(),
            },
            paused: false,
            on_arrival,
            ..*goal
        };
        let amended = self.amend(id, end, None);
        debug_assert!(amended.is_ok(), "only targets are checked");
    }

    /// Pauses the motion to a goal within the goal's budget, or resumes it. Has no effect if a
    /// newer goal exists. Has no effect on chunks either, because their points have fixed times.
    pub fn pause(&mut self, id: GoalId, paused: bool) {
        let goal = match &mut self.next {
            Some(NewMotion::Goal { goal, .. }) if goal.id == id => &mut **goal,
            _ => match self.goals_mut() {
                Some(goals) if goals.current.id == id && !goals.cancelled => {
                    goals.current.paused = paused;
                    goals.newest.write(goals.current);
                    return;
                }
                _ => return,
            },
        };
        goal.paused = paused;
    }

    /// Cancels a goal. If the arm moves to the goal, it brakes as for a stop, and the goal resolves
    /// as [`MotionError::Stopped`]. If `id` names a user's program instead of a goal, the robot is
    /// stopped. Has no effect if a newer goal exists.
    pub fn cancel(&mut self, id: GoalId, now: Duration) {
        if self.next.take_if(|next| next.id() == id).is_some() {
            return self.resolve(id, Err(MotionError::Stopped));
        }
        if self.cancel_program(id, now) || self.release(id) {
            return;
        }
        let on_arrival = self.end_of(id);
        let amended = self.amend(id, |goal| goal.at_rest(on_arrival), None);
        debug_assert!(amended.is_ok(), "only targets are checked");
        if let Some(goals) = self.goals_mut()
            && goals.current.id == id
        {
            goals.cancelled = true;
        }
    }

    /// Returns the target that the arm moves to under target control, and the id of its goal. This
    /// is the last accepted target, even if the thread has not read it yet. Returns `None` if
    /// target control moves nothing.
    pub fn heading(&self) -> Option<(GoalId, Target)> {
        let goal = self.newest()?;
        Some((goal.id, goal.hand_target()))
    }

    /// Returns the last accepted goal.
    fn newest(&self) -> Option<&Goal> {
        match &self.next {
            Some(NewMotion::Goal { goal, .. }) => Some(goal),
            _ => self.goals().map(|goals| &goals.current),
        }
    }

    /// Returns the goals of the current motion, if target control runs it.
    pub(super) fn goals(&self) -> Option<&Goals> {
        match &self.phase {
            LifecyclePhase::UnderWay(current) => match &current.work {
                Work::Goals(goals) => Some(goals),
                Work::Program(_) => None,
            },
            _ => None,
        }
    }

    pub(super) fn goals_mut(&mut self) -> Option<&mut Goals> {
        match &mut self.phase {
            LifecyclePhase::UnderWay(current) => match &mut current.work {
                Work::Goals(goals) => Some(goals),
                Work::Program(_) => None,
            },
            _ => None,
        }
    }

    /// Replaces all other goals by `goal`; they resolve with `reason`. If the current motion
    /// accepts goals, `goal` becomes a part of it. Otherwise `goal` becomes a motion that waits for
    /// the end of the current one.
    pub(super) fn replace(&mut self, goal: Goal, path: Option<Box<Chunk>>, reason: MotionError) {
        let is_ending = self.is_ending();
        let previous = match self.goals_mut() {
            Some(goals) if !is_ending => {
                if let Some(path) = path {
                    // The ring had room when the path was accepted.
                    let _ = goals.send(goal.id, *path);
                }
                goals.supersede(goal, reason.clone())
            }
            _ => {
                let motion = NewMotion::Goal {
                    goal: Box::new(goal),
                    path,
                    ticket: None,
                    session: None,
                };
                return self.wait(motion, reason);
            }
        };
        self.resolve_next(reason);
        if let Some((previous, result)) = previous {
            self.resolve(previous, result);
        }
    }

    /// Changes a goal that has not been superseded. Returns true if such a goal exists.
    pub(super) fn amend(
        &mut self,
        id: GoalId,
        change: impl FnOnce(&Goal) -> Goal,
        state: Option<&RobotState>,
    ) -> Result<bool, GoalError> {
        let model = self.model.clone();
        let (goal, newest, backend) = match &mut self.next {
            Some(NewMotion::Goal { goal, .. }) if goal.id == id => {
                (&mut **goal, None, Backend::Torques)
            }
            _ => match self.goals_mut() {
                Some(goals) if goals.current.id == id && !goals.cancelled => {
                    (&mut goals.current, Some(&mut goals.newest), goals.backend)
                }
                _ => return Ok(false),
            },
        };
        let amended = Goal {
            revision: goal.revision + 1,
            ..change(goal)
        };
        if let Some(state) = state {
            amended.check(&model, state)?;
            backend.check(&amended)?;
        }
        *goal = amended;
        if let Some(newest) = newest {
            newest.write(amended);
        }
        Ok(true)
    }
}
