//! Following a stream of targets.

use std::fmt;
use std::future::{Future, IntoFuture};
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use franka_model::limits::JointLimits;
use franka_rt::law::Gains;
use franka_rt::lifecycle::{MotionError, MotionReport, Tuning};
use franka_rt::session::{
    Budget, ForceCap, Goal, GoalError, Lead, OnArrival, OnTimeout, Target, Tolerance, Watchdog,
};
use franka_rt::together::StartTicket;
use tokio::sync::{oneshot, watch};
use tokio_stream::wrappers::WatchStream;
use tokio_stream::{Stream, StreamExt};

use crate::input::Input;
use crate::motion::{Moving, Work};
use crate::{Arm, Robot};

type Targets = Pin<Box<dyn Stream<Item = Target> + Send>>;

/// A motion that follows the newest of a stream of targets; see [`Robot::follow`] and
/// [`Arm::follow`]. Nothing moves before it is awaited.
#[must_use = "a motion does nothing until it is awaited"]
pub struct Follow {
    robot: Robot,
    arm: Option<Arm>,
    /// But for its target, of whose kind the defaults are that are not tuned.
    goal: Goal,
    tuning: Tuning,
    stiffness: Option<[f64; 6]>,
    /// Why its speed is not accepted.
    refused: Option<GoalError>,
    targets: Targets,
    ticket: Option<StartTicket>,
}

impl Follow {
    pub(crate) fn new(robot: Robot, arm: Option<Arm>, targets: Targets) -> Self {
        let tuning = arm.as_ref().map(|arm| *arm.tuning()).unwrap_or_default();
        let limits = robot.model().joint_limits();
        let goal = Goal::new(robot.next_goal(), Target::Rest, OnArrival::Hold, limits);
        Self {
            goal: tuning.apply(goal),
            tuning,
            stiffness: None,
            refused: None,
            robot,
            arm,
            targets,
            ticket: None,
        }
    }

    pub(crate) fn watch<T: Into<Target> + Clone + Send + Sync + 'static>(
        robot: Robot,
        arm: Option<Arm>,
        targets: watch::Receiver<T>,
    ) -> Self {
        let targets = WatchStream::new(targets).map(Into::into).fuse();
        Self::new(robot, arm, Box::pin(targets))
    }

    /// See [`Motion::speed`](crate::Motion::speed).
    pub fn speed(mut self, factor: f64) -> Self {
        match self.goal.budget.at_speed(factor, self.robot.model()) {
            Ok(budget) => self.goal.budget = budget,
            Err(error) => self.refused = Some(error),
        }
        self
    }

    /// See [`Motion::limits`](crate::Motion::limits).
    pub fn limits(mut self, budget: Budget) -> Self {
        self.goal.budget = budget;
        self.refused = None;
        self
    }

    /// See [`Motion::stiffness`](crate::Motion::stiffness).
    pub fn stiffness(mut self, stiffness: [f64; 6]) -> Self {
        self.stiffness = Some(stiffness);
        self
    }

    /// See [`Motion::gains`](crate::Motion::gains). Without it, the kind of the first target
    /// decides.
    pub fn gains(mut self, gains: Gains) -> Self {
        self.tuning.gains = Some(gains);
        self.stiffness = None;
        self
    }

    /// See [`Motion::force_cap`](crate::Motion::force_cap).
    pub fn force_cap(mut self, newtons: f64) -> Self {
        self.tuning.force_cap = Some(ForceCap::Newtons(newtons));
        self
    }

    /// See [`Motion::without_force_cap`](crate::Motion::without_force_cap).
    pub fn without_force_cap(mut self) -> Self {
        self.tuning.force_cap = Some(ForceCap::Off);
        self
    }

    /// Bounds how far ahead of the arm a target may be, metres and radians above zero; by default
    /// nothing does. One that is further ahead is drawn nearer, in every cycle anew while targets
    /// come, so a wild one cannot send the arm far once the stream stops.
    pub fn lead(mut self, lead: Lead) -> Self {
        self.goal.lead = Some(lead);
        self
    }

    /// How near to the last target counts as arrived.
    pub fn tolerance(mut self, tolerance: Tolerance) -> Self {
        self.goal.tolerance = tolerance;
        self
    }

    /// Gives up when no target has come for `silence`, whole milliseconds from 10 on: the arm goes
    /// on to the last one ([`OnTimeout::Hold`]) or brakes at once ([`OnTimeout::Brake`]), and the future
    /// resolves as [`MotionError::Held`] or [`MotionError::Braked`] when it rests, unless targets
    /// come again before that. A target counts even if it equals the one before. The control thread
    /// watches this by itself. Without it, the last target is held for ever.
    pub fn watchdog(mut self, silence: Duration, on_timeout: OnTimeout) -> Self {
        self.goal.watchdog = Some(Watchdog {
            silence,
            on_timeout,
        });
        self
    }

    /// See [`Motion::start_with`](crate::Motion::start_with). Targets that come before the start
    /// replace the first one.
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Some(ticket);
        self
    }

    async fn run(self) -> Result<MotionReport, MotionError> {
        let Self {
            robot,
            arm,
            goal,
            tuning,
            stiffness,
            refused,
            mut targets,
            ticket,
        } = self;
        if let Some(error) = refused {
            return Err(error.into());
        }
        let first = tokio::select! {
            biased;
            ended = end_of(arm.as_ref()) => return Err(ended),
            first = newest(&mut targets) => first,
        };
        let Some(first) = first else {
            // Nothing to follow: the arm goes on with what it does.
            return Err(MotionError::Stopped);
        };
        let goal = towards(
            first,
            &goal,
            &tuning,
            stiffness,
            robot.model().joint_limits(),
        );
        let work = Work::goal(goal, ticket, arm.as_ref());
        let mut moving = Moving::new(robot.clone(), arm, work);
        loop {
            let next = tokio::select! {
                biased;
                outcome = &mut moving => return outcome,
                next = newest(&mut targets) => next,
            };
            let Some(target) = next else {
                // The last target may have come just before the end.
                robot.send(Input::Close { goal: moving.id() });
                return moving.await;
            };
            let (taken, answer) = oneshot::channel();
            robot.send(Input::Update {
                goal: moving.id(),
                target,
                taken,
            });
            // Not taken, or no answer: the goal is over, and the motion itself says why.
            if let Ok(Err(error)) = answer.await {
                robot.send(Input::Cancel { goal: moving.id() });
                // Braked first: whoever hears of the bad target may count on an arm at rest.
                return match moving.await {
                    Err(MotionError::Stopped) | Ok(_) => Err(error.into()),
                    otherwise => otherwise,
                };
            }
        }
    }
}

/// Why the session of `arm` takes no goals any more, once it has ended.
async fn end_of(arm: Option<&Arm>) -> MotionError {
    match arm {
        Some(arm) => arm.ended().await.err().unwrap_or(MotionError::Disengaged),
        None => std::future::pending().await,
    }
}

/// The goal `common` with the first of its targets, whose kind decides what is not tuned.
fn towards(
    first: Target,
    common: &Goal,
    tuning: &Tuning,
    stiffness: Option<[f64; 6]>,
    limits: &JointLimits,
) -> Goal {
    let of_kind = Goal::new(common.id, first, common.on_arrival, limits);
    let Goal {
        gains, force_cap, ..
    } = tuning.apply(of_kind);
    let softened = |stiffness| gains.with_cartesian_stiffness(stiffness);
    Goal {
        target: first,
        gains: stiffness.map_or(gains, softened),
        force_cap,
        ..*common
    }
}

/// The newest of the targets that are there, once there is one; `None` at the end.
async fn newest(targets: &mut Targets) -> Option<Target> {
    let mut newest = targets.next().await?;
    while let Poll::Ready(Some(newer)) = poll_once(targets) {
        newest = newer;
    }
    Some(newest)
}

/// What a stream has at once. Whoever waits for more polls it again.
fn poll_once(targets: &mut Targets) -> Poll<Option<Target>> {
    let mut context = Context::from_waker(std::task::Waker::noop());
    targets.as_mut().poll_next(&mut context)
}

impl IntoFuture for Follow {
    type Output = Result<MotionReport, MotionError>;
    type IntoFuture = Pin<Box<dyn Future<Output = Self::Output> + Send>>;

    /// Resolves when the targets have ended and the arm rests at the last one, or with the reason
    /// why not. A target that is not accepted brakes the arm and ends the motion with
    /// [`MotionError::Goal`]. Before the first target nothing begins, and no watchdog counts; a
    /// stream that ends without any resolves as [`MotionError::Stopped`].
    ///
    /// # Cancel safety
    /// Dropping the future brakes the arm, in the background.
    fn into_future(self) -> Self::IntoFuture {
        Box::pin(self.run())
    }
}

impl fmt::Debug for Follow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Follow")
            .field("robot", &self.robot)
            .field("goal", &self.goal)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_rt::session::{DEFAULT_FORCE_CAP, GoalId};

    #[test]
    fn what_is_tuned_holds_for_a_stream_and_its_kind_decides_the_rest() {
        let limits = franka_model::Model::fr3().joint_limits();
        let common = Goal::new(GoalId(7), Target::Rest, OnArrival::Hold, limits);
        let joints = Target::Joints(franka_model::READY.into());
        let goal = |tuning, stiffness| towards(joints, &common, &tuning, stiffness, limits);
        let plain = goal(Tuning::default(), None);
        assert_eq!(plain, Goal::new(common.id, joints, OnArrival::Hold, limits));
        let tuning = Tuning {
            gains: Some(Gains::droid()),
            force_cap: Some(ForceCap::Newtons(0.5 * DEFAULT_FORCE_CAP)),
            ..Tuning::default()
        };
        let tuned = goal(tuning, None);
        assert_eq!(tuned.gains, Gains::droid());
        assert_eq!(tuned.force_cap, ForceCap::Newtons(0.5 * DEFAULT_FORCE_CAP));
        let stiffness = [200.0, 200.0, 200.0, 10.0, 10.0, 10.0];
        let soft = goal(tuning, Some(stiffness)).gains;
        assert_eq!(soft, Gains::droid().with_cartesian_stiffness(stiffness));
    }
}
