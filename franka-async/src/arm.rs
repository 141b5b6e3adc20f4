//! An engaged arm: one session, many goals.

use std::fmt;
use std::future::Future;
use std::sync::Arc;

use franka_model::JointVector;
use franka_model::collision::Obstacle;
use franka_proto::RobotState;
use franka_rt::driver::{Observer, Record, ReferenceState};
use franka_rt::lifecycle::{Engagement, MotionError, MotionReport, NewMotion, Tuning};
use franka_rt::session::{Backend, Chunk, DeadmanMonitor, Free, Goal, OnArrival, Target, Waypoint};
use franka_rt::team::Member;
use nalgebra::Isometry3;
use tokio::sync::{oneshot, watch};
use tokio_stream::Stream;

use crate::destination::{Destination, Now, Offset};
use crate::follow::{Follow, Targets, streamed, watched};
use crate::input::{Beginning, EndReply, Input, Replies};
use crate::move_to::Motion;
use crate::options::{GoalOptions, goal_options};
use crate::progress::Reference;
use crate::robot::Robot;
use crate::session::Session;
use crate::user_value::UserValue;

/// Options of a session of target control; see [`Robot::engage`]. The default holds with the gains
/// of each kind of goal and the default budget.
#[derive(Debug, Default)]
#[must_use = "options do nothing until `Robot::engage` takes them"]
pub struct Engage {
    options: GoalOptions,
    engagement: Engagement,
}

impl Engage {
    goal_options!();

    /// Keeps the arm out of these regions, base frame, none by default. The reference slows down on
    /// the way to one and stops [`KEEP_OUT_STOP`](crate::goal::KEEP_OUT_STOP) before it. A goal
    /// that this blocks is given up as [`Lapse::Blocked`](crate::error::Lapse::Blocked), while a
    /// stream continues and waits for other targets; an arm that stands in a region may leave it.
    /// Links and the Franka Hand are kept out, no other tool.
    /// [`GoalError::KeepOut`](crate::error::GoalError::KeepOut) refuses more than
    /// [`KEEP_OUT_MAX`](crate::goal::KEEP_OUT_MAX) regions, non-finite numbers and negative sides.
    pub fn keep_out(mut self, regions: impl IntoIterator<Item = Obstacle>) -> Self {
        self.engagement.keep_out = Some(regions.into_iter().collect());
        self
    }

    /// Limits the speed of all joints, the flange and the end effector, `[m/s]`, 0.1 to 3; by
    /// default there is only what goals ask for. On the way to a pose the reference is slowed to 94
    /// % of it, and 0.03 m/s below it at least. An arm that is still faster, because its goal leads
    /// over joints, or because something throws it, gives up its goal and is braked, as
    /// [`Lapse::TooFast`](crate::error::Lapse::TooFast).
    /// [`GoalError::Number`](crate::error::GoalError::Number) refuses other numbers.
    pub fn speed_cap(mut self, speed: f64) -> Self {
        self.engagement.speed_cap = Some(speed);
        self
    }

    /// Binds the session to a deadman: while it is silent, and once it is dropped, the arm brakes
    /// and holds, and every goal resolves as [`MotionError::Held`]. Its silence must be 10 ms or
    /// more. See [`Deadman::new`](crate::goal::Deadman::new).
    pub fn deadman(mut self, monitor: DeadmanMonitor) -> Self {
        self.engagement.deadman = Some(monitor);
        self
    }

    /// Makes the session a member of a team.
    pub(crate) fn in_team(mut self, member: Member) -> Self {
        self.engagement.team = Some(member);
        self
    }

    /// Sets the backend that turns setpoints into torques; by default the session's own law.
    /// [`Backend`] lists the guards of each backend, and [`Setpoints`](crate::goal::Setpoints) the
    /// goals that each kind takes. Goals that a backend does not support are refused as
    /// [`GoalError::Backend`](crate::error::GoalError::Backend).
    pub fn backend(mut self, backend: Backend) -> Self {
        self.engagement.backend = backend;
        self
    }

    /// Shows every cycle to `function`, on the real-time thread, once its command has left: the
    /// record of the cycle and its state. It must not lock, allocate, print or wait; if it panics
    /// it is not called again, and the session continues. For records outside the thread see
    /// [`Robot::records`].
    pub fn observer(mut self, function: impl FnMut(&Record, &RobotState) + Send + 'static) -> Self {
        let mut function = UserValue::new("an observer", function);
        let observer = Observer::new(move |record, state| (*function)(record, state));
        self.engagement.observer = Some(observer);
        self
    }
}

/// A session of target control: the arm is held, and goes from goal to goal of any kind without a
/// stop in between. Made by [`Robot::engage`].
///
/// A cheap handle: clones share the session, motions that are awaited are handles too. Dropping the
/// last one brakes the arm and ends the session, in the background; [`Self::disengage`] does the
/// same and can be awaited. [`Robot::stop`] ends it from outside, as does the robot by a reflex.
/// Every later call on the session then returns the reason.
///
/// While a session has the arm, motions of the [`Robot`] itself are refused as
/// [`MotionError::Busy`].
#[derive(Clone)]
#[must_use = "dropping the last handle ends the session and brakes the arm"]
pub struct Arm {
    session: Arc<Session>,
}

impl Robot {
    /// Begins a session that holds the arm where it is and then goes from goal to goal; resolves
    /// when it has begun. After a dropped motion or session it begins when that has released the
    /// arm.
    ///
    /// # Errors
    /// [`MotionError::Busy`] while anything else controls the arm, [`MotionError::Goal`] for gains
    /// or limits that are not accepted, or the robot's refusal.
    ///
    /// # Cancel safety
    /// Dropping the future ends the session, in the background.
    pub async fn engage(&self, engage: Engage) -> Result<Arm, MotionError> {
        let Engage {
            options,
            engagement,
        } = engage;
        let limits = self.model().joint_limits();
        let tuning = options.session_tuning(self.model())?;
        let goal = Goal::new(self.next_goal(), Target::Rest, OnArrival::Hold, limits);
        let goal = tuning.apply(goal);
        let (begin, began) = oneshot::channel();
        let (end, ended) = watch::channel(None);
        let pulse = engagement.deadman.as_ref().map(DeadmanMonitor::pulse);
        let session = Session::new(self.clone(), goal.id, tuning, pulse, ended);
        let arm = Arm {
            session: Arc::new(session),
        };
        self.send(Input::Begin {
            motion: NewMotion::Session {
                goal: Box::new(goal),
                engagement,
            }
            .into(),
            replies: Replies {
                began: Some(begin),
                ended: EndReply::All(end),
            },
        });
        match began.await {
            Ok(()) => {
                let reference = self.link().course.reference();
                arm.session.keep(reference.map(|reference| reference.q));
                Ok(arm)
            }
            Err(_) => Err(arm.ended().await.err().unwrap_or(MotionError::Stopped)),
        }
    }
}

impl Arm {
    /// The robot of this arm.
    pub fn robot(&self) -> &Robot {
        self.session.robot()
    }

    /// A motion to a pose or to joint positions; see [`Robot::move_to`]. It resolves when the arm
    /// has arrived and rests; the arm is then held. Dropping it brakes the arm and holds it.
    pub fn move_to(&self, destination: impl Into<Destination>) -> Motion {
        Motion::within(&self.session, destination.into())
    }

    /// A motion of the joints to `q`, `[rad]`; otherwise like [`Self::move_to`].
    pub fn move_joints(&self, q: impl Into<JointVector>) -> Motion {
        self.move_to(q.into())
    }

    /// A motion of the end effector away from the present target, or from the arm; otherwise like
    /// [`Self::move_to`].
    pub fn move_by(&self, offset: Offset) -> Motion {
        self.move_to(offset)
    }

    /// A motion through several poses, or several joint positions, without stops where they are
    /// [rounded](Waypoint::blend); otherwise like [`Self::move_to`]. See [`Robot::move_through`].
    pub fn move_through<W: Into<Waypoint>>(
        &self,
        waypoints: impl IntoIterator<Item = W>,
    ) -> Motion {
        self.move_to(Target::Rest).along(waypoints)
    }

    /// Brakes at any time, and resolves when the arm rests; it is then held there.
    pub fn hold(&self) -> Motion {
        self.move_to(Target::Rest)
    }

    /// Replaces the current goal by a pose or joint positions, and holds them on arrival. Returns
    /// as soon as the goal is taken. For programs that set goals at their own rate and read the
    /// state for the rest.
    ///
    /// A target that comes with its velocity is followed without a lag. Without new targets it
    /// keeps moving for [`Target::MOVES_ON_MS`].
    ///
    /// # Errors
    /// [`MotionError::Goal`] for a goal that is not accepted, [`MotionError::Held`] while a
    /// [deadman](Engage::deadman) holds the arm, and the cause of the end of the session.
    ///
    /// # Cancel safety
    /// Once the future is polled, the goal is still taken.
    pub async fn set(&self, destination: impl Into<Destination>) -> Result<(), MotionError> {
        self.take(destination.into()).await
    }

    /// As [`Self::set`], without waiting for an answer: for plain threads, callbacks and loops at
    /// their own rate. If goals come faster than they are taken, the newest one counts. A goal is
    /// checked here. Refusals by the session are only logged: by the [`Backend`], and of an offset
    /// that comes before the previous goal was taken.
    ///
    /// # Errors
    /// As for [`Self::set`].
    pub fn try_set(&self, destination: impl Into<Destination>) -> Result<(), MotionError> {
        let destination = destination.into();
        self.session.check_goal()?;
        let (robot, waiting) = (self.robot(), &self.session.waiting);
        let mut goal = self.goal(destination.kind());
        if matches!(destination, Destination::Target(_)) || waiting.is_empty() {
            let (model, state, course) = (robot.model(), robot.state(), &robot.link().course);
            let reference = course.reference().map(|reference| reference.q);
            let now = Now::of(model, &state, course.target(), reference);
            goal.target = destination.seen_from(&now);
            goal.check(model, &state)?;
        }
        if waiting.put(self.beginning(goal, destination)) {
            let waiting = waiting.clone();
            robot.send(Input::SetNewest { waiting });
        }
        Ok(())
    }

    /// Target that the arm heads for or is held at, the last one taken. [`Target::Rest`] along a
    /// chunk, at the start of a session and where a goal was given up; `None` once the session has
    /// ended.
    pub fn target(&self) -> Option<Target> {
        let ended = self.session.has_ended();
        self.session.link().course.target().filter(|_| !ended)
    }

    /// Returns the reference of this millisecond; `None` once the session has ended.
    pub fn reference(&self) -> Option<Reference> {
        let ended = self.session.has_ended();
        self.robot().reference().filter(|_| !ended)
    }

    /// Waits until the arm rests at the last target taken, or where that target has been given up.
    /// At rest means that for 250 ms the reference has not moved and no joint has moved by more
    /// than half a milliradian, so that friction has been made up for. For goals that are
    /// [set](Self::set); a motion that is awaited rests when it resolves.
    ///
    /// It has no time limit. An arm that is pushed, that an obstacle holds back from its target, or
    /// that follows a stream, rests only when that ends. Only the program knows how long that may
    /// take. Where it may take indefinitely, await it within `tokio::time::timeout`.
    ///
    /// # Errors
    /// The cause of the end of the session.
    ///
    /// # Cancel safety
    /// Nothing happens if the future is dropped.
    pub async fn at_rest(&self) -> Result<(), MotionError> {
        // Goals that were set before are taken first, however long that task is delayed.
        self.session.ask(|taken| Input::Await { taken }).await?;
        let link = self.session.link();
        let mut states = self.robot().states();
        let mut begin = states.newest();
        begin.message_id += TAKEN_UP;
        let at_rest = async {
            while let Ok(state) = states.changed().await {
                let reference = link.course.reference().filter(|it| it.remaining.is_zero());
                let still = |it: ReferenceState| it.dq.iter().all(|dq| dq.abs() < REFERENCE_REST);
                let moved = |i: usize| (state.q[i] - begin.q[i]).abs() > MOVED;
                if !reference.is_some_and(still) || (0..7).any(moved) {
                    let message_id = begin.message_id.max(state.message_id);
                    begin = RobotState {
                        message_id,
                        ..state
                    };
                } else if state.message_id >= begin.message_id + SETTLED {
                    return;
                }
            }
            // The connection has ended, and with it the session.
            std::future::pending().await
        };
        tokio::select! {
            biased;
            ended = self.ended() => Err(ended.err().unwrap_or(MotionError::Disengaged)),
            () = at_rest => Ok(()),
        }
    }

    /// Follows a chunk of points with times, as a policy predicts them, from now on; returns as
    /// soon as it is taken. A chunk that comes while another one runs continues from it: see
    /// [`Chunk::blend`]. Use [`Chunk::observed_at`] to compensate for the age of the observation.
    /// The limits are kept for any points. The arm rests at the last one unless another chunk or
    /// goal comes.
    ///
    /// # Errors
    /// As for [`Self::set`]. If a guard gave up the previous chunk, once: [`MotionError::Held`] or
    /// [`MotionError::Braked`]. [`GoalError::Late`](crate::error::GoalError::Late) if all points
    /// have passed. [`GoalError::Ahead`](crate::error::GoalError::Ahead) if the observation is of
    /// another clock. [`GoalError::Outdated`](crate::error::GoalError::Outdated) if the observation
    /// of the previous chunk is newer. [`GoalError::Chunks`](crate::error::GoalError::Chunks) if
    /// chunks come faster than the control thread takes them up.
    ///
    /// # Cancel safety
    /// As [`Self::set`].
    pub async fn chunk(&self, chunk: Chunk) -> Result<(), MotionError> {
        self.send_chunk(self.goal(chunk.target()), chunk).await
    }

    /// Sends a chunk with this goal; otherwise as [`Self::chunk`].
    pub(crate) async fn send_chunk(&self, goal: Goal, chunk: Chunk) -> Result<(), MotionError> {
        let id = self.session.id();
        let (goal, chunk) = (Box::new(goal), Box::new(chunk));
        self.session
            .ask(|taken| Input::Chunk {
                id,
                goal,
                chunk,
                taken,
            })
            .await
    }

    /// Lets a hand guide the arm once it rests. There is no spring along the axes that are `free`,
    /// nor at the elbow if that is free; the others stay where they are. Guiding lasts until the
    /// next goal; [`Self::hold`] ends it. Returns as soon as it is taken. Declare the load, or it
    /// pulls the arm down.
    ///
    /// # Errors
    /// As [`Self::set`].
    ///
    /// # Cancel safety
    /// As [`Self::set`].
    pub async fn guide(&self, free: Free) -> Result<(), MotionError> {
        self.take(Target::Guide(free).into()).await
    }

    /// Follows the newest of the targets that `targets` shows, poses or joint positions, until the
    /// sender is dropped, and then stops at the last one. See [`Robot::follow`].
    pub fn follow<T: Into<Target> + Clone + Send + Sync + 'static>(
        &self,
        targets: watch::Receiver<T>,
    ) -> Follow {
        self.follow_targets(watched(targets))
    }

    /// Follows the newest of the targets that a stream yields, poses or joint positions, until it
    /// ends, and then stops at the last one. Targets that came while another one was taken are
    /// skipped, up to 256 at once: a stream that is always ready is followed, too.
    pub fn follow_stream<T: Into<Target> + 'static>(
        &self,
        targets: impl Stream<Item = T> + Send + 'static,
    ) -> Follow {
        self.follow_targets(streamed(targets))
    }

    fn follow_targets(&self, targets: Targets) -> Follow {
        Follow::new(self.robot().clone(), Some(self.session.clone()), targets)
    }

    /// Retunes the current and later goals of the session, and leaves options that are `None` as
    /// they are. Options of a motion come before it. Gains, force cap and leash fade over 0.3 s:
    /// neither the reference nor the torques step.
    ///
    /// # Errors
    /// [`MotionError::Goal`] for values out of their bounds, which change nothing; the cause of the
    /// end of the session.
    ///
    /// # Cancel safety
    /// Once the future is polled, the change is still made.
    pub async fn tune(&self, tuning: Tuning) -> Result<(), MotionError> {
        let (id, kept) = (self.session.id(), self.session.tuning().clone());
        let tuning = Box::new(tuning);
        self.session
            .ask(|taken| Input::Tune {
                id,
                tuning,
                kept,
                taken,
            })
            .await
    }

    /// Brakes, releases the arm and ends the session; resolves when it has ended. A goal under way
    /// resolves as [`MotionError::Stopped`]. Every other handle is then disengaged.
    ///
    /// # Errors
    /// [`MotionError`] if the session ended otherwise: by a reflex, or [`MotionError::Stopped`] by
    /// [`Robot::stop`].
    ///
    /// # Cancel safety
    /// Once the future is polled, the session still ends.
    pub async fn disengage(self) -> Result<MotionReport, MotionError> {
        let id = self.session.id();
        self.robot().send(Input::Disengage { id });
        self.ended().await
    }

    /// Resolves when the session has ended, with its outcome.
    ///
    /// # Errors
    /// As [`Self::disengage`].
    ///
    /// # Cancel safety
    /// Nothing happens if it is dropped.
    pub fn ended(
        &self,
    ) -> impl Future<Output = Result<MotionReport, MotionError>> + Send + 'static {
        self.session.ended()
    }

    /// True if a motion belongs to the session of this arm.
    pub(crate) fn owns(&self, session: Option<&Arc<Session>>) -> bool {
        session.is_some_and(|session| Arc::ptr_eq(session, &self.session))
    }

    /// Pose of the reference of the end effector.
    ///
    /// # Errors
    /// The cause of the end of the session.
    pub(crate) fn held_pose(&self) -> Result<Isometry3<f64>, MotionError> {
        self.session.check()?;
        let reference = self.reference().ok_or(MotionError::Disengaged)?;
        Ok(reference.pose)
    }

    /// Name of the current goal; `None` once the session has ended.
    #[cfg(feature = "record")]
    pub(crate) fn heading(&self) -> Option<franka_rt::session::GoalId> {
        let ended = self.session.has_ended();
        self.session.link().course.goal().filter(|_| !ended)
    }

    /// Returns the reason why the session takes no goals; `None` while it does.
    #[cfg(feature = "record")]
    pub(crate) fn session_error(&self) -> Option<MotionError> {
        self.session.check().err()
    }

    /// A goal that is set and then held.
    pub(crate) fn goal(&self, target: Target) -> Goal {
        let robot = self.robot();
        let limits = robot.model().joint_limits();
        let goal = Goal::new(robot.next_goal(), target, OnArrival::Hold, limits);
        self.session.tuning().get().apply(goal)
    }

    fn beginning(&self, goal: Goal, destination: Destination) -> Beginning {
        Beginning {
            motion: NewMotion::Goal {
                goal: Box::new(goal),
                path: None,
                ticket: None,
                session: Some(self.session.id()),
            },
            destination: Some(Box::new(destination)),
            path: None,
            refused: None,
            joint_fallback: None,
        }
    }

    async fn take(&self, destination: Destination) -> Result<(), MotionError> {
        let motion = self.beginning(self.goal(destination.kind()), destination);
        self.session.ask(|taken| Input::Set { motion, taken }).await
    }
}

/// Cycles after which a goal that was taken moves the reference, with one to spare.
const TAKEN_UP: u64 = 3;

/// Time without a motion after which an arm rests, `[ms]`: as for the arrival of a motion.
const SETTLED: u64 = 250;

/// Joint velocity of the reference below which it rests, `[rad/s]`.
const REFERENCE_REST: f64 = 1e-3;

/// Distance of a joint from where it was when the wait began, `[rad]`, from which on it has moved.
const MOVED: f64 = 5e-4;

impl fmt::Debug for Arm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Arm")
            .field("robot", self.robot())
            .finish_non_exhaustive()
    }
}
