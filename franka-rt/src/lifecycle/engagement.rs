//! Sessions that last from goal to goal.

use core::time::Duration;

use franka_model::collision::Obstacle;
use franka_proto::RobotState;

use super::goal_progress::{ChunkStream, Goals, Owner};
use super::{Lifecycle, LifecyclePhase, MotionError};
use crate::driver::Observer;
use crate::law::Gains;
use crate::session::check::{check_keep_out, check_silence, check_speed_cap};
use crate::session::{
    Backend, Budget, Chunk, DeadmanMonitor, Deviation, ForceCap, Goal, GoalError, GoalId, Leash,
    OnArrival, Target,
};
use crate::team::Member;

/// Options of a session, which is a motion that continues while goals begin and end.
#[derive(Debug, Default)]
pub struct Engagement {
    /// The deadman timer that the session is bound to: the arm brakes if the timer expires.
    pub deadman: Option<DeadmanMonitor>,
    /// Membership of the session in a team.
    pub team: Option<Member>,
    /// Regions in the base frame that the arm must not enter, at most
    /// [`KEEP_OUT_MAX`](crate::session::KEEP_OUT_MAX). They replace the regions of
    /// [`Lifecycle::keep_out_of`].
    pub keep_out: Option<Vec<Obstacle>>,
    /// Speed limit for every joint, the flange and the end effector, `[m/s]`: see
    /// [`Guard::SpeedCap`](crate::session::Guard::SpeedCap).
    pub speed_cap: Option<f64>,
    /// Back end that turns setpoints into torques: this driver's control law or the robot's own
    /// controller.
    pub backend: Backend,
    /// The observer of the session's cycles.
    pub observer: Option<Observer>,
}

impl Engagement {
    pub(super) fn check(&self, goal: &Goal, state: &RobotState) -> Result<(), GoalError> {
        self.backend.check(goal)?;
        self.backend.check_start(&state.q_d.into())?;
        if let Some(deadman) = &self.deadman {
            check_silence(deadman.silence())?;
        }
        if let Some(regions) = &self.keep_out {
            check_keep_out(regions)?;
        }
        if let Some(cap) = self.speed_cap {
            check_speed_cap(cap)?;
        }
        Ok(())
    }
}

/// Changes to the current goal. They do not change its target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tuning {
    /// New stiffness and damping. The change fades over 0.3 s.
    pub gains: Option<Gains>,
    /// New limits of velocity, acceleration and jerk.
    pub budget: Option<Budget>,
    /// New limit for the force of springs and dampers. It fades over the same time as the gains.
    pub force_cap: Option<ForceCap>,
    /// New limit for how far the reference may be ahead of the arm. It fades over the same time as
    /// the gains.
    pub leash: Option<Leash>,
    /// New limit for how far the arm may be pushed off its path.
    pub deviation: Option<Deviation>,
    /// New joint positions, `[rad]`, toward which the arm moves in the null space of the end
    /// effector's pose: see [`Goal::posture`].
    pub posture: Option<[f64; 7]>,
}

impl Tuning {
    /// Returns these changes. Fields that are `None` are taken from `before`.
    #[must_use]
    pub fn or(self, before: Self) -> Self {
        let Self {
            gains,
            budget,
            force_cap,
            leash,
            deviation,
            posture,
        } = self;
        Self {
            gains: gains.or(before.gains),
            budget: budget.or(before.budget),
            force_cap: force_cap.or(before.force_cap),
            leash: leash.or(before.leash),
            deviation: deviation.or(before.deviation),
            posture: posture.or(before.posture),
        }
    }

    /// Returns the goal with these changes. A goal for hand guiding keeps its gains, because its
    /// free axes must have no springs.
    #[must_use]
    pub fn apply(&self, goal: Goal) -> Goal {
        Goal {
            gains: match goal.target {
                Target::Guide(_) => goal.gains,
                _ => self.gains.unwrap_or(goal.gains),
            },
            budget: self.budget.unwrap_or(goal.budget),
            force_cap: self.force_cap.unwrap_or(goal.force_cap),
            leash: self.leash.unwrap_or(goal.leash),
            deviation: self.deviation.unwrap_or(goal.deviation),
            posture: self.posture.or(goal.posture),
            ..goal
        }
    }
}

impl Lifecycle {
    /// Accepts a goal for the session `engaged`. It supersedes the previous goal.
    pub(super) fn submit_within(
        &mut self,
        engaged: GoalId,
        goal: Goal,
        path: Option<Box<Chunk>>,
        state: &RobotState,
    ) -> Result<(), MotionError> {
        self.check_engaged(engaged)?;
        goal.check(&self.model, state)?;
        let is_ending = self.is_ending();
        if let Some(goals) = self.goals_mut() {
            goals.backend.check(&goal)?;
            if goal.target != Target::Rest {
                goals.check_deadman()?;
            }
            if is_ending {
                goals.after_end.push(goal.id);
                return Ok(());
            }
        }
        self.replace(goal, path, MotionError::Superseded);
        Ok(())
    }

    /// Passes a chunk to the session `engaged`. The chunk's own options define how it replaces the
    /// previous chunk. `goal` replaces the current goal. Until the next goal arrives, `goal`
    /// identifies the chunks and sets their speed and stiffness. The arm rests at the last point.
    ///
    /// # Errors
    /// Returns the errors of [`Self::begin`], and:
    /// - [`MotionError::Held`] if a deadman holds the arm;
    /// - [`MotionError::Held`] or [`MotionError::Braked`], with the reason, if the previous chunk
    ///   was given up. This is reported once;
    /// - [`GoalError::Late`] if all points of the chunk have passed;
    /// - [`GoalError::Ahead`] if the chunk's times are too far in the future, for example because
    ///   they are from a different clock;
    /// - [`GoalError::Outdated`] if the chunk's observation is older than the observation of the
    ///   previous chunk;
    /// - [`GoalError::Chunks`] if more chunks arrive at once than the control thread accepts.
    pub fn chunk(
        &mut self,
        engaged: GoalId,
        goal: Goal,
        chunk: Chunk,
        state: &RobotState,
    ) -> Result<(), MotionError> {
        self.check_engaged(engaged)?;
        let ending = self.is_ending();
        if let Some(goals) = self.goals_mut().filter(|_| !ending) {
            goals.check_deadman()?;
            if let Some(error) = goals.take_chunk_error() {
                return Err(error);
            }
        }
        chunk.check(&self.model, state)?;
        let observed_at = chunk.observation();
        let ahead = observed_at.map_or(0, |time| time.saturating_sub(state.message_id));
        let by = Duration::from_millis(ahead);
        if by > Chunk::OFFSET_MAX {
            return Err(GoalError::Ahead { by }.into());
        }
        // Times that count from the start of the chunk cannot have passed.
        if observed_at.is_some() && chunk.end_after(state.message_id).is_zero() {
            let by = chunk.late_by(state.message_id);
            return Err(GoalError::Late { by }.into());
        }
        let goal = Goal {
            target: Target::Rest,
            on_arrival: OnArrival::Hold,
            ..goal
        };
        goal.check(&self.model, state)?;
        let Some(goals) = self.goals_mut() else {
            return Err(MotionError::Disengaged);
        };
        goals.backend.check(&Goal {
            target: chunk.target(),
            ..goal
        })?;
        if ending {
            // The session has ended. It reports its end when the outcome is known.
            goals.after_end.push(goal.id);
            return Ok(());
        }
        // A cancelled goal brakes to rest, and no caller awaits it any more.
        let (current, cancelled) = (goals.current.id, goals.cancelled);
        let goes_on = match goals.stream {
            ChunkStream::Of { goal, observed_at } if goal == current && !cancelled => {
                Some((goal, observed_at))
            }
            _ => None,
        };
        let (of, before) = goes_on.unwrap_or((goal.id, None));
        if let (Some(before), Some(now)) = (before, observed_at)
            && now < before
        {
            let by = Duration::from_millis(before - now);
            return Err(GoalError::Outdated { by }.into());
        }
        goals.send(of, chunk).map_err(GoalError::from)?;
        goals.stream = ChunkStream::Of {
            goal: of,
            observed_at: observed_at.or(before),
        };
        if goes_on.is_none() {
            self.replace(goal, None, MotionError::Superseded);
        }
        Ok(())
    }

    /// Applies `tuning` to the current goal of the session `engaged`, without a step in torque.
    ///
    /// # Errors
    /// Returns the errors of [`Self::begin`]. After an error, nothing has changed.
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
        let tuned = tuning.apply(goals.current);
        goals.backend.check(&tuned)?;
        tuned.check(&self.model, state)?;
        // Hand guiding does not use these gains, but later goals do, so they must be valid.
        if let Some(gains) = tuning.gains {
            let target = Target::Rest;
            let later = Goal {
                target,
                gains,
                ..tuned
            };
            later.check(&self.model, state)?;
        }
        // This includes a cancelled goal, which is held until the next goal arrives.
        if let Some(goals) = self.goals_mut() {
            goals.current = tuned;
            goals.newest.write(tuned);
        }
        Ok(())
    }

    /// Ends the session `engaged`: brakes, releases the arm, and ends the motion. The session's
    /// goal resolves as [`MotionError::Stopped`], and the session itself as `Ok`. Has no effect if
    /// the session is ending or has ended.
    pub fn disengage(&mut self, engaged: GoalId) {
        if self.check_engaged(engaged).is_ok() {
            self.release(engaged);
        }
    }

    /// Returns what follows the end of a goal. If its session lasts from goal to goal, more goals
    /// follow. A session that was asked to end always ends, even if its last goal is cancelled,
    /// because its owner may already know that it accepts no more goals.
    pub(super) fn end_of(&self, id: GoalId) -> OnArrival {
        let waits = self.next.as_ref().is_some_and(|next| next.id() == id);
        let of_session = |goals: &Goals| goals.owner != Owner::Goal && goals.goes_on();
        if !waits && self.goals().is_some_and(of_session) {
            OnArrival::ReportAndHold
        } else {
            OnArrival::ReportAndFinish
        }
    }

    /// True if robot or thread has ended the current motion, or if the robot was asked to stop it.
    pub(super) fn is_ending(&self) -> bool {
        matches!(&self.phase, LifecyclePhase::UnderWay(current) if current.is_ending())
    }

    pub(super) fn is_engaged(&self) -> bool {
        self.goals().is_some_and(|goals| goals.owner != Owner::Goal)
    }

    /// Ends the session `engaged`. Returns true if that session controls the arm.
    pub(super) fn release(&mut self, engaged: GoalId) -> bool {
        let ending = self.is_ending();
        let Some(goals) = self.goals_mut() else {
            return false;
        };
        if goals.owner.session() != Some(engaged) {
            return false;
        }
        if goals.goes_on() && !ending {
            goals.owner = Owner::Disengaged(engaged);
            let goal = Goal {
                id: engaged,
                watchdog: None,
                revision: goals.current.revision + 1,
                ..goals.current.at_rest(OnArrival::ReportAndFinish)
            };
            self.replace(goal, None, MotionError::Stopped);
        }
        true
    }

    fn check_engaged(&self, engaged: GoalId) -> Result<(), MotionError> {
        let of_session = |goals: &Goals| goals.goes_on() && goals.owner.session() == Some(engaged);
        if self.goals().is_some_and(of_session) {
            return Ok(());
        }
        if let LifecyclePhase::Closed { .. } | LifecyclePhase::Stalled { .. } = self.phase {
            self.check_open()?;
        }
        Err(match &self.ended {
            Some((ended, error)) if *ended == engaged => error.clone(),
            _ => MotionError::Disengaged,
        })
    }
}
