//! Replays of recorded motions: [`Arm::replay`], [`Robot::replay`].
//!
//! ```text
//! Recording::open --cycles--> Samples --ReplayPlan::new--> plan --Arm::replay--> ReplayReport
//! ```
//!
//! [`ReplayPlan`] decides, before anything moves, which targets are followed and which are refused.

use std::time::Duration;

use franka_rt::lifecycle::{MotionError, Outcome};
use franka_rt::session::{Budget, Goal, GoalId, Target};

use franka_record::replay::{ReplayCourse, ReplayDeviation};
pub use franka_record::replay::{
    ReplayError, ReplayOptions, ReplayPlan, ReplaySource, ReplayTargets, Spread,
};

use crate::arm::{Arm, Engage};
use crate::robot::Robot;

/// Report of a replay.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReplayReport {
    /// Time from the first target to the last.
    pub duration: Duration,
    /// Distance of the joints from their recorded positions, `[rad]`: in each state, of the joint
    /// that is furthest off.
    pub joints: Spread,
    /// Distance of the end effector from its recorded position in each state, `[m]`.
    pub position: Spread,
    /// Number of states that were compared.
    pub states: usize,
}

/// Reason why a replay has no report. The arm brakes and is then held, unless the session has
/// ended.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayFailure {
    /// This arm cannot replay the recorded motion. Nothing has moved.
    #[error(transparent)]
    Refused(#[from] ReplayError),
    /// The motion to the first target, or the session, ended early.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The arm did not move as in the recording, because something holds it or a guard has braked
    /// it.
    #[error("{distance}, {after:.3?} after the start of the replay; expected {most} at most")]
    Off {
        /// Time since the start of the replay.
        after: Duration,
        /// Measured distance.
        distance: String,
        /// Largest distance that is accepted.
        most: String,
    },
}

impl Robot {
    /// Moves to the first target of a recorded motion, replays the motion, and releases the arm. It
    /// begins a session with the defaults and calls [`Arm::replay`].
    ///
    /// ```no_run
    /// # async fn run(
    /// #     robot: franka_async::Robot,
    /// #     plan: franka_async::replay::ReplayPlan,
    /// # ) -> Result<(), franka_async::replay::ReplayFailure> {
    /// let report = robot.replay(&plan).await?;
    /// println!("{:.1} mm off at most", report.position.max * 1e3);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Returns the errors of [`Arm::replay`], and [`ReplayFailure::Motion`] if the session does not
    /// begin or ends with an error.
    ///
    /// # Cancel safety
    /// Dropping the future brakes the arm and ends the session, in the background.
    pub async fn replay(&self, plan: &ReplayPlan) -> Result<ReplayReport, ReplayFailure> {
        plan.check(self.model(), &self.state())?;
        let arm = self.engage(Engage::default()).await?;
        let report = arm.replay(plan).await?;
        arm.disengage().await?;
        Ok(report)
    }
}

impl Arm {
    /// Moves to the first target of a recorded motion, as [`Arm::move_joints`] does, but with its
    /// speed multiplied by the [speed of the plan](ReplayPlan::speed). Then the arm follows the
    /// targets at their times, with all guards of the session and the limits of the
    /// [plan](ReplayPlan::budget). Resolves when the arm rests at the last target. The report
    /// contains the distances from the recorded positions.
    ///
    /// If a joint is further than [`ReplayPlan::JOINTS_OFF_MAX`] from its recorded position, the
    /// replay ends as [`ReplayFailure::Off`]. A replay by poses checks the end effector instead,
    /// with [`ReplayPlan::POSITION_OFF_MAX`]. Any other goal of the session ends the replay as
    /// [`MotionError::Superseded`]; [`Robot::stop`] ends it with the same error or as
    /// [`MotionError::Stopped`].
    ///
    /// # Errors
    /// Returns [`ReplayFailure::Refused`] if the arm cannot replay the motion; nothing has moved
    /// then. If the arm has moved, returns one of the errors above, the error of the motion to the
    /// first target, or the error of the session.
    ///
    /// # Cancel safety
    /// Dropping the future brakes the arm, and the session holds it.
    pub async fn replay(&self, plan: &ReplayPlan) -> Result<ReplayReport, ReplayFailure> {
        let robot = self.robot();
        let model = robot.model();
        plan.check(model, &robot.state())?;
        self.move_joints(plan.start()).speed(plan.speed()).await?;
        let mut states = robot.state_stream();
        let mut course = ReplayCourse::new(robot.state().message_id);
        let mut braking = BrakeOnDrop::new(self);
        let mut deviation = ReplayDeviation::default();
        let mut newest = robot.state().message_id;
        while newest < course.end(plan) {
            if let Some(chunk) = course.due(plan, model, newest)? {
                let goal = self.goal_within(chunk.target(), plan.budget());
                // Note the goal before sending it. Otherwise, if the future is dropped in between,
                // the arm would follow the chunk to its end.
                braking.goal.get_or_insert(goal.id);
                if let Err(error) = self.send_chunk(goal, chunk).await {
                    return Err(self.over(error).into());
                }
                braking.is_taken = true;
            }
            let reading = tokio::select! {
                biased;
                ended = self.ended() => return Err(over(ended).into()),
                reading = states.next() => match reading {
                    Some(reading) => reading,
                    // The connection has ended, and the session with it.
                    None => return Err(over(self.ended().await).into()),
                },
            };
            if self.heading() != braking.goal {
                return Err(self.over(MotionError::Superseded).into());
            }
            newest = reading.state.message_id;
            if let Some(since) = newest.checked_sub(course.begin()) {
                let distance = deviation.note(plan, model, since, &reading.state);
                if let Some((distance, most)) = plan.too_far(distance) {
                    let after = Duration::from_millis(since);
                    return Err(ReplayFailure::Off {
                        after,
                        distance,
                        most,
                    });
                }
            }
        }
        self.at_rest().await?;
        braking.goal = None;
        Ok(ReplayReport {
            duration: plan.duration(),
            joints: deviation.joints(),
            position: deviation.position(),
            states: deviation.len(),
        })
    }

    /// Returns the reason why a replay ended: the end of the session if it has ended, otherwise
    /// `error`. A session refuses goals only when it is about to end.
    fn over(&self, error: MotionError) -> MotionError {
        match (self.session_error(), error) {
            (Some(ended), _) => ended,
            (None, MotionError::Disengaged) => MotionError::Stopped,
            (None, error) => error,
        }
    }

    /// Returns a goal with its own limits in place of the session's limits.
    fn goal_within(&self, target: Target, budget: Budget) -> Goal {
        Goal {
            budget,
            ..self.goal(target)
        }
    }
}

fn over(outcome: Outcome) -> MotionError {
    outcome.err().unwrap_or(MotionError::Disengaged)
}

/// Brakes a replay that did not finish; the session then holds the arm.
struct BrakeOnDrop<'a> {
    arm: &'a Arm,
    /// Goal of the chunks; `None` before the first chunk, and when nothing is left to brake.
    goal: Option<GoalId>,
    /// True if the session is known to have accepted the first chunk.
    is_taken: bool,
}

impl<'a> BrakeOnDrop<'a> {
    fn new(arm: &'a Arm) -> Self {
        Self {
            arm,
            goal: None,
            is_taken: false,
        }
    }
}

impl Drop for BrakeOnDrop<'_> {
    fn drop(&mut self) {
        // Once the session had this goal, another goal means that the other one has taken over.
        let goes_on = !self.is_taken || self.goal == self.arm.heading();
        if self.goal.is_some()
            && goes_on
            && let Err(error) = self.arm.try_set(Target::Rest)
        {
            tracing::debug!(%error, "cannot stop the replay: its session has ended");
        }
    }
}
