//! Motions that follow a stream of targets.

use std::fmt;
use std::future::{Future, IntoFuture};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use franka_rt::lifecycle::{MotionError, MotionReport, NewMotion};
use franka_rt::session::{Goal, GoalError, Lead, OnArrival, OnTimeout, Target, Watchdog};
use franka_rt::team::Round;
use franka_rt::together::StartTicket;
use tokio::sync::{oneshot, watch};
use tokio_stream::wrappers::WatchStream;
use tokio_stream::{Stream, StreamExt};

use crate::cancel::Canceller;
use crate::input::Input;
use crate::move_to::Moving;
use crate::options::{GoalOptions, goal_options};
use crate::robot::Robot;
use crate::session::Session;

/// Targets as they come, as a fused stream.
pub(crate) type Targets = Pin<Box<dyn Stream<Item = Target> + Send>>;

/// A motion that follows the newest target of a stream; see [`Robot::follow`] and
/// [`Arm::follow`](crate::Arm::follow). Nothing moves until it is awaited.
#[must_use = "a motion does nothing until it is awaited"]
pub struct Follow {
    robot: Robot,
    session: Option<Arc<Session>>,
    options: GoalOptions,
    lead: Option<Lead>,
    watchdog: Option<Watchdog>,
    targets: Targets,
    ticket: Option<StartTicket>,
}

impl Robot {
    /// Follows the newest target in `targets` (poses or joint positions `[rad]`) until the sender
    /// is dropped, and then stops at the last target. Targets may come at any rate, and may be any
    /// distance apart: the arm moves within its limits.
    pub fn follow<T: Into<Target> + Clone + Send + Sync + 'static>(
        &self,
        targets: watch::Receiver<T>,
    ) -> Follow {
        Follow::new(self.clone(), None, watched(targets))
    }

    /// Follows the newest target that a stream yields. Apart from that, it is like
    /// [`Self::follow`]. See also [`Arm::follow_stream`](crate::Arm::follow_stream).
    pub fn follow_stream<T: Into<Target> + 'static>(
        &self,
        targets: impl Stream<Item = T> + Send + 'static,
    ) -> Follow {
        Follow::new(self.clone(), None, streamed(targets))
    }
}

/// Returns the targets of a stream.
pub(crate) fn streamed<T: Into<Target> + 'static>(
    targets: impl Stream<Item = T> + Send + 'static,
) -> Targets {
    Box::pin(targets.map(Into::into).fuse())
}

/// Returns the targets of a watch channel, starting with its present value.
pub(crate) fn watched<T: Into<Target> + Clone + Send + Sync + 'static>(
    targets: watch::Receiver<T>,
) -> Targets {
    Box::pin(WatchStream::new(targets).map(Into::into).fuse())
}

impl Follow {
    pub(crate) fn new(robot: Robot, session: Option<Arc<Session>>, targets: Targets) -> Self {
        Self {
            robot,
            options: GoalOptions::default(),
            session,
            lead: None,
            watchdog: None,
            targets,
            ticket: None,
        }
    }

    goal_options!(target);

    /// Limits how far ahead of the arm a target may be, in metres and radians; both must be above
    /// zero. By default, there is no limit. While targets come, a target that is further ahead is
    /// moved closer in every cycle. Therefore a wrong target cannot move the arm far once the
    /// stream stops.
    pub fn lead(mut self, lead: Lead) -> Self {
        self.lead = Some(lead);
        self
    }

    /// Sets a watchdog that acts if no target has come for `silence`, which must be at least 10 ms,
    /// in whole milliseconds. The arm then continues to the last target ([`OnTimeout::Hold`]) or
    /// brakes at once ([`OnTimeout::Brake`]). When the arm rests, the future resolves as
    /// [`MotionError::Held`] or [`MotionError::Braked`], unless targets come again before that. A
    /// target counts even if it equals the previous one. The control thread measures this time, so
    /// the watchdog acts even if the program hangs. Without a watchdog, the arm holds the last
    /// target indefinitely.
    pub fn watchdog(mut self, silence: Duration, on_timeout: OnTimeout) -> Self {
        self.watchdog = Some(Watchdog {
            silence,
            on_timeout,
        });
        self
    }

    /// Makes the motion begin together with the motions of other robots: see
    /// [`Motion::start_with`](crate::Motion::start_with). Targets that come before the start
    /// replace the first one.
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Some(ticket);
        self
    }

    /// Makes the motion part of a team motion.
    pub(crate) fn in_round(mut self, round: Round) -> Self {
        self.options.round = Some(round);
        self
    }

    pub(crate) fn session(&self) -> Option<&Arc<Session>> {
        self.session.as_ref()
    }

    async fn run(self) -> Result<MotionReport, MotionError> {
        let Self {
            robot,
            session,
            options,
            lead,
            watchdog,
            mut targets,
            ticket,
        } = self;
        let (id, model) = (robot.next_goal(), robot.model());
        let towards = |target| {
            let goal = Goal::new(id, target, OnArrival::Hold, model.joint_limits());
            let options = options.within(session.as_ref().map(|session| session.tuning().get()));
            let goal = options.apply(goal, model)?;
            Ok::<_, MotionError>(Goal {
                lead,
                watchdog,
                ..goal
            })
        };
        // Refuse wrong options before waiting for a target.
        towards(Target::Rest)?;
        let first = tokio::select! {
            biased;
            ended = end_of(session.as_deref()) => return Err(ended),
            first = newest(&mut targets) => first,
        };
        let Some(first) = first else {
            // There is nothing to follow, so the arm continues as before.
            return Err(GoalError::NoTarget.into());
        };
        let motion = NewMotion::Goal {
            goal: Box::new(towards(first)?),
            path: None,
            ticket,
            session: session.as_deref().map(Session::id),
        };
        let mut moving = Moving::new(
            robot.clone(),
            Canceller::new(&robot, id),
            session,
            Ok(motion.into()),
        );
        loop {
            let next = tokio::select! {
                biased;
                outcome = &mut moving => return outcome,
                next = newest(&mut targets) => next,
            };
            let Some(target) = next else {
                // The last target may have arrived just before the end of the stream.
                robot.send(Input::Close { goal: moving.id() });
                return moving.await;
            };
            let (taken, answer) = oneshot::channel();
            robot.send(Input::Update {
                goal: moving.id(),
                target,
                taken,
            });
            // The target was not accepted, or there was no answer. The goal has ended, and the
            // motion itself reports the reason.
            if let Ok(Err(error)) = answer.await {
                robot.send(Input::Cancel {
                    goal: moving.id(),
                    refused: Some(error),
                });
                // Brake first, so that the arm rests once the error is returned.
                return moving.await;
            }
        }
    }
}

/// Waits for the end of the session, and returns the reason why it accepts no goals.
async fn end_of(session: Option<&Session>) -> MotionError {
    match session {
        Some(session) => session
            .ended()
            .await
            .err()
            .unwrap_or(MotionError::Disengaged),
        None => std::future::pending().await,
    }
}

/// Returns the newest available target once there is one; `None` at the end of the stream. If the
/// stream is always ready, returns the last of [`AT_ONCE`] targets, so that the caller can serve
/// other events.
async fn newest(targets: &mut Targets) -> Option<Target> {
    let mut newest = targets.next().await?;
    for _ in 1..AT_ONCE {
        let Poll::Ready(Some(newer)) = poll_once(targets) else {
            break;
        };
        newest = newer;
    }
    Some(newest)
}

/// Number of targets that are read from a stream before the newest one is passed on. A stream with
/// one target per millisecond reaches this number if the task is delayed by a quarter of a second.
const AT_ONCE: usize = 256;

/// Returns the next item if the stream has one ready. The next poll of the stream registers a waker
/// again.
fn poll_once(targets: &mut Targets) -> Poll<Option<Target>> {
    let mut context = Context::from_waker(std::task::Waker::noop());
    targets.as_mut().poll_next(&mut context)
}

impl IntoFuture for Follow {
    type Output = Result<MotionReport, MotionError>;
    type IntoFuture = Pin<Box<dyn Future<Output = Self::Output> + Send>>;

    /// Returns a future that resolves when the targets have ended and the arm rests at the last
    /// one, or with an error. A target that is not accepted brakes the arm and ends the motion with
    /// [`MotionError::Goal`]. Nothing begins before the first target, not even the watchdog. If the
    /// stream ends without a target, the future resolves as [`GoalError::NoTarget`].
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
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn a_stream_that_is_always_ready_does_not_keep_the_worker() {
        let mut polls = 0;
        let target = Target::Joints(franka_model::READY.into());
        let endless = futures::stream::poll_fn(move |_| {
            polls += 1;
            assert!(polls <= 10_000, "polled without end");
            Poll::Ready(Some(target))
        });
        let mut targets: Targets = Box::pin(endless);
        let taken = futures::FutureExt::now_or_never(newest(&mut targets));
        assert_eq!(taken, Some(Some(target)));
    }

    #[test]
    fn newest_waiting_target_is_taken() {
        let target = |x: f64| Target::Joints([x; 7]);
        let mut targets: Targets =
            Box::pin(futures::stream::iter((0..5).map(f64::from)).map(target));
        let taken = futures::FutureExt::now_or_never(newest(&mut targets));
        assert_eq!(taken, Some(Some(target(4.0))));
    }
}
