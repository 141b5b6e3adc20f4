//! Motions to one target. [`Moving`] is the future of these motions, of followed targets and of
//! control functions. The module `cancel` describes the effect of dropping it.

use std::future::IntoFuture;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use franka_model::JointVector;
use franka_proto::RobotMode;
use franka_rt::lifecycle::{MotionError, NewMotion, Outcome};
use franka_rt::session::{Goal, GoalError, GoalId, OnArrival, Preview, Target, Waypoint};
use franka_rt::team::Round;
use franka_rt::together::StartTicket;
use nalgebra::Isometry3;
use tokio::sync::oneshot;

use crate::cancel::Canceller;
use crate::destination::{Destination, Now, Offset};
use crate::input::Beginning;
use crate::input::unserved;
use crate::options::{GoalOptions, goal_options};
use crate::progress::Progress;
use crate::robot::Robot;
use crate::session::Session;

/// A motion that has not begun: nothing is sent until it is awaited or detached. A clone is a
/// separate motion, with its own [`handle`](Self::handle) and without the
/// [`start_with`](Self::start_with) of the original.
///
/// A motion can be awaited as it is. Functions that take a future, such as `tokio::spawn`,
/// `tokio::time::timeout` and `block_on`, need its `.into_future()`.
#[derive(Debug)]
#[must_use = "a motion does nothing until it is awaited or detached"]
pub struct Motion {
    robot: Robot,
    canceller: Canceller,
    session: Option<Arc<Session>>,
    destination: Destination,
    path: Option<Arc<[Waypoint]>>,
    on_arrival: OnArrival,
    options: GoalOptions,
    joint_fallback: bool,
    ticket: Option<StartTicket>,
}

impl Robot {
    /// Returns a motion to a pose of the end effector in the base frame, or to joint positions,
    /// `[rad]`. A motion to a pose that begins at rest is a straight line and a rotation about one
    /// axis. The arm is compliant on the way: see [`Motion::stiffness`]. In a motion to joint
    /// positions, all joints arrive together.
    ///
    /// The task that awaits the motion plans the line to a pose, usually in a millisecond. If the
    /// line would bring joints to the ends of their ranges, or parts of the arm too close together,
    /// the elbow moves to a posture that avoids this. If no such posture exists, nothing moves, and
    /// the motion is refused as [`GoalError::NoLine`](crate::error::GoalError::NoLine). The error
    /// names joint positions that reach the pose. With [`Motion::joint_fallback`] the joints move
    /// to these positions instead.
    pub fn move_to(&self, destination: impl Into<Destination>) -> Motion {
        Motion::of_robot(self, destination.into())
    }

    /// Returns a motion through several poses, or several joint positions, to the last of them. The
    /// arm moves as fast as the limits allow, in straight lines, and does not stop at corners that
    /// are [rounded](Waypoint::blend). The whole motion has one outcome. If a waypoint is out of
    /// reach, or if the arm cannot follow a line between two poses, the motion is refused as
    /// [`MotionError::Path`] before anything moves. If something holds the arm back, the path
    /// waits: no waypoint is left out. Planning takes tens of milliseconds, on a thread for
    /// blocking work.
    ///
    /// ```no_run
    /// # use franka_async::{Error, Robot};
    /// use franka_async::{Pose, goal::Waypoint};
    ///
    /// # async fn run(robot: Robot) -> Result<(), Error> {
    /// let here = robot.pose();
    /// let above = Pose::translation(0.1, 0.0, 0.1) * here;
    /// let there = Pose::translation(0.1, 0.0, 0.0) * here;
    /// robot.move_through([Waypoint::new(above).blend(0.03), there.into()]).await?;
    /// # Ok(())
    /// # }
    /// ```
    pub fn move_through<W: Into<Waypoint>>(
        &self,
        waypoints: impl IntoIterator<Item = W>,
    ) -> Motion {
        self.move_to(Target::Rest).along(waypoints)
    }

    /// Returns a motion of the joints to `q`, `[rad]`; all joints arrive together.
    pub fn move_joints(&self, q: impl Into<JointVector>) -> Motion {
        self.move_to(q.into())
    }

    /// Returns a motion of the end effector by `offset` from the present target, or from the
    /// measured pose if no motion is under way. Apart from that, it is like [`Self::move_to`]. For
    /// several such motions in a row, [engage](Self::engage) the arm, because the arm moves a
    /// little whenever it is released.
    pub fn move_by(&self, offset: Offset) -> Motion {
        self.move_to(offset)
    }
}

impl Motion {
    fn of_robot(robot: &Robot, destination: Destination) -> Self {
        Self {
            robot: robot.clone(),
            canceller: Canceller::new(robot, robot.next_goal()),
            session: None,
            destination,
            path: None,
            on_arrival: OnArrival::ReportAndFinish,
            options: GoalOptions::default(),
            joint_fallback: false,
            ticket: None,
        }
    }

    /// Returns a motion within a session; the session then holds the arm at the target.
    pub(crate) fn within(session: &Arc<Session>, destination: Destination) -> Self {
        Self {
            session: Some(session.clone()),
            on_arrival: OnArrival::ReportAndHold,
            ..Self::of_robot(session.robot(), destination)
        }
    }

    /// Makes the motion pass through `waypoints` to the last of them.
    pub(crate) fn along<W: Into<Waypoint>>(self, waypoints: impl IntoIterator<Item = W>) -> Self {
        let path: Arc<[Waypoint]> = waypoints.into_iter().map(Into::into).collect();
        let last = path.last().map(|last| Destination::Target(*last.target()));
        Self {
            destination: last.unwrap_or(self.destination),
            path: Some(path),
            ..self
        }
    }

    goal_options!(target);

    /// Makes the joints move to the pose, as in [`Robot::move_joints`], if the arm cannot follow
    /// the straight line of [`Robot::move_to`]. The end effector then moves along a curve, so check
    /// for obstacles near the line. [`Self::preview`] shows the path. If the joints have no path to
    /// the pose either, the motion is refused as
    /// [`GoalError::NoLine`](crate::error::GoalError::NoLine). In a session that sends poses to the
    /// robot's own controller, the motion is refused as
    /// [`GoalError::Backend`](crate::error::GoalError::Backend).
    ///
    /// This option has no effect on motions through waypoints, on motions of joints, and on motions
    /// with a [condition](Self::until).
    pub fn joint_fallback(mut self) -> Self {
        self.joint_fallback = true;
        self
    }

    /// Makes the motion begin together with the motions of other robots. The robot starts the
    /// motion, and holds the arm until all motions with a ticket of the same
    /// [`StartBarrier`](crate::motion::StartBarrier) are ready. Then they begin within a
    /// millisecond of each other. Such a motion supersedes nothing: it is refused as
    /// [`MotionError::Busy`] if anything controls the arm. If not all motions become ready, the
    /// motion resolves as [`MotionError::Start`], and the arm has not moved.
    ///
    /// # Cancel safety
    /// If a motion is dropped, stopped or superseded before the start, the other robots' motions
    /// end and resolve as [`MotionError::Start`].
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Some(ticket);
        self
    }

    /// Makes the motion part of a team motion.
    pub(crate) fn in_round(mut self, round: Round) -> Self {
        self.options.round = Some(round);
        self
    }

    /// Makes the destination a pose of an object in the hand. `grasp` is the object's pose in the
    /// frame of the end effector.
    pub(crate) fn of_object(mut self, grasp: Isometry3<f64>) -> Self {
        self.options.grasp = Some(grasp);
        self
    }

    pub(crate) fn session(&self) -> Option<&Arc<Session>> {
        self.session.as_ref()
    }

    /// Begins the motion without a future: the motion continues, and its outcome is only logged. A
    /// detached motion does not count as a handle: dropping the last handle of its session or robot
    /// brakes the arm.
    pub fn detach(mut self) {
        match self.begin() {
            Ok(mut motion) => {
                plan_line(&mut motion, &self.robot, self.session.as_deref());
                drop(self.canceller.begin(&self.robot, motion));
            }
            Err(error) => tracing::info!(goal = self.canceller.id().0, %error, "motion ended"),
        }
    }

    /// Returns a handle with which any task can watch, pause or brake the motion.
    pub fn handle(&self) -> MotionHandle {
        MotionHandle(self.canceller.clone())
    }

    /// Returns a preview of the motion as if it began now. Nothing moves, and nothing is sent. The
    /// preview treats a motion to one target as a path with one waypoint; this is exact if the
    /// motion begins at rest. [`Preview::blocked`] reports whether the arm would come too close to
    /// itself or to a keep-out region. The call takes milliseconds.
    ///
    /// # Errors
    /// Returns [`MotionError::Path`] or [`MotionError::Goal`] if the motion would be refused.
    #[expect(
        clippy::disallowed_methods,
        reason = "in the caller's own thread, and no task of a connection calls it"
    )]
    pub fn preview(&self) -> Result<Preview, MotionError> {
        let (robot, model) = (&self.robot, self.robot.model());
        let (state, course) = (robot.state(), &robot.link().course);
        let reference = course.reference().map(|reference| reference.q);
        let now = Now::of(model, &state, course.target(), reference);
        let target = self.destination.seen_from(&now);
        let goal = Goal::new(
            self.canceller.id(),
            target,
            self.on_arrival,
            model.joint_limits(),
        );
        let mut goal = self.pursued().apply(goal, model)?;
        let mut one = [Waypoint::new(target)];
        let q = reference.unwrap_or(state.q);
        if self.path.is_none() {
            let session = self.session.as_deref();
            let kept = session.and_then(Session::posture).unwrap_or(q);
            match goal.plan_line(&q, &kept, model, &state) {
                Err(GoalError::NoLine {
                    posture: Some(q), ..
                }) if self.joint_fallback => one = [Waypoint::new(Target::Joints(q))],
                planned => planned?,
            }
        }
        let path = self.path.as_deref().unwrap_or(&one);
        Ok(Preview::of(path, &q, &goal, model, &state)?)
    }

    /// Returns the options of the motion, completed by the options of its session.
    fn pursued(&self) -> GoalOptions {
        let session = self.session.as_ref();
        self.options
            .within(session.map(|session| session.tuning().get()))
    }

    fn begin(&mut self) -> Result<Beginning, GoalError> {
        let (id, model) = (self.canceller.id(), self.robot.model());
        let kind = self.destination.kind();
        let goal = Goal::new(id, kind, self.on_arrival, model.joint_limits());
        let motion = NewMotion::Goal {
            goal: Box::new(self.pursued().apply(goal, model)?),
            path: None,
            ticket: self.ticket.take(),
            session: self.session.as_deref().map(Session::id),
        };
        let destination = Some(Box::new(self.destination));
        Ok(Beginning {
            motion,
            destination,
            path: self.path.clone(),
            refused: None,
            joint_fallback: self.joint_fallback.then(|| Box::new(self.pursued())),
        })
    }
}

/// Plans the straight line of a motion to a pose, from the arm's present place: see
/// [`Goal::plan_line`].
#[expect(
    clippy::disallowed_methods,
    reason = "in the caller's own task, and no task of a connection calls it"
)]
fn plan_line(motion: &mut Beginning, robot: &Robot, session: Option<&Session>) {
    let (NewMotion::Goal { goal, .. }, Some(destination), None) =
        (&motion.motion, &motion.destination, &motion.path)
    else {
        return;
    };
    let (model, state, course) = (robot.model(), robot.state(), &robot.link().course);
    let reference = course.reference().map(|reference| reference.q);
    // The bridge reports that a session has ended, or that a program moves the arm.
    let ended = session.is_some_and(Session::has_ended);
    if ended || reference.is_none() && state.robot_mode == RobotMode::Move {
        return;
    }
    let now = Now::of(model, &state, course.target(), reference);
    let mut goal = Goal {
        target: destination.seen_from(&now),
        ..**goal
    };
    let q = reference.unwrap_or(state.q);
    let kept = session.and_then(Session::posture).unwrap_or(q);
    match goal.plan_line(&q, &kept, model, &state) {
        Ok(()) => motion.lead(goal.posture),
        Err(
            error @ GoalError::NoLine {
                posture: Some(q), ..
            },
        ) => motion.lead_joints(q, error, model),
        Err(error) => motion.refused = Some(error),
    }
}

impl Clone for Motion {
    fn clone(&self) -> Self {
        Self {
            session: self.session.clone(),
            path: self.path.clone(),
            on_arrival: self.on_arrival,
            options: self.options,
            joint_fallback: self.joint_fallback,
            ..Self::of_robot(&self.robot, self.destination)
        }
    }
}

impl IntoFuture for Motion {
    type Output = Outcome;
    type IntoFuture = Moving;

    fn into_future(mut self) -> Moving {
        let motion = self.begin();
        Moving::new(self.robot, self.canceller, self.session, motion)
    }
}

/// Handle of a motion for other tasks: it reports progress, and pauses or brakes the motion. Clones
/// control the same motion. It does not count as a handle of the robot or the session, and does not
/// keep the motion going.
#[derive(Clone, Debug)]
pub struct MotionHandle(Canceller);

impl MotionHandle {
    /// Brakes and cancels the motion: see [`Canceller::cancel`].
    pub fn cancel(&self) {
        self.0.cancel();
    }

    /// Stops the arm on its way, and holds it there until [`Self::resume`]. The arm brakes within
    /// the limits of the motion, and stays on its line if it follows one. If the motion has not
    /// begun, the arm is held at the start of the motion. A pause has no effect after the end of
    /// the motion, or once a newer goal has come.
    ///
    /// The pause is part of the [duration](franka_rt::lifecycle::MotionReport::duration) of the
    /// motion, of its [`Progress::elapsed`], and of every time limit that the program sets.
    pub fn pause(&self) {
        self.0.set_paused(true);
    }

    /// Resumes the motion.
    pub fn resume(&self) {
        self.0.set_paused(false);
    }

    /// Returns the progress of the motion; `None` before it has begun and after its end.
    pub fn progress(&self) -> Option<Progress> {
        self.0.robot()?.link().course.progress(self.0.id())
    }
}

/// A motion as a future. The motion begins with the first poll. The future resolves when the arm
/// has arrived, rests, and is no longer controlled. If the motion ended earlier, it resolves with
/// the reason.
///
/// # Cancel safety
/// Dropping the future brakes the arm in the background, within the robot's limits and in about a
/// quarter of a second.
///
/// # Panics
/// Panics if polled after it has resolved, as futures may.
#[derive(Debug)]
#[must_use = "futures do nothing unless polled"]
pub struct Moving {
    /// Keeps the robot connected.
    robot: Robot,
    canceller: Canceller,
    /// Keeps the session of the goal alive.
    session: Option<Arc<Session>>,
    stage: Stage,
}

#[derive(Debug)]
enum Stage {
    /// The motion, or the error if its options are not accepted.
    Ready(Result<Box<Beginning>, GoalError>),
    Begun(oneshot::Receiver<Outcome>),
    Over,
}

impl Moving {
    /// Returns the future of `motion` of this robot; the canceller has the same goal.
    pub(crate) fn new(
        robot: Robot,
        canceller: Canceller,
        session: Option<Arc<Session>>,
        motion: Result<Beginning, GoalError>,
    ) -> Self {
        let named = |motion: &Beginning| motion.motion.id() == canceller.id();
        debug_assert!(motion.as_ref().ok().is_none_or(named));
        Self {
            robot,
            canceller,
            session,
            stage: Stage::Ready(motion.map(Box::new)),
        }
    }

    pub(crate) fn id(&self) -> GoalId {
        self.canceller.id()
    }
}

impl Future for Moving {
    type Output = Outcome;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Outcome> {
        let mut outcome = match std::mem::replace(&mut self.stage, Stage::Over) {
            Stage::Ready(Err(error)) => return Poll::Ready(Err(error.into())),
            Stage::Ready(Ok(mut motion)) => {
                plan_line(&mut motion, &self.robot, self.session.as_deref());
                match self.canceller.begin(&self.robot, *motion) {
                    Some(outcome) => outcome,
                    None => return Poll::Ready(Err(MotionError::Stopped)),
                }
            }
            Stage::Begun(outcome) => outcome,
            Stage::Over => panic!("a motion is not polled after it has resolved"),
        };
        let Poll::Ready(outcome) = Pin::new(&mut outcome).poll(context) else {
            self.stage = Stage::Begun(outcome);
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
        if matches!(self.stage, Stage::Begun(_)) {
            self.canceller.cancel();
        }
    }
}
