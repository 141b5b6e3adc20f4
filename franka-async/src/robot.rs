//! The handle that programs hold.

use std::fmt;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use franka_model::{EndEffector, Frame, Model, transform};
use franka_proto::{MoveRequest, RobotState, Version};
use franka_rt::driver::{Program, Record};
use franka_rt::sched::Granted;
use franka_rt::session::{Goal, GoalId, OnArrival, Target};
use franka_rt::stats::Stats;
use franka_rt::thread::Lender;
use tokio::sync::{broadcast, oneshot, watch};

use crate::builder::Builder;
use crate::channel::Channel;
use crate::endpoint::Endpoint;
use crate::input::{Done, Input, Inputs, Outcome, Waiting};
use crate::motion::Work;
use crate::newest::Newest;
use crate::publish::Subscriptions;
use crate::{ConnectError, Follow, Motion, MotionError, Pose};

/// A connected robot.
///
/// A cheap handle: clones share one connection, from any task or thread. A newer motion supersedes
/// the one that runs. Dropping the last handle brakes the arm, ends the motion and closes the
/// connection, in the background; [`Robot::shutdown`] does the same and can be awaited. Motions in
/// progress are handles too.
///
/// A connection that is lost ends everything that belongs to it, control thread included; the
/// handles that are left then say why. If the runtime ends first, nobody is left to brake: the
/// robot then misses its commands and stops by itself, with a reflex. Await [`Robot::shutdown`]
/// before the program ends.
///
/// Connecting needs a Tokio runtime. Everything else may be called and awaited from anywhere.
#[derive(Clone)]
pub struct Robot {
    shared: Arc<Shared>,
}

/// What all handles of a connection share.
pub(crate) struct Shared {
    pub(crate) model: Arc<Model>,
    pub(crate) version: Version,
    pub(crate) address: SocketAddr,
    pub(crate) inputs: Inputs,
    pub(crate) channel: Channel,
    pub(crate) newest: Newest,
    pub(crate) stats: Arc<Stats>,
    pub(crate) granted: Granted,
    pub(crate) lender: Lender,
    /// How many goals were named so far.
    pub(crate) goals: AtomicU64,
}

impl Robot {
    pub(crate) fn new(shared: Shared) -> Self {
        Self {
            shared: Arc::new(shared),
        }
    }

    /// Connects with the options that [`Robot::builder`] begins with.
    ///
    /// # Errors
    /// [`ConnectError`]. Without a real-time kernel this is [`ConnectError::Realtime`]: see
    /// [`Builder::realtime`].
    ///
    /// # Cancel safety
    /// Dropping the future closes whatever was opened.
    pub async fn connect(endpoint: impl Into<Endpoint>) -> Result<Self, ConnectError> {
        Self::builder(endpoint).connect().await
    }

    /// Options of a connection to the robot at `endpoint`.
    pub fn builder(endpoint: impl Into<Endpoint>) -> Builder {
        Builder::new(endpoint.into())
    }

    /// The newest state.
    pub fn state(&self) -> RobotState {
        self.shared.newest.state()
    }

    /// The newest state as it changes, in motion or not. Closes when the connection does. For every
    /// state, see [`Self::state_stream`] and [`Self::read`].
    ///
    /// It begins with the newest state of now, which is no change. As long as anybody has one of
    /// these, a task is woken for every state; drop it when it is not needed.
    ///
    /// Do not hold its borrow for long: the task that publishes states waits for it. Control does
    /// not. Nor call this while holding one: it waits too, for the same reason.
    pub fn states(&self) -> watch::Receiver<RobotState> {
        self.shared.newest.changes()
    }

    /// What every cycle of the control thread saw and did, one record per state; the first ones may
    /// be of cycles up to 50 ms ago. A listener that lags more than two seconds behind is told how
    /// many it missed. Closes when the connection does.
    pub fn records(&self) -> broadcast::Receiver<Record> {
        self.subscriptions().records()
    }

    /// The measured pose of the end effector, `O_T_EE` of the newest state.
    pub fn pose(&self) -> Pose {
        let state = self.state();
        // What the robot says, unless it is no pose; then what its joints say.
        transform::isometry_from_array(&state.O_T_EE).unwrap_or_else(|| self.pose_at(state.q))
    }

    /// The pose that the end effector has at the joint positions `q`, `[rad]`, with the end
    /// effector of the newest state. One that is not a rigid transformation counts as the flange.
    pub fn pose_at(&self, q: [f64; 7]) -> Pose {
        let ee = transform::isometry_from_array(&self.state().F_T_EE).unwrap_or_default();
        let ee = EndEffector {
            f_t_ee: transform::matrix(&ee),
            ..EndEffector::default()
        };
        let pose = self.model().pose(Frame::EndEffector, &q.into(), &ee);
        transform::isometry(&pose).unwrap_or_default()
    }

    /// The model of the connected arm, which control computes with. A Franka Research 3 describes
    /// itself: its masses and limits are those of the description ([`Robot::urdf`]), unless the
    /// feature `urdf` is off or [`Builder::nominal_model`] is chosen. A Franka Emika Robot does
    /// not: it has the constants that its own library is known to compute with, [`Model::fer`].
    pub fn model(&self) -> &Model {
        &self.shared.model
    }

    /// The protocol version that the robot speaks.
    pub fn version(&self) -> Version {
        self.shared.version
    }

    /// Where the robot is.
    pub fn address(&self) -> SocketAddr {
        self.shared.address
    }

    /// Counters and histograms of the control thread, its worst cycle and the motion that runs,
    /// live: written by the thread itself, and to be read whatever the runtime is busy with.
    pub fn stats(&self) -> &Stats {
        &self.shared.stats
    }

    /// What the operating system granted the control thread, and what it refused under
    /// [`Realtime::Ignore`](crate::Realtime).
    pub fn granted(&self) -> &Granted {
        &self.shared.granted
    }

    /// A motion of the end effector to `pose` in the base frame: a straight line and a rotation
    /// about one axis if it begins at rest. The arm is compliant on the way, see
    /// [`Motion::stiffness`].
    pub fn move_to(&self, pose: Pose) -> Motion {
        self.motion(Target::Pose(pose))
    }

    /// A motion of the joints to `q`, `[rad]`; all joints arrive together.
    pub fn move_joints(&self, q: [f64; 7]) -> Motion {
        self.motion(Target::Joints(q))
    }

    fn motion(&self, target: Target) -> Motion {
        let limits = self.model().joint_limits();
        let goal = Goal::new(self.next_goal(), target, OnArrival::ReportAndFinish, limits);
        Motion::new(self.clone(), None, goal)
    }

    /// Follows the newest of the targets that `targets` shows, poses or joint positions `[rad]`,
    /// until the sender is dropped, and then comes to rest at the last one. The sender sets its own
    /// pace, and may step as far as it likes: the arm moves within its budget.
    pub fn follow<T: Into<Target> + Clone + Send + Sync + 'static>(
        &self,
        targets: watch::Receiver<T>,
    ) -> Follow {
        Follow::watch(self.clone(), None, targets)
    }

    /// Brakes whatever moves and resolves when the arm rests and the motion has ended; at once if
    /// nothing moves. The motion itself resolves as [`MotionError::Stopped`].
    ///
    /// # Errors
    /// [`MotionError`] if the motion ended otherwise, for instance by a reflex;
    /// [`MotionError::Superseded`] by a goal that came after the stop;
    /// [`MotionError::ConnectionClosed`] if there is no connection, so that nobody can say whether
    /// the arm rests.
    ///
    /// # Cancel safety
    /// Once polled, the arm is braked even if the future is dropped.
    pub async fn stop(&self) -> Result<(), MotionError> {
        let (done, outcome) = oneshot::channel();
        let goal = self.next_goal();
        self.send(Input::Stop { goal, done });
        match outcome.await {
            Ok(outcome) => outcome.map(|_| ()),
            Err(_) if self.shared.inputs.queue.is_closed() => self.closed().map(|_| ()),
            // Nothing moved.
            Err(_) => Ok(()),
        }
    }

    /// Brakes, ends the motion, ends the control thread and closes the connection. Every other
    /// handle is then closed.
    ///
    /// # Cancel safety
    /// Once polled, it goes on in the background.
    pub async fn shutdown(&self) {
        let (done, ended) = oneshot::channel();
        self.send(Input::Shutdown { done });
        // An error means that the bridge has ended already.
        let _ = ended.await;
    }

    pub(crate) fn subscriptions(&self) -> &Subscriptions {
        &self.shared.inputs.subscriptions
    }

    pub(crate) fn channel(&self) -> &Channel {
        &self.shared.channel
    }

    pub(crate) fn lender(&self) -> &Lender {
        &self.shared.lender
    }

    /// A name for a goal that was never used before.
    pub(crate) fn next_goal(&self) -> GoalId {
        GoalId(self.shared.goals.fetch_add(1, Ordering::Relaxed) + 1)
    }

    /// Has the bridge begin something. Whoever waits for the answer hears nothing if the bridge has
    /// ended.
    pub(crate) fn begin(&self, work: Work) -> oneshot::Receiver<Outcome> {
        let (done, outcome) = oneshot::channel();
        let waiting = Waiting {
            began: None,
            done: Done::One(done),
        };
        self.send(Input::Begin { work, waiting });
        outcome
    }

    /// Has the bridge begin a program, and waits until it runs. Returns where its end will be
    /// heard. Dropping the future has the robot stop.
    ///
    /// # Errors
    /// What ended the motion before it ran.
    pub(crate) async fn run(
        &self,
        id: GoalId,
        program: Program,
        request: MoveRequest,
    ) -> Result<oneshot::Receiver<Outcome>, MotionError> {
        let (begin, began) = oneshot::channel();
        let (done, outcome) = oneshot::channel();
        let request = Box::new(request);
        let work = Work::Program {
            id,
            program,
            request,
        };
        let waiting = Waiting {
            began: Some(begin),
            done: Done::One(done),
        };
        self.send(Input::Begin { work, waiting });
        let mut stop = StopOnDrop(Some((self, id)));
        if began.await.is_err() {
            // It never will: the end has the reason.
            let ended = outcome.await.unwrap_or_else(|_| self.closed());
            stop.0 = None;
            return Err(ended.err().unwrap_or(MotionError::Stopped));
        }
        stop.0 = None;
        Ok(outcome)
    }

    /// Takes back what was begun under this name.
    pub(crate) fn cancel(&self, goal: GoalId) {
        self.send(Input::Cancel { goal });
    }

    /// Sends to the bridge. One that has ended drops the input, and with it the sender of its
    /// answer, which is how whoever waits hears of it.
    pub(crate) fn send(&self, input: Input) {
        let _ = self.shared.inputs.queue.send(input);
    }

    /// How a motion ends that nobody took, or whose end nobody saw.
    pub(crate) fn closed(&self) -> Outcome {
        Err(MotionError::ConnectionClosed {
            reason: self.shared.channel.end_reason().to_owned(),
        })
    }
}

impl fmt::Debug for Robot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Robot")
            .field("address", &self.shared.address)
            .field("version", &self.shared.version)
            .finish_non_exhaustive()
    }
}

/// Has the robot stop a program whose beginning nobody awaits any more.
struct StopOnDrop<'a>(Option<(&'a Robot, GoalId)>);

impl Drop for StopOnDrop<'_> {
    fn drop(&mut self) {
        if let Some((robot, id)) = self.0.take() {
            robot.cancel(id);
        }
    }
}
