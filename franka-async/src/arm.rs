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

/// Options of a session of target control; see [`Robot::engage`]. By default the session holds the
/// arm with the gains of each kind of goal and the default budget.
#[derive(Debug, Default)]
#[must_use = "options do nothing until `Robot::engage` takes them"]
pub struct Engage {
    options: GoalOptions,
    engagement: Engagement,
}

impl Engage {
    goal_options!();

    /// Keeps the arm out of these regions, in the base frame; none by default. The reference slows
    /// down on its way to a region and stops [`KEEP_OUT_STOP`](crate::goal::KEEP_OUT_STOP) before
    /// the region. A goal that a region blocks is given up as
    /// [`Lapse::Blocked`](crate::error::Lapse::Blocked). A stream waits for other targets. An arm
    /// inside a region may leave it. Links and the Franka Hand are kept out, no other tool.
    /// [`GoalError::KeepOut`](crate::error::GoalError::KeepOut) refuses more than
    /// [`KEEP_OUT_MAX`](crate::goal::KEEP_OUT_MAX) regions, non-finite numbers and negative sides.
    pub fn keep_out(mut self, regions: impl IntoIterator<Item = Obstacle>) -> Self {
        self.engagement.keep_out = Some(regions.into_iter().collect());
        self
    }

    /// Limits the speed of all joints, the flange and the end effector, `[m/s]`, 0.1 to 3; by
    /// default only the limits of the goals hold. On the way to a pose the reference is slowed to
    /// 94 % of the cap, and to 0.03 m/s below the cap at least. The arm may still be faster if its
    /// goal moves the joints, or if something pushes the arm. The goal is then given up as
    /// [`Lapse::TooFast`](crate::error::Lapse::TooFast), and the arm brakes.
    /// [`GoalError::Number`](crate::error::GoalError::Number) refuses other numbers.
    pub fn speed_cap(mut self, speed: f64) -> Self {
        self.engagement.speed_cap = Some(speed);
        self
    }

    /// Binds the session to a deadman. While the deadman is silent, and once it is dropped, the arm
    /// brakes and holds, and every goal resolves as [`MotionError::Held`]. The silence that the
    /// deadman allows must be 10 ms or more. See [`Deadman::new`](crate::goal::Deadman::new).
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
    /// [`Backend`] lists the guards of each backend, [`Setpoints`](crate::goal::Setpoints) the
    /// goals of each kind of setpoint. Other goals are refused as
    /// [`GoalError::Backend`](crate::error::GoalError::Backend).
    pub fn backend(mut self, backend: Backend) -> Self {
        self.engagement.backend = backend;
        self
    }

    /// Calls `function` in every cycle, on the real-time thread, once the command has left, with
    /// the record and the state. The function must not lock, allocate, print or wait. After a panic
    /// it is not called again. For records outside the thread see [`Robot::records`].
    pub fn observer(mut self, function: impl FnMut(&Record, &RobotState) + Send + 'static) -> Self {
        let mut function = UserValue::new("an observer", function);
        let observer = Observer::new(move |record, state| (*function)(record, state));
        self.engagement.observer = Some(observer);
        self
    }
}

/// A session of target control: the session holds the arm and moves it from goal to goal of any
/// kind without a stop in between. Made by [`Robot::engage`].
///
/// A cheap handle: clones share the session, and awaited motions are handles, too. Dropping the
/// last handle brakes the arm and ends the session, in the background. [`Self::disengage`] does so
/// and can be awaited. [`Robot::stop`] and a reflex end it, too. Later calls return the reason.
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
    /// session has begun. A dropped motion or session first brakes and releases the arm.
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
    /// Returns the robot of this arm.
    pub fn robot(&self) -> &Robot {
        self.session.robot()
    }

    /// Returns a motion to a pose or to joint positions; see [`Robot::move_to`]. It resolves when
    /// the arm has arrived and rests, held. Dropping the motion brakes and holds the arm.
    pub fn move_to(&self, destination: impl Into<Destination>) -> Motion {
        Motion::within(&self.session, destination.into())
    }

    /// Returns a motion of the joints to `q`, `[rad]`; otherwise like [`Self::move_to`].
    pub fn move_joints(&self, q: impl Into<JointVector>) -> Motion {
        self.move_to(q.into())
    }

    /// Returns a motion of the end effector by `offset` from the present target, or from the arm;
    /// otherwise like [`Self::move_to`].
    pub fn move_by(&self, offset: Offset) -> Motion {
        self.move_to(offset)
    }

    /// Returns a motion through several poses or joint positions, without stops at waypoints that
    /// are [rounded](Waypoint::blend). Otherwise like [`Self::move_to`]; see
    /// [`Robot::move_through`].
    pub fn move_through<W: Into<Waypoint>>(
        &self,
        waypoints: impl IntoIterator<Item = W>,
    ) -> Motion {
        self.move_to(Target::Rest).along(waypoints)
    }

    /// Returns a motion that brakes the arm at any time, and resolves when the arm rests.
    pub fn hold(&self) -> Motion {
        self.move_to(Target::Rest)
    }

    /// Replaces the current goal by a pose or joint positions, and holds the arm there on arrival.
    /// Returns as soon as the session has accepted the goal. For goals at the program's own rate.
    ///
    /// The arm follows a target with a velocity without a lag. Without new targets, this target
    /// keeps moving for [`Target::MOVES_ON_MS`].
    ///
    /// # Errors
    /// [`MotionError::Goal`] for a goal that is not accepted, [`MotionError::Held`] while a
    /// [deadman](Engage::deadman) holds the arm, and the cause of the end of the session.
    ///
    /// # Cancel safety
    /// Once the future is polled, the goal still takes effect.
    pub async fn set(&self, destination: impl Into<Destination>) -> Result<(), MotionError> {
        self.take(destination.into()).await
    }

    /// As [`Self::set`], without waiting for an answer: for plain threads, callbacks and loops at
    /// their own rate. If goals come faster than the session accepts them, only the newest one
    /// counts. This call checks the goal. Later refusals are only logged. They concern goals for
    /// another [`Backend`], and an offset before the previous goal was accepted.
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

    /// Returns the target that the arm moves to or is held at: the last one accepted. This is
    /// [`Target::Rest`] along a chunk, at the start of a session and where a goal was given up.
    /// `None` once the session has ended.
    pub fn target(&self) -> Option<Target> {
        let ended = self.session.has_ended();
        self.session.link().course.target().filter(|_| !ended)
    }

    /// Returns the reference of this millisecond; `None` once the session has ended.
    pub fn reference(&self) -> Option<Reference> {
        let ended = self.session.has_ended();
        self.robot().reference().filter(|_| !ended)
    }

    /// Waits until the arm rests at the last accepted target, or where that target was given up.
    /// The arm is at rest if for 250 ms the reference has not moved and no joint has moved by more
    /// than half a milliradian. The law has then compensated the friction. For goals that are
    /// [set](Self::set); after an awaited motion the arm rests anyway.
    ///
    /// The wait has no time limit. It may last while the arm is pushed, is blocked by an obstacle,
    /// or follows a stream. Where that may take indefinitely, await it within
    /// `tokio::time::timeout`.
    ///
    /// # Errors
    /// The cause of the end of the session.
    ///
    /// # Cancel safety
    /// Nothing happens if the future is dropped.
    pub async fn at_rest(&self) -> Result<(), MotionError> {
        // The bridge accepts earlier goals first, however long its task is delayed.
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

    /// Follows a chunk of points with times, as a policy predicts them, from now on. Returns as
    /// soon as the chunk is accepted. If another chunk is running, the new one continues from it:
    /// see [`Chunk::blend`]. Use [`Chunk::observed_at`] to compensate for the age of the
    /// observation. The arm keeps its limits for any points. It rests at the last point unless
    /// another chunk or goal comes.
    ///
    /// # Errors
    /// As for [`Self::set`]. [`MotionError::Held`] or [`MotionError::Braked`], once, if a guard
    /// gave up the previous chunk. [`GoalError::Late`](crate::error::GoalError::Late) if all points
    /// have passed. [`GoalError::Ahead`](crate::error::GoalError::Ahead) if the observation time
    /// comes from another clock. [`GoalError::Outdated`](crate::error::GoalError::Outdated) if the
    /// observation of the previous chunk is newer.
    /// [`GoalError::Chunks`](crate::error::GoalError::Chunks) if chunks come faster than the
    /// control thread takes them up.
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

    /// Lets a hand guide the arm once the arm rests. No spring acts along the axes that are `free`,
    /// nor at the elbow if it is free; the other axes stay where they are. Guiding lasts until the
    /// next goal; [`Self::hold`] ends it. Returns as soon as the request is accepted. Declare the
    /// load, or the load pulls the arm down.
    ///
    /// # Errors
    /// As [`Self::set`].
    ///
    /// # Cancel safety
    /// As [`Self::set`].
    pub async fn guide(&self, free: Free) -> Result<(), MotionError> {
        self.take(Target::Guide(free).into()).await
    }

    /// Follows the newest of the targets in `targets`, poses or joint positions, until the sender
    /// is dropped, and then stops at the last target. See [`Robot::follow`].
    pub fn follow<T: Into<Target> + Clone + Send + Sync + 'static>(
        &self,
        targets: watch::Receiver<T>,
    ) -> Follow {
        self.follow_targets(watched(targets))
    }

    /// Follows the newest of the targets that a stream yields, poses or joint positions, until the
    /// stream ends, and then stops at the last target. Targets that come while another one is being
    /// accepted are skipped, up to 256 at once. This works for a stream that is always ready, too.
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
    /// they are. Options of a single motion take precedence. Gains, force cap and leash change over
    /// 0.3 s, so that neither the reference nor the torques step.
    ///
    /// # Errors
    /// [`MotionError::Goal`] for values out of their bounds, which change nothing. Otherwise, the
    /// cause of the end of the session.
    ///
    /// # Cancel safety
    /// Once the future is polled, the change still takes effect.
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

    /// Brakes, releases the arm and ends the session; resolves when the session has ended. A goal
    /// under way resolves as [`MotionError::Stopped`]. All other handles of the session are then
    /// disengaged, too.
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
    /// Nothing happens if the future is dropped.
    pub fn ended(
        &self,
    ) -> impl Future<Output = Result<MotionReport, MotionError>> + Send + 'static {
        self.session.ended()
    }

    /// True if a motion belongs to the session of this arm.
    pub(crate) fn owns(&self, session: Option<&Arc<Session>>) -> bool {
        session.is_some_and(|session| Arc::ptr_eq(session, &self.session))
    }

    /// Returns the pose of the reference of the end effector.
    ///
    /// # Errors
    /// The cause of the end of the session.
    pub(crate) fn held_pose(&self) -> Result<Isometry3<f64>, MotionError> {
        self.session.check()?;
        let reference = self.reference().ok_or(MotionError::Disengaged)?;
        Ok(reference.pose)
    }

    /// Returns the name of the current goal; `None` once the session has ended.
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

    /// Returns a goal that is set and then held.
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

/// Time without motion after which the arm counts as resting, `[ms]`: as for arrivals of motions.
const SETTLED: u64 = 250;

/// Joint velocity below which the reference counts as resting, `[rad/s]`.
const REFERENCE_REST: f64 = 1e-3;

/// Distance of a joint from its position at the start of the wait beyond which it has moved,
/// `[rad]`.
const MOVED: f64 = 5e-4;

impl fmt::Debug for Arm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Arm")
            .field("robot", self.robot())
            .finish_non_exhaustive()
    }
}
