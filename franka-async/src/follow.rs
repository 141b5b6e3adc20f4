//! Following a stream of targets.

use std::future::{Future, IntoFuture};
use std::pin::Pin;

use franka_rt::law::Gains;
use franka_rt::lifecycle::{MotionError, MotionReport};
use franka_rt::session::{Budget, Goal, Target, Then, Tolerance};
use franka_rt::together::StartTicket;
use tokio::sync::{oneshot, watch};

use crate::bridge::Input;
use crate::motion::{Held, Moving, Work};
use crate::{Pose, Robot};

/// A motion that follows the newest target of a `watch`; see [`Robot::follow`]. Nothing moves before it is awaited. A clone
/// is without the [`start_with`](Self::start_with) of the original.
#[derive(Clone, Debug)]
#[must_use = "a motion does nothing until it is awaited"]
pub struct Follow {
    robot: Robot,
    targets: watch::Receiver<Pose>,
    budget: Budget,
    gains: Gains,
    tolerance: Tolerance,
    ticket: Held,
}

impl Follow {
    pub(crate) fn new(robot: Robot, targets: watch::Receiver<Pose>) -> Self {
        let budget = Budget::of(robot.model().joint_limits());
        Self {
            robot,
            targets,
            budget,
            gains: Gains::cartesian(),
            tolerance: Tolerance::default(),
            ticket: Held::default(),
        }
    }

    /// See [`Motion::speed`](crate::Motion::speed).
    pub fn speed(mut self, factor: f64) -> Self {
        self.budget = self.budget.scaled(factor);
        self
    }

    /// See [`Motion::limits`](crate::Motion::limits).
    pub fn limits(mut self, budget: Budget) -> Self {
        self.budget = budget;
        self
    }

    /// See [`Motion::stiffness`](crate::Motion::stiffness).
    pub fn stiffness(mut self, stiffness: [f64; 6]) -> Self {
        self.gains = self.gains.with_cartesian_stiffness(stiffness);
        self
    }

    /// See [`Motion::gains`](crate::Motion::gains).
    pub fn gains(mut self, gains: Gains) -> Self {
        self.gains = gains;
        self
    }

    /// How near to the last target counts as arrived.
    pub fn tolerance(mut self, tolerance: Tolerance) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// See [`Motion::start_with`](crate::Motion::start_with). Targets that come before the start replace the first one.
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Held(Some(ticket));
        self
    }

    async fn run(self) -> Result<MotionReport, MotionError> {
        let Self {
            robot,
            mut targets,
            budget,
            gains,
            tolerance,
            ticket,
        } = self;
        let first = Target::Pose(*targets.borrow_and_update());
        let id = robot.next_goal();
        let goal = Goal {
            id,
            target: first,
            then: Then::Hold,
            budget,
            gains,
            tolerance,
        };
        let mut moving = Moving::new(robot.clone(), Work::goal(goal, ticket.0));
        loop {
            tokio::select! {
                biased;
                outcome = &mut moving => return outcome,
                changed = targets.changed() => {
                    if changed.is_err() {
                        // The last target may have been sent just before the sender went.
                        robot.send(Input::Close { goal: moving.id() });
                        return moving.await;
                    }
                }
            }
            let target = Target::Pose(*targets.borrow_and_update());
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

impl IntoFuture for Follow {
    type Output = Result<MotionReport, MotionError>;
    type IntoFuture = Pin<Box<dyn Future<Output = Self::Output> + Send>>;

    /// Resolves when the sender is dropped and the arm rests at the last target, or with the reason why not. A target
    /// that is not accepted brakes the arm and ends the motion with [`MotionError::Goal`].
    ///
    /// # Cancel safety
    /// Dropping the future brakes the arm, in the background.
    fn into_future(self) -> Self::IntoFuture {
        Box::pin(self.run())
    }
}
