//! The handle of a connected robot.

use std::fmt;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock, Weak};
use std::time::Duration;

use franka_model::Model;
use franka_proto::{RobotState, Version};
use franka_rt::driver::Record;
use franka_rt::law::Gains;
use franka_rt::lifecycle::{CloseReason, MotionError, Outcome, Unready};
use franka_rt::sched::Granted;
use franka_rt::session::{GoalId, Margin};
use franka_rt::stats::Stats;
use franka_rt::supervision::{Condition, Health};
use franka_rt::thread::{AttachError, CycleReader};
use tokio::sync::{Mutex, broadcast, mpsc, oneshot};
use tokio_util::sync::DropGuard;

use crate::command_channel::Channel;
use crate::end_effector_pose::{pose_at, pose_of};
use crate::geometry_check::GeometryCheck;
use crate::input::{Beginning, EndReply, Input, Replies};
use crate::lease::Lease;
use crate::link::Link;
use crate::progress::Reference;
use crate::state_model::StateModel;
use crate::states::States;
use crate::supervisor::{Events, Supervisor};
use crate::world::{self, Instant, Runtime, timeout_at};

/// Pose of one frame in another, `[m]`. Unless stated otherwise, the pose of the end effector in
/// the base frame, `O_T_EE`.
pub type Pose = nalgebra::Isometry3<f64>;

/// A connected robot.
///
/// This is a cheap handle: all clones share one connection, and may be used from any task or
/// thread. A newer motion supersedes the current one. Dropping the last handle brakes the arm, ends
/// the motion and closes the connection, in the background. [`Robot::shutdown`] does the same and
/// can be awaited. A motion in progress counts as a handle.
///
/// When a connection is lost, everything that belongs to it ends, including the control thread. The
/// remaining handles then report the reason. Handles of a
/// [supervised](crate::connection::Builder::supervise) robot continue with the next connection. If
/// the runtime ends first, the driver does not brake the arm: the robot receives no more commands
/// and stops with a reflex. Await [`Robot::shutdown`] before the program ends.
///
/// Connecting needs a Tokio runtime. Everything else may be called and awaited from anywhere.
#[derive(Clone)]
pub struct Robot {
    shared: Arc<Shared>,
}

/// State that all handles of a robot share.
struct Shared {
    model: Arc<Model>,
    version: Version,
    /// The newest connection.
    link: RwLock<Arc<Link>>,
    supervisor: Arc<Supervisor>,
    /// This lock is held until a setting has its place among the requests, so that no older setting
    /// overtakes it.
    setting: Arc<Mutex<()>>,
    /// Sender to the task that reconnects; `None` without such a task. It is closed when the task
    /// has ended.
    shutdowns: Option<mpsc::UnboundedSender<oneshot::Sender<()>>>,
    /// Runtime of that task and of the bridges.
    runtime: Runtime,
    /// Notifies that task when the last handle is dropped.
    _handles: DropGuard,
    /// Number of goals named so far, over all connections.
    goals: AtomicU64,
    lease: Lease,
}

impl Robot {
    /// Returns the robot of this model and version that `link` connects to. `shutdowns` is the
    /// sender to the task that reconnects, if there is one. `handles` notifies that task when the
    /// last handle is dropped.
    ///
    /// # Panics
    /// Outside a Tokio runtime.
    pub(crate) fn new(
        (model, version): (Arc<Model>, Version),
        link: Arc<Link>,
        supervisor: Arc<Supervisor>,
        (shutdowns, handles): (
            Option<mpsc::UnboundedSender<oneshot::Sender<()>>>,
            DropGuard,
        ),
    ) -> Self {
        Self {
            shared: Arc::new(Shared {
                model,
                version,
                link: RwLock::new(link),
                supervisor,
                setting: Arc::default(),
                shutdowns,
                runtime: Runtime::current(),
                _handles: handles,
                goals: AtomicU64::new(0),
                lease: Lease::default(),
            }),
        }
    }

    /// Returns the newest state. The state may be old: [`Self::health`] reports a silent robot.
    pub fn state(&self) -> RobotState {
        self.link().newest.state()
    }

    /// Returns a receiver that waits for newer states, whether the arm moves or not. It ends with
    /// the connection. For a supervised robot, it continues with the next connection, and ends when
    /// no further connection will follow. To receive every state, use [`Self::state_stream`] or
    /// [`Self::read`].
    ///
    /// The receiver begins with the newest state at the time of the call. As long as a [`States`]
    /// exists, a task is woken for every state; drop it when it is no longer needed.
    pub fn states(&self) -> States {
        let link = self.link();
        let closing = match &self.shared.shutdowns {
            Some(_) => self.shared.supervisor.closing(),
            None => link.channel.closing(),
        };
        States::new(link.newest.changes(), closing.clone())
    }

    /// Returns a channel of records: one for every cycle of the control thread, with its inputs and
    /// outputs. The first records may be up to 50 ms old. A receiver that falls more than two
    /// seconds behind gets the number of records that it missed. The channel closes with the
    /// connection.
    pub fn records(&self) -> broadcast::Receiver<Record> {
        self.link().subscriptions().records()
    }

    /// Returns a reader of every cycle of the control thread from now on, with the record, the
    /// whole state and the time of receipt. Use it in a recorder with its own thread: the cycles
    /// pass through no task, so a busy runtime loses none of them. The ring buffer holds `capacity`
    /// cycles, usually [`CycleFeed::DEFAULT_CAPACITY`](crate::record::CycleFeed::DEFAULT_CAPACITY).
    /// [`CycleReader::lost`] counts the cycles that did not fit. The reader ends with the
    /// connection. The call takes a few milliseconds to allocate the buffer.
    ///
    /// # Errors
    /// Returns [`AttachError`] if `capacity` is out of range, if there are too many readers, or if
    /// there is no connection.
    pub fn cycles(&self, capacity: usize) -> Result<CycleReader, AttachError> {
        let link = self.link();
        if link.has_ended() {
            return Err(AttachError::Ended);
        }
        link.cycles.attach(capacity)
    }

    /// Returns the measured pose of the end effector, `O_T_EE` of the newest state.
    pub fn pose(&self) -> Pose {
        let state = self.state();
        // An invalid pose is replaced by the pose at the joint positions.
        pose_of(&state).unwrap_or_else(|| pose_at(self.model(), &state, state.q))
    }

    /// Returns the pose of the end effector at the joint positions `q`, `[rad]`, with the end
    /// effector of the newest state. If that end effector is not a rigid transformation, the flange
    /// is used instead.
    pub fn pose_at(&self, q: [f64; 7]) -> Pose {
        pose_at(self.model(), &self.state(), q)
    }

    /// Returns the reference of target control: the commanded motion of the newest cycle. Returns
    /// `None` while target control moves nothing.
    pub fn reference(&self) -> Option<Reference> {
        let newest = self.link().course.reference()?;
        Some(Reference {
            time: newest.time,
            q: newest.q,
            dq: newest.dq,
            ddq: newest.ddq,
            pose: self.pose_at(newest.q),
            guards: newest.guards,
        })
    }

    /// Returns the model of the connected arm, with which the driver computes. A Franka Research 3
    /// sends a description of itself ([`Robot::urdf`]). The masses and limits come from this
    /// description, unless the feature `urdf` is off or
    /// [`Builder::nominal_model`](crate::connection::Builder::nominal_model) is chosen. A Franka
    /// Emika Robot sends no description. Its model, [`Model::fer`], contains the constants with
    /// which its own library is known to compute. In both models, the lengths of the upper arm and
    /// the forearm are the ones with which the robot computes its poses: see
    /// [`Self::geometry_check`].
    pub fn model(&self) -> &Model {
        &self.shared.model
    }

    /// Returns the comparison of the model with the poses that the robot reported when this
    /// connection was made, and the resulting lengths.
    pub fn geometry_check(&self) -> GeometryCheck {
        self.link().geometry
    }

    /// Returns [`Self::model`] in a form for control functions: it takes the end effector and the
    /// load from a state.
    pub fn state_model(&self) -> StateModel {
        StateModel::new(self.shared.model.clone(), self.shared.version)
    }

    /// Returns the stability margin of `gains`: how far an arm of this model, in its present state,
    /// is from oscillating. A motion whose gains have less than [`Margin::WANTED`] begins with a
    /// warning (`tracing`). Returns `None` if the gains are out of bounds, or if the robot's tool
    /// is not a rigid body.
    pub fn margin(&self, gains: &Gains) -> Option<Margin> {
        Margin::of(gains, self.model(), &self.state(), self.version())
    }

    /// Returns the protocol version of the connection.
    pub fn version(&self) -> Version {
        self.shared.version
    }

    /// Returns the address of the robot.
    pub fn address(&self) -> SocketAddr {
        self.link().address
    }

    /// Returns the lease of the arm, with which a service lets one client at a time move the arm.
    /// The lease outlives connections.
    pub fn lease(&self) -> &Lease {
        &self.shared.lease
    }

    /// Returns live statistics of the control thread: counters, histograms, the worst cycle and the
    /// current motion. The thread itself writes them, so they are up to date even if the runtime is
    /// busy. Each connection has its own thread and counters.
    pub fn stats(&self) -> Arc<Stats> {
        self.link().stats.clone()
    }

    /// Returns what the operating system granted to the control thread, and what it refused under
    /// [`Realtime::Ignore`](crate::Realtime).
    pub fn granted(&self) -> Arc<Granted> {
        self.link().granted.clone()
    }

    /// Brakes everything that moves. Resolves when the motion has ended and a state shows that the
    /// arm rests and that the robot runs no motion. Resolves at once if nothing moves. The motion
    /// itself resolves as [`MotionError::Stopped`] as soon as the stop is accepted, while the arm
    /// still brakes.
    ///
    /// If several callers stop the arm, it brakes once, and all callers get the same outcome. If
    /// the driver no longer waits for a motion but the robot still runs it, each call sends another
    /// stop request. A stop does not last: a motion that another task begins later moves the arm
    /// again. If that happens before the arm was seen to rest, the stop resolves as
    /// [`MotionError::Superseded`]. For a stop that lasts, use [`Self::latch_stop`].
    ///
    /// If a person keeps the arm moving by hand, the driver sends the robot a stop request after
    /// two seconds. The robot then has four seconds to end the motion, and two more to show an arm
    /// at rest. Therefore a stop resolves within eight seconds while the link stays up, and usually
    /// within half a second.
    ///
    /// If the connection to a [supervised](crate::connection::Builder::supervise) robot is lost
    /// meanwhile, the stop waits up to 10 s for the next connection and then stops the robot.
    ///
    /// # Errors
    /// Returns the error of the motion if the motion ended in any other way, for example by a
    /// reflex. Also returns:
    ///
    /// - [`MotionError::Protocol`] if the robot does not end the motion within the times above;
    /// - [`MotionError::NotAtRest`] if the motion has ended but the arm still moves, for example
    ///   because a person guides it by hand;
    /// - [`MotionError::Superseded`] if another motion began before the arm was seen to rest;
    /// - [`MotionError::LinkLost`] if the robot has been silent for the link timeout, and
    ///   [`MotionError::ConnectionClosed`] if there is no connection. In both cases it is unknown
    ///   whether the arm rests.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the stop brakes the arm even if the future is then dropped.
    /// It then does not wait for a new connection.
    pub async fn stop(&self) -> Result<(), MotionError> {
        self.brake(false).await
    }

    /// Stops as [`Self::stop`] does, and latches the stop. Until [`Self::release_stop`], every
    /// motion, session, control function and goal of any handle is refused as
    /// [`MotionError::NotReady`] with [`Unready::StopLatched`](crate::error::Unready::StopLatched).
    /// A motion that waits for the robot is cancelled. The latch outlives connections, and stays
    /// regardless of the outcome of the stop. Parameters can still be set, and the robot can be
    /// recovered; neither moves anything.
    ///
    /// The latch belongs to this program, and is no safety function: it is gone when the program
    /// ends.
    ///
    /// # Errors
    /// Returns the errors of [`Self::stop`], except [`MotionError::Superseded`].
    ///
    /// # Cancel safety
    /// Once the future has been polled, the stop is latched and the arm is braked, even if the
    /// future is then dropped.
    pub async fn latch_stop(&self) -> Result<(), MotionError> {
        self.brake(true).await
    }

    /// Releases a [latched](Self::latch_stop) stop, so that motions are accepted again. The arm
    /// does not move. Returns true if a stop was latched.
    pub fn release_stop(&self) -> bool {
        self.shared.supervisor.release_stop()
    }

    /// True if a stop is [latched](Self::latch_stop).
    pub fn is_stop_latched(&self) -> bool {
        self.shared.supervisor.is_stop_latched()
    }

    async fn brake(&self, latches: bool) -> Result<(), MotionError> {
        let mut outcome = self.brake_once(latches).await;
        if self.shared.shutdowns.is_none() {
            return outcome;
        }
        let end = world::now() + RECONNECTED_WITHIN;
        while let Err(MotionError::ConnectionClosed { .. } | MotionError::LinkLost { .. }) = outcome
        {
            // The caller may await this without a runtime.
            let connected = self.shared.runtime.spawn(connected(self.health(), end));
            if !connected.await.unwrap_or(false) {
                break;
            }
            // This never latches the stop, nor releases a stop that another call has latched.
            outcome = self.brake_once(false).await;
        }
        outcome
    }

    /// Brakes over the newest connection.
    async fn brake_once(&self, latches: bool) -> Result<(), MotionError> {
        let (ended, outcome) = oneshot::channel();
        let goal = self.next_goal();
        let link = self.send(Input::Stop {
            goal,
            latches,
            ended,
        });
        match outcome.await {
            Ok(outcome) => outcome.map(|_| ()),
            Err(_) if link.has_ended() => Err(link.closed()),
            // The newest state shows an arm at rest.
            Err(_) => match link.silence() {
                Some(silence) => Err(MotionError::LinkLost { silence }),
                None => Ok(()),
            },
        }
    }

    /// Brakes the arm, ends the motion and the control thread, and closes the connection. Every
    /// other handle is then closed. Call [`Self::stop`] first if you need to know whether the arm
    /// rests.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the shutdown continues in the background even if the future
    /// is then dropped.
    pub async fn shutdown(&self) {
        let (reply, ended) = oneshot::channel();
        match &self.shared.shutdowns {
            // The send fails if the task has ended.
            Some(shutdowns) => drop(shutdowns.send(reply)),
            None => drop(self.send(Input::Shutdown { ended: reply })),
        }
        // An error means that the bridge has ended already.
        let _ = ended.await;
    }

    /// Waits until the connection has ended, and returns the reason. Every motion has resolved by
    /// then, or is about to resolve. For a supervised robot, waits until the supervisor has given
    /// up or this program has closed the connection.
    ///
    /// # Cancel safety
    /// Nothing happens if the future is dropped.
    pub async fn closed(&self) -> CloseReason {
        match &self.shared.shutdowns {
            Some(shutdowns) => {
                shutdowns.closed().await;
                self.shared.supervisor.closing().reason()
            }
            None => self.link().ended().await,
        }
    }

    /// Returns the events of the robot from now on. They report connections lost and made, reflexes
    /// with their diagnosis, recoveries, the user stop, guiding, brakes, motions and loads. The
    /// stream ends when the connection has ended and no new connection will follow. A robot that is
    /// not supervised reports events, too. Changes that only a state shows are noticed within 50
    /// ms.
    pub fn events(&self) -> Events {
        self.shared.supervisor.events()
    }

    /// Returns a receiver of the robot's health: whether it accepts motions, why not, and how long
    /// reconnecting and recovering took. It ends as [`Self::events`] does.
    pub fn health(&self) -> States<Health> {
        let supervisor = &self.shared.supervisor;
        States::new(supervisor.health(), supervisor.closing().clone())
    }

    /// Approves or rejects the recovery from the reflex with this number, if the
    /// [`Policy`](crate::supervision::Policy) asks before a recovery. Returns true if the
    /// supervisor was waiting for the answer. If it was not, does nothing and returns false, for
    /// example because the robot has left this reflex, or has a newer error. The number is in the
    /// event, and in [`Health::reflex`].
    ///
    /// The answer moves nothing. [`Self::recover`] also recovers a robot, under any policy.
    pub fn agree(&self, reflex: u64, agreed: bool) -> bool {
        self.shared.supervisor.agree(reflex, agreed)
    }

    pub(crate) fn supervisor(&self) -> &Arc<Supervisor> {
        &self.shared.supervisor
    }

    pub(crate) fn setting(&self) -> &Arc<Mutex<()>> {
        &self.shared.setting
    }

    pub(crate) fn downgrade(&self) -> WeakRobot {
        WeakRobot(Arc::downgrade(&self.shared))
    }

    /// Replaces the connection, which has ended, by `link`.
    pub(crate) fn set_link(&self, link: Arc<Link>) {
        let newest = self.shared.link.write();
        let mut newest = newest.unwrap_or_else(PoisonError::into_inner);
        let before = std::mem::replace(&mut *newest, link);
        drop(newest);
        drop(before);
    }

    #[cfg(feature = "metrics")]
    pub(crate) fn tally(&self) -> crate::tally::Tally {
        self.shared.supervisor.tally()
    }

    /// Returns the newest connection. Call this once if you need several values of the same
    /// connection.
    pub(crate) fn link(&self) -> Arc<Link> {
        let link = self.shared.link.read();
        // Nothing can panic while the lock is held.
        link.unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(crate) fn channel(&self) -> Channel {
        self.link().channel.clone()
    }

    /// Returns an identifier that no earlier goal of this robot has.
    pub(crate) fn next_goal(&self) -> GoalId {
        GoalId(self.shared.goals.fetch_add(1, Ordering::Relaxed) + 1)
    }

    /// Makes the bridge begin a motion. Returns the receiver of its outcome; see
    /// [`unserved`](crate::input::unserved).
    pub(crate) fn begin(&self, motion: Beginning) -> oneshot::Receiver<Outcome> {
        let (ended, outcome) = oneshot::channel();
        let replies = Replies {
            began: None,
            ended: EndReply::One(ended),
        };
        self.send(Input::Begin { motion, replies });
        outcome
    }

    /// Cancels the motion with this identifier.
    pub(crate) fn cancel(&self, goal: GoalId) {
        self.send(Input::Cancel {
            goal,
            refused: None,
        });
    }

    /// Sends `input` to the bridge of the newest connection, or to the motion that waits for a
    /// connection. Returns the newest connection.
    pub(crate) fn send(&self, input: Input) -> Arc<Link> {
        self.shared.supervisor.pass(input, || self.link())
    }
}

/// Waits until the robot is connected and sends states. First pauses, so that a connection that was
/// just lost is shown as lost. Returns false if `end` comes first.
async fn connected(mut health: States<Health>, end: Instant) -> bool {
    world::sleep(SHOWN_WITHIN).await;
    let away = [Unready::Disconnected, Unready::Silent].map(Condition::Unready);
    let there = health.wait_for(|health| !away.contains(&health.condition));
    match timeout_at(end, there).await {
        Ok(Ok(health)) => health.condition != Condition::Closed,
        _ => false,
    }
}

/// Time for which a stop waits for the next connection.
const RECONNECTED_WITHIN: Duration = Duration::from_secs(10);

/// Time in which the bridge reports a silent robot: it checks every 50 ms.
const SHOWN_WITHIN: Duration = Duration::from_millis(100);

/// A weak reference to a robot, which does not keep the connection open.
#[derive(Clone)]
pub(crate) struct WeakRobot(Weak<Shared>);

impl WeakRobot {
    pub(crate) fn upgrade(&self) -> Option<Robot> {
        self.0.upgrade().map(|shared| Robot { shared })
    }
}

impl fmt::Debug for WeakRobot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("WeakRobot").field(&self.upgrade()).finish()
    }
}

impl fmt::Debug for Robot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Robot")
            .field("address", &self.address())
            .field("version", &self.shared.version)
            .finish_non_exhaustive()
    }
}
