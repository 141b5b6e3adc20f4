//! An engaged arm: one session of target control with many goals.

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

/// Options of a session of target control; see [`Robot::engage`]. By default, the session uses the
/// default gains for each kind of goal, and the default limits ([`Budget`](crate::goal::Budget)).
#[derive(Debug, Default)]
#[must_use = "options do nothing until `Robot::engage` takes them"]
pub struct Engage {
    options: GoalOptions,
    engagement: Engagement,
}

impl Engage {
    goal_options!();

    /// Keeps the arm out of these regions, which are given in the base frame. By default there are
    /// no regions. The reference (the commanded motion) slows down on its way to a region, and
    /// stops at the distance [`KEEP_OUT_STOP`](crate::goal::KEEP_OUT_STOP) from it. A goal that a
    /// region blocks is given up as [`Lapse::Blocked`](crate::error::Lapse::Blocked). A motion that
    /// follows a stream is not given up; it waits for other targets. An arm inside a region may
    /// leave it. The links of the arm and the Franka Hand are kept out; other tools are not
    /// checked. The session is refused as [`GoalError::KeepOut`](crate::error::GoalError::KeepOut)
    /// if there are more than [`KEEP_OUT_MAX`](crate::goal::KEEP_OUT_MAX) regions, a number is not
    /// finite, or a side is negative.
    pub fn keep_out(mut self, regions: impl IntoIterator<Item = Obstacle>) -> Self {
        self.engagement.keep_out = Some(regions.into_iter().collect());
        self
    }

    /// Limits the speed of all joints, the flange and the end effector, `[m/s]`, from 0.1 to 3. By
    /// default, only the limits of the goals apply. On the way to a pose, the speed of the
    /// reference (the commanded motion) stays below 94 % of the cap, and at least 0.03 m/s below
    /// the cap. The arm may still exceed the cap on the way to joint positions, or if something
    /// pushes it. The goal is then given up as [`Lapse::TooFast`](crate::error::Lapse::TooFast),
    /// and the arm brakes. A `speed` out of the range is refused as
    /// [`GoalError::Number`](crate::error::GoalError::Number).
    pub fn speed_cap(mut self, speed: f64) -> Self {
        self.engagement.speed_cap = Some(speed);
        self
    }

    /// Binds the session to a deadman, whose timer the program must restart regularly. If the timer
    /// has expired, or the deadman was dropped, the arm brakes and holds, and every goal resolves
    /// as [`MotionError::Held`]. The timer must be 10 ms or longer. See
    /// [`Deadman::new`](crate::goal::Deadman::new).
    pub fn deadman(mut self, monitor: DeadmanMonitor) -> Self {
        self.engagement.deadman = Some(monitor);
        self
    }

    /// Makes the session a member of a team.
    pub(crate) fn in_team(mut self, member: Member) -> Self {
        self.engagement.team = Some(member);
        self
    }

    /// Sets the backend that turns setpoints into torques; by default, the driver's own control
    /// law. [`Backend`] lists the guards of each backend, and [`Setpoints`](crate::goal::Setpoints)
    /// lists the goals that each kind of setpoint accepts. Other goals are refused as
    /// [`GoalError::Backend`](crate::error::GoalError::Backend).
    pub fn backend(mut self, backend: Backend) -> Self {
        self.engagement.backend = backend;
        self
    }

    /// Calls `function` with the record and the state of every cycle, on the real-time thread,
    /// after the command was sent. The function must not lock, allocate, print or wait. A function
    /// that panicked is not called again. To receive records outside that thread, use
    /// [`Robot::records`].
    pub fn observer(mut self, function: impl FnMut(&Record, &RobotState) + Send + 'static) -> Self {
        let mut function = UserValue::new("an observer", function);
        let observer = Observer::new(move |record, state| (*function)(record, state));
        self.engagement.observer = Some(observer);
        self
    }
}

/// A session of target control, which holds the arm and moves it between goals of any kind without
/// stopping. [`Robot::engage`] begins one.
///
/// This is a cheap handle: clones share the session, and an awaited motion counts as a handle.
/// Dropping the last handle brakes the arm and ends the session, in the background.
/// [`Self::disengage`] does the same and can be awaited. [`Robot::stop`] and a reflex end the
/// session, too. Later calls return the reason why it ended.
///
/// While a session controls the arm, motions of the [`Robot`] itself are refused as
/// [`MotionError::Busy`].
#[derive(Clone)]
#[must_use = "dropping the last handle ends the session and brakes the arm"]
pub struct Arm {
    session: Arc<Session>,
}

impl Robot {
    /// Begins a session of target control that holds the arm where it is, and resolves when the
    /// session has begun. If an earlier motion or session was dropped, waits until it has braked
    /// and released the arm.
    ///
    /// # Errors
    /// Returns [`MotionError::Busy`] if anything else controls the arm, [`MotionError::Goal`] if
    /// gains or limits are not accepted, and the robot's refusal if the robot does not start the
    /// session.
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
    /// Returns the robot of this arm.
    pub fn robot(&self) -> &Robot {
        self.session.robot()
    }

    /// Returns a motion to a pose or to joint positions; see [`Robot::move_to`]. The motion
    /// resolves when the arm has arrived and rests; the session then holds the arm. Dropping the
    /// motion brakes and holds the arm.
    pub fn move_to(&self, destination: impl Into<Destination>) -> Motion {
        Motion::within(&self.session, destination.into())
    }

    /// Returns a motion of the joints to `q`, `[rad]`. Apart from that, it is like
    /// [`Self::move_to`].
    pub fn move_joints(&self, q: impl Into<JointVector>) -> Motion {
        self.move_to(q.into())
    }

    /// Returns a motion of the end effector by `offset` from the present target, or from the
    /// measured pose if there is no target. Apart from that, it is like [`Self::move_to`].
    pub fn move_by(&self, offset: Offset) -> Motion {
        self.move_to(offset)
    }

    /// Returns a motion through several poses or joint positions, without stops at waypoints that
    /// are [rounded](Waypoint::blend). Apart from that, it is like [`Self::move_to`]; see
    /// [`Robot::move_through`].
    pub fn move_through<W: Into<Waypoint>>(
        &self,
        waypoints: impl IntoIterator<Item = W>,
    ) -> Motion {
        self.move_to(Target::Rest).along(waypoints)
    }

    /// Returns a motion that brakes the arm and resolves when the arm rests. Like every newer
    /// motion, it supersedes the current one.
    pub fn hold(&self) -> Motion {
        self.move_to(Target::Rest)
    }

    /// Replaces the current goal by a pose or joint positions, and holds the arm there on arrival.
    /// Returns as soon as the session has accepted the goal. Use it in a loop that sets its own
    /// pace.
    ///
    /// If the target includes a velocity, the arm follows the moving target without lag. If no new
    /// target comes, this target keeps moving for [`Target::MOVES_ON_MS`].
    ///
    /// # Errors
    /// Returns [`MotionError::Goal`] if the goal is not accepted, [`MotionError::Held`] if a
    /// [deadman](Engage::deadman) holds the arm, and otherwise the reason why the session ended.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the goal takes effect, even if the future is then dropped.
    pub async fn set(&self, destination: impl Into<Destination>) -> Result<(), MotionError> {
        self.take(destination.into()).await
    }

    /// Sets a goal as [`Self::set`] does, without waiting for an answer. Use it in plain threads,
    /// callbacks, and loops that set their own pace. If goals come faster than the session accepts
    /// them, only the newest one counts. This call checks the goal. If the session later refuses
    /// it, the refusal is only logged. This happens to a goal for a different [`Backend`], and to
    /// an offset that was set before the previous goal was accepted.
    ///
    /// # Errors
    /// See [`Self::set`].
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

    /// Returns the last accepted target, to which the arm moves or at which it is held. Returns
    /// [`Target::Rest`] while the arm follows a chunk, at the start of a session, and after a goal
    /// was given up. Returns `None` once the session has ended.
    pub fn target(&self) -> Option<Target> {
        let ended = self.session.has_ended();
        self.session.link().course.target().filter(|_| !ended)
    }

    /// Returns the reference (the commanded motion) of the current cycle; `None` once the session
    /// has ended.
    pub fn reference(&self) -> Option<Reference> {
        let ended = self.session.has_ended();
        self.robot().reference().filter(|_| !ended)
    }

    /// Waits until the arm rests at the last accepted target, or where the driver gave up that
    /// target. The arm is at rest if for 250 ms the reference has not moved and no joint has moved
    /// by more than half a milliradian. By then, the control law has compensated for the friction.
    /// Use this after [`Self::set`]; after an awaited motion, the arm rests anyway.
    ///
    /// The wait has no time limit. It may last while the arm is pushed, is blocked by an obstacle,
    /// or follows a stream. If you need a limit, use `tokio::time::timeout`.
    ///
    /// # Errors
    /// Returns the reason why the session ended.
    ///
    /// # Cancel safety
    /// Nothing happens if the future is dropped.
    pub async fn at_rest(&self) -> Result<(), MotionError> {
        // The bridge accepts earlier goals first, even if its task is delayed.
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
            // The connection has ended, and the session with it.
            std::future::pending().await
        };
        tokio::select! {
            biased;
            ended = self.ended() => Err(ended.err().unwrap_or(MotionError::Disengaged)),
            () = at_rest => Ok(()),
        }
    }

    /// Begins to follow a chunk: a list of timed points, for example the output of a learned
    /// controller (a policy). Returns as soon as the chunk is accepted. If an earlier chunk is
    /// running, the new chunk continues from it: see [`Chunk::blend`]. Use [`Chunk::observed_at`]
    /// to compensate for the age of the observation. The arm stays within its limits, regardless of
    /// the points. It rests at the last point unless another chunk or goal follows.
    ///
    /// # Errors
    /// Returns the errors of [`Self::set`], and:
    ///
    /// - [`MotionError::Held`] or [`MotionError::Braked`] in the first call after a guard ended the
    ///   previous chunk;
    /// - [`GoalError::Late`](crate::error::GoalError::Late) if the times of all points have passed;
    /// - [`GoalError::Ahead`](crate::error::GoalError::Ahead) if the observation time is more than
    ///   60 s in the robot's future, for example because it comes from a different clock;
    /// - [`GoalError::Outdated`](crate::error::GoalError::Outdated) if the observation of the
    ///   previous chunk is newer;
    /// - [`GoalError::Chunks`](crate::error::GoalError::Chunks) if chunks come faster than the
    ///   control thread accepts them.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the chunk takes effect, even if the future is then dropped.
    pub async fn chunk(&self, chunk: Chunk) -> Result<(), MotionError> {
        self.send_chunk(self.goal(chunk.target()), chunk).await
    }

    /// Sends a chunk with this goal. Apart from that, it is like [`Self::chunk`].
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

    /// Lets a person guide the arm by hand once the arm rests. No spring acts along the axes that
    /// are `free`, or at the elbow if it is free; the other axes are held. Guiding lasts until the
    /// next goal; [`Self::hold`] ends it. Returns as soon as the request is accepted. Declare the
    /// load first, or it pulls the arm down.
    ///
    /// # Errors
    /// See [`Self::set`].
    ///
    /// # Cancel safety
    /// Once the future has been polled, guiding begins, even if the future is then dropped.
    pub async fn guide(&self, free: Free) -> Result<(), MotionError> {
        self.take(Target::Guide(free).into()).await
    }

    /// Follows the newest target in `targets` (poses or joint positions) until the sender is
    /// dropped, and then stops at the last target. See [`Robot::follow`].
    pub fn follow<T: Into<Target> + Clone + Send + Sync + 'static>(
        &self,
        targets: watch::Receiver<T>,
    ) -> Follow {
        self.follow_targets(watched(targets))
    }

    /// Follows the newest target of a stream (poses or joint positions) until the stream ends, and
    /// then stops at the last target. If targets come faster than they are accepted, up to 256 of
    /// them are skipped at once. A stream that is always ready works, too.
    pub fn follow_stream<T: Into<Target> + 'static>(
        &self,
        targets: impl Stream<Item = T> + Send + 'static,
    ) -> Follow {
        self.follow_targets(streamed(targets))
    }

    fn follow_targets(&self, targets: Targets) -> Follow {
        Follow::new(self.robot().clone(), Some(self.session.clone()), targets)
    }

    /// Changes the tuning of the session's current goal and later goals. Options that are `None`
    /// stay as they are. Options of a single motion take precedence. The gains, the force cap and
    /// the [leash](Engage::leash) change over 0.3 s, so neither the reference nor the torques jump.
    ///
    /// # Errors
    /// Returns [`MotionError::Goal`] if a value is out of its bounds; nothing changes then. If the
    /// session has ended, returns the reason.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the change takes effect, even if the future is then
    /// dropped.
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

    /// Brakes the arm, releases it, and ends the session. Resolves when the session has ended. A
    /// motion under way resolves as [`MotionError::Stopped`]. All other handles of the session are
    /// then disengaged, too.
    ///
    /// # Errors
    /// Returns [`MotionError`] if the session ended for a different reason: a reflex, or
    /// [`Robot::stop`] ([`MotionError::Stopped`]).
    ///
    /// # Cancel safety
    /// Once the future has been polled, the session ends, even if the future is then dropped.
    pub async fn disengage(self) -> Result<MotionReport, MotionError> {
        let id = self.session.id();
        self.robot().send(Input::Disengage { id });
        self.ended().await
    }

    /// Resolves with the outcome of the session when it has ended.
    ///
    /// # Errors
    /// See [`Self::disengage`].
    ///
    /// # Cancel safety
    /// Nothing happens if the future is dropped.
    pub fn ended(
        &self,
    ) -> impl Future<Output = Result<MotionReport, MotionError>> + Send + 'static {
        self.session.ended()
    }

    pub(crate) fn owns(&self, session: Option<&Arc<Session>>) -> bool {
        session.is_some_and(|session| Arc::ptr_eq(session, &self.session))
    }

    /// Returns the reference pose of the end effector.
    ///
    /// # Errors
    /// Returns the reason why the session ended.
    pub(crate) fn held_pose(&self) -> Result<Isometry3<f64>, MotionError> {
        self.session.check()?;
        let reference = self.reference().ok_or(MotionError::Disengaged)?;
        Ok(reference.pose)
    }

    /// Returns the identifier of the current goal; `None` once the session has ended.
    #[cfg(feature = "record")]
    pub(crate) fn heading(&self) -> Option<franka_rt::session::GoalId> {
        let ended = self.session.has_ended();
        self.session.link().course.goal().filter(|_| !ended)
    }

    /// Returns the reason why the session accepts no goals; `None` while it accepts them.
    #[cfg(feature = "record")]
    pub(crate) fn session_error(&self) -> Option<MotionError> {
        self.session.check().err()
    }

    /// Returns a goal whose target is held on arrival.
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

/// Cycles after which an accepted goal moves the reference, with one to spare.
const TAKEN_UP: u64 = 3;

/// Time without motion after which the arm counts as resting, `[ms]`, as for arrivals of motions.
const SETTLED: u64 = 250;

/// Joint velocity below which the reference counts as resting, `[rad/s]`.
const REFERENCE_REST: f64 = 1e-3;

/// A joint that is further than this from its position at the start of the wait has moved, `[rad]`.
const MOVED: f64 = 5e-4;

impl fmt::Debug for Arm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Arm")
            .field("robot", self.robot())
            .finish_non_exhaustive()
    }
}
