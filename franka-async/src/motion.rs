//! Motions to one target, and [`Moving`], the future of these, of followed targets and of control
//! functions. What dropping it does to the arm: `cancel`.

use std::future::IntoFuture;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use franka_rt::lifecycle::{MotionError, NewMotion, Outcome};
use franka_rt::session::{Goal, GoalError, GoalId, OnArrival, Target};
use franka_rt::together::StartTicket;
use tokio::sync::oneshot;

use crate::cancel::Canceller;
use crate::input::unserved;
use crate::options::{GoalOptions, goal_options};
use crate::robot::{Pose, Robot};
use crate::session::Session;

/// A motion that has not begun: nothing is sent before it is awaited or detached. A clone is a
/// motion of its own, with its own [`canceller`](Self::canceller) and without the
/// [`start_with`](Self::start_with) of the original.
#[derive(Debug)]
#[must_use = "a motion does nothing until it is awaited or detached"]
pub struct Motion {
    canceller: Canceller,
    session: Option<Arc<Session>>,
    target: Target,
    on_arrival: OnArrival,
    options: GoalOptions,
    ticket: Option<StartTicket>,
}

impl Robot {
    /// A motion of the end effector to `pose` in the base frame: a straight line and a rotation
    /// about one axis if it begins at rest. The arm is compliant on the way, see
    /// [`Motion::stiffness`].
    pub fn move_to(&self, pose: Pose) -> Motion {
        Motion::of_robot(self, Target::Pose(pose))
    }

    /// A motion of the joints to `q`, `[rad]`; all joints arrive together.
    pub fn move_joints(&self, q: [f64; 7]) -> Motion {
        Motion::of_robot(self, Target::Joints(q))
    }
}

impl Motion {
    fn of_robot(robot: &Robot, target: Target) -> Self {
        Self {
            canceller: Canceller::new(robot.clone(), robot.next_goal()),
            session: None,
            target,
            on_arrival: OnArrival::ReportAndFinish,
            options: GoalOptions::default(),
            ticket: None,
        }
    }

    /// A motion within a session, which holds the arm at the target.
    pub(crate) fn within(session: &Arc<Session>, target: Target) -> Self {
        Self {
            session: Some(session.clone()),
            on_arrival: OnArrival::ReportAndHold,
            options: GoalOptions::of_session(*session.tuning()),
            ..Self::of_robot(session.robot(), target)
        }
    }

    goal_options!(target);

    /// Begins together with the motions of other robots: the robot starts the motion, and holds the
    /// arm until all that have a ticket of the same [`StartBarrier`](crate::StartBarrier) are
    /// there; then they begin within a millisecond of each other. Such a motion supersedes nothing:
    /// it is refused as [`MotionError::Busy`] while anything controls the arm. If the others do not
    /// all come, it resolves as [`MotionError::Start`], and the arm has not moved.
    ///
    /// # Cancel safety
    /// Dropped, stopped or superseded before the start, it releases the others, which resolve as
    /// [`MotionError::Start`].
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Some(ticket);
        self
    }

    /// Begins the motion without a future: it runs on, and its outcome is only logged. It does not
    /// count as a handle: dropping the last handle of its session or robot still brakes it.
    pub fn detach(mut self) {
        match self.begin() {
            Ok(motion) => drop(self.canceller.begin(motion)),
            Err(error) => tracing::info!(goal = self.canceller.id().0, %error, "motion ended"),
        }
    }

    /// Returns a handle that brakes the motion from elsewhere.
    pub fn canceller(&self) -> Canceller {
        self.canceller.clone()
    }

    fn begin(&mut self) -> Result<NewMotion, GoalError> {
        let (id, model) = (self.canceller.id(), self.canceller.robot().model());
        let goal = Goal::new(id, self.target, self.on_arrival, model.joint_limits());
        Ok(NewMotion::Goal {
            goal: Box::new(self.options.apply(goal, model)?),
            ticket: self.ticket.take(),
            session: self.session.as_deref().map(Session::id),
        })
    }
}

impl Clone for Motion {
    fn clone(&self) -> Self {
        let robot = self.canceller.robot();
        Self {
            session: self.session.clone(),
            on_arrival: self.on_arrival,
            options: self.options,
            ..Self::of_robot(robot, self.target)
        }
    }
}

impl IntoFuture for Motion {
    type Output = Outcome;
    type IntoFuture = Moving;

    fn into_future(mut self) -> Moving {
        let motion = self.begin();
        Moving::new(self.canceller, self.session, motion)
    }
}

/// A motion as a future. It begins with the first poll and resolves when the arm has arrived,
/// rests, and is no longer controlled; or with the reason why not.
///
/// # Cancel safety
/// Dropping it brakes the arm, in the background: within about a quarter of a second and the
/// robot's limits.
///
/// # Panics
/// When polled after it has resolved, as futures may.
#[derive(Debug)]
#[must_use = "futures do nothing unless polled"]
pub struct Moving {
    canceller: Canceller,
    /// Keeps the session of the goal.
    session: Option<Arc<Session>>,
    progress: Progress,
}

#[derive(Debug)]
enum Progress {
    /// Or options that are not accepted.
    Ready(Result<NewMotion, GoalError>),
    Begun(oneshot::Receiver<Outcome>),
    Over,
}

impl Moving {
    /// `motion`, which has the name of the canceller, as a future.
    pub(crate) fn new(
        canceller: Canceller,
        session: Option<Arc<Session>>,
        motion: Result<NewMotion, GoalError>,
    ) -> Self {
        let named = |motion: &NewMotion| motion.id() == canceller.id();
        debug_assert!(motion.as_ref().ok().is_none_or(named));
        Self {
            canceller,
            session,
            progress: Progress::Ready(motion),
        }
    }

    pub(crate) fn id(&self) -> GoalId {
        self.canceller.id()
    }
}

impl Future for Moving {
    type Output = Outcome;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Outcome> {
        let mut outcome = match std::mem::replace(&mut self.progress, Progress::Over) {
            Progress::Ready(Err(error)) => return Poll::Ready(Err(error.into())),
            Progress::Ready(Ok(motion)) => match self.canceller.begin(motion) {
                Some(outcome) => outcome,
                None => return Poll::Ready(Err(MotionError::Stopped)),
            },
            Progress::Begun(outcome) => outcome,
            Progress::Over => panic!("a motion is not polled after it has resolved"),
        };
        let Poll::Ready(outcome) = Pin::new(&mut outcome).poll(context) else {
            self.progress = Progress::Begun(outcome);
            return Poll::Pending;
        };
        let outcome = outcome.unwrap_or_else(unserved);
        Poll::Ready(match &self.session {
            Some(session) => outcome.map_err(|error| session.explain(error)),
            None => outcome,
        })
    }
}

impl Drop for Moving {
    fn drop(&mut self) {
        if matches!(self.progress, Progress::Begun(_)) {
            self.canceller.cancel();
        }
    }
}
