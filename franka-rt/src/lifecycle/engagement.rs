//! A session that goes on from goal to goal.

use core::time::Duration;

use franka_model::collision::Obstacle;
use franka_proto::RobotState;

use super::active::Waiting;
use super::{Lifecycle, MotionError, Phase};
use crate::driver::Observer;
use crate::law::Gains;
use crate::session::check::{check_keep_out, check_silence};
use crate::session::{
    Backend, Budget, Chunk, DeadmanMonitor, ForceCap, Goal, GoalError, GoalId, OnArrival, Target,
    TooManyChunks,
};

/// What a session that goes from goal to goal has beside its goals.
#[derive(Debug, Default)]
pub struct Engagement {
    /// The deadman that it is bound to.
    pub deadman: Option<DeadmanMonitor>,
    /// What the arm keeps out of, in the place of the regions of [`Lifecycle::keep_out_of`]; up to
    /// [`KEEP_OUT_MAX`](crate::session::KEEP_OUT_MAX), base frame.
    pub keep_out: Option<Vec<Obstacle>>,
    /// What turns setpoints into torques.
    pub backend: Backend,
    /// The observer of its cycles.
    pub observer: Option<Observer>,
}

/// Changes to the goal under way, and nothing to where it goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tuning {
    /// How stiff; the gains fade over 0.3 s.
    pub gains: Option<Gains>,
    /// How fast.
    pub budget: Option<Budget>,
    /// With how much force springs and dampers may press. It fades as the gains do.
    pub force_cap: Option<ForceCap>,
}

impl Tuning {
    /// The goal with these changes. One that guides keeps its gains: the axes that are free are
    /// free of springs.
    #[must_use]
    pub fn apply(&self, goal: Goal) -> Goal {
        Goal {
            gains: match goal.target {
                Target::Guide(_) => goal.gains,
                _ => self.gains.unwrap_or(goal.gains),
            },
            budget: self.budget.unwrap_or(goal.budget),
            force_cap: self.force_cap.unwrap_or(goal.force_cap),
            ..goal
        }
    }
}

impl Lifecycle {
    /// Starts a session that holds the arm where it is and then goes from goal to goal, with the
    /// gains and the budget of `goal`, whose `id` becomes the name of the session. It resolves when
    /// the session has ended. While a motion comes to its end that is no longer wanted, the
    /// session waits for that.
    ///
    /// # Errors
    /// [`MotionError::Goal`] for gains, a budget, regions or a posture that are not accepted,
    /// [`MotionError::Busy`] while anything controls the arm or waits for it,
    /// [`MotionError::ConnectionClosed`] after the connection was lost. Nothing is resolved then.
    pub fn engage(
        &mut self,
        goal: Goal,
        engagement: Engagement,
        state: &RobotState,
        now: Duration,
    ) -> Result<(), MotionError> {
        self.check_open()?;
        let is_free = match &self.phase {
            Phase::Active(active) => active.is_letting_go(),
            Phase::Idle | Phase::Closed(_) => true,
        };
        if !is_free || self.next.is_some() {
            return Err(MotionError::Busy);
        }
        let goal = Goal {
            target: Target::Rest,
            on_arrival: OnArrival::Hold,
            watchdog: None,
            ..goal
        };
        goal.check(&self.model, state)?;
        engagement.backend.check(&goal)?;
        engagement.backend.check_start(&state.q_d.into())?;
        if let Some(deadman) = &engagement.deadman {
            check_silence(deadman.silence())?;
        }
        if let Some(regions) = &engagement.keep_out {
            check_keep_out(regions)?;
        }
        let waiting = Waiting::new(goal);
        if self.is_idle() {
            self.start_goal(waiting, None, Some(engagement), now);
        } else {
            self.wait(waiting, Some(engagement), MotionError::Superseded);
        }
        Ok(())
    }

    /// Takes a goal for the session `engaged`. It supersedes the goal before it.
    ///
    /// # Errors
    /// [`MotionError::Goal`] for a goal that is not accepted; what ended the session, if that was
    /// not its owner's wish, and [`MotionError::Disengaged`] otherwise. Nothing is resolved in any
    /// of these cases, and a goal under way goes on.
    pub fn submit_within(
        &mut self,
        engaged: GoalId,
        goal: Goal,
        state: &RobotState,
        now: Duration,
    ) -> Result<(), MotionError> {
        self.check_engaged(engaged)?;
        goal.check(&self.model, state)?;
        if let Some(goals) = self.goals() {
            goals.backend.check(&goal)?;
        }
        if self.is_ending() {
            if let Some(goals) = self.goals() {
                goals.late.push(goal.id);
            }
            return Ok(());
        }
        let waiting = Waiting::new(goal);
        self.replace(waiting, MotionError::Superseded, now);
        Ok(())
    }

    /// Hands a chunk to the session `engaged`. It takes the place of the chunk before it, as it
    /// says itself; any other goal is superseded by `goal`, which names the chunks until another
    /// goal comes, and says how fast and how stiff. The arm rests at the last point.
    ///
    /// # Errors
    /// As [`Self::submit_within`]; [`GoalError::Late`] for a chunk whose points have all passed,
    /// [`GoalError::Chunks`] if too many are under way.
    pub fn chunk(
        &mut self,
        engaged: GoalId,
        goal: Goal,
        chunk: Chunk,
        state: &RobotState,
        now: Duration,
    ) -> Result<(), MotionError> {
        self.check_engaged(engaged)?;
        chunk.check(&self.model, state)?;
        if chunk.end_after(state.message_id).is_zero() {
            let by = chunk.late_by(state.message_id);
            return Err(GoalError::Late { by }.into());
        }
        let goal = Goal {
            target: Target::Rest,
            on_arrival: OnArrival::Hold,
            ..goal
        };
        goal.check(&self.model, state)?;
        let ending = self.is_ending();
        let Some(goals) = self.goals() else {
            return Err(MotionError::Disengaged);
        };
        goals.backend.check(&Goal {
            target: chunk.target(),
            ..goal
        })?;
        let Some(chunks) = goals.chunks.as_mut().filter(|_| !ending) else {
            // The session has ended, and says so when it is known how.
            goals.late.push(goal.id);
            return Ok(());
        };
        while let Some(done) = chunks.collect() {
            drop(done);
        }
        // One that was taken back is on its way to rest, and belongs to no caller any more.
        let goes_on = goals.current.goal.id == goals.chunk_goal && !goals.current.cancelled;
        let of = if goes_on { goals.chunk_goal } else { goal.id };
        chunks
            .send(of, chunk)
            .map_err(|_| GoalError::from(TooManyChunks))?;
        goals.chunk_goal = of;
        if !goes_on {
            let waiting = Waiting::new(goal);
            self.replace(waiting, MotionError::Superseded, now);
        }
        Ok(())
    }

    /// Changes how the session `engaged` goes about the goal that it has, without a step in torque.
    ///
    /// # Errors
    /// As [`Self::submit_within`]; everything stays as it was then.
    pub fn tune(
        &mut self,
        engaged: GoalId,
        tuning: Tuning,
        state: &RobotState,
    ) -> Result<(), MotionError> {
        self.check_engaged(engaged)?;
        let Some(goals) = self.goals() else {
            return Err(MotionError::Disengaged);
        };
        let tuned = tuning.apply(goals.current.goal);
        goals.backend.check(&tuned)?;
        tuned.check(&self.model, state)?;
        // Gains that a guiding hand has no use for have to be fit for the goals after it.
        if let Some(gains) = tuning.gains {
            let target = Target::Rest;
            let later = Goal {
                target,
                gains,
                ..tuned
            };
            later.check(&self.model, state)?;
        }
        // Also a goal that was taken back: it is held until the next one comes.
        if let Some(goals) = self.goals() {
            goals.current.goal = tuned;
            goals.slot.write(&tuned);
        }
        Ok(())
    }

    /// Ends the session `engaged` as asked: brakes, lets the arm go, ends the motion. Its goal
    /// resolves as [`MotionError::Stopped`], the session itself well. Without effect on one that is
    /// ending or has ended.
    pub fn disengage(&mut self, engaged: GoalId, now: Duration) {
        if self.check_engaged(engaged).is_ok() {
            self.release(engaged, now);
        }
    }

    /// What follows the end of a goal: more goals, if it is one of a session that goes from goal to
    /// goal. A session that is to end ends, also if the goal that ends it is taken back: its owner
    /// may have been told that it takes no more goals.
    pub(super) fn end_of(&mut self, id: GoalId) -> OnArrival {
        let goes_on = match &self.next {
            Some(next) if next.waiting.goal.id == id => next.engagement.is_some(),
            _ => self.is_engaged_for_more(),
        };
        if goes_on {
            OnArrival::ReportAndHold
        } else {
            OnArrival::ReportAndFinish
        }
    }

    /// Whether the motion under way has ended on one side.
    fn is_ending(&self) -> bool {
        matches!(&self.phase, Phase::Active(active) if active.is_ending())
    }

    /// Whether a session that goes from goal to goal has the arm.
    pub(super) fn is_engaged(&mut self) -> bool {
        self.goals().is_some_and(|goals| goals.engaged.is_some())
    }

    /// Whether a session has the arm that takes more goals.
    pub(super) fn is_engaged_for_more(&mut self) -> bool {
        self.goals()
            .is_some_and(|goals| goals.engaged.is_some() && goals.goes_on())
    }

    /// Ends the session of that name. Returns whether it has the arm.
    pub(super) fn release(&mut self, engaged: GoalId, now: Duration) -> bool {
        let ending = self.is_ending();
        let Some(goals) = self.goals() else {
            return false;
        };
        let goes_on = goals.goes_on() && !ending;
        let Some(session) = goals
            .engaged
            .as_mut()
            .filter(|session| session.id == engaged)
        else {
            return false;
        };
        if goes_on {
            session.disengaged = true;
            let goal = Goal {
                id: engaged,
                watchdog: None,
                revision: goals.current.goal.revision + 1,
                ..goals.current.goal.at_rest(OnArrival::ReportAndFinish)
            };
            let waiting = Waiting::new(goal);
            self.replace(waiting, MotionError::Stopped, now);
        }
        true
    }

    fn check_engaged(&mut self, engaged: GoalId) -> Result<(), MotionError> {
        self.check_open()?;
        match self.goals() {
            Some(goals)
                if goals.goes_on()
                    && goals.engaged.is_some_and(|session| session.id == engaged) =>
            {
                Ok(())
            }
            _ => Err(match &self.ended {
                Some((ended, error)) if *ended == engaged => error.clone(),
                _ => MotionError::Disengaged,
            }),
        }
    }
}
