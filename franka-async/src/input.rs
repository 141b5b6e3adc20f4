//! Inputs of handles and motions to the bridge, and the answers of the bridge.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_model::Model;
use franka_rt::lifecycle::{CloseReason, MotionError, NewMotion, Outcome, Tuning};
use franka_rt::session::{Chunk, Goal, GoalError, GoalId, Target, Waypoint};
use tokio::sync::{mpsc, oneshot, watch};

use crate::destination::Destination;
use crate::kept_tuning::KeptTuning;
use crate::options::GoalOptions;
use crate::publish::Subscriptions;

/// Input of handles and motions to the bridge.
#[derive(Debug)]
pub(crate) enum Input {
    Begin {
        motion: Beginning,
        replies: Replies,
    },
    /// Changes the target of a goal. The reply is true if the goal is still the newest one.
    Update {
        goal: GoalId,
        target: Target,
        taken: oneshot::Sender<Result<bool, GoalError>>,
    },
    /// Begins a motion whose outcome is not awaited. The reply reports whether the motion is
    /// accepted.
    Set {
        motion: Beginning,
        taken: oneshot::Sender<Result<(), MotionError>>,
    },
    /// Begins the newest waiting motion, if there is one, as `Set` does. No caller waits for a
    /// reply.
    SetNewest {
        waiting: Waiting,
    },
    /// Sends a chunk to the session `id`.
    Chunk {
        id: GoalId,
        goal: Box<Goal>,
        chunk: Box<Chunk>,
        taken: oneshot::Sender<Result<(), MotionError>>,
    },
    Tune {
        id: GoalId,
        tuning: Box<Tuning>,
        /// Storage for accepted tuning, for later goals.
        kept: KeptTuning,
        taken: oneshot::Sender<Result<(), MotionError>>,
    },
    /// Replies when all earlier inputs have been processed.
    Await {
        taken: oneshot::Sender<Result<(), MotionError>>,
    },
    Disengage {
        id: GoalId,
    },
    Close {
        goal: GoalId,
    },
    Pause {
        goal: GoalId,
        paused: bool,
    },
    Cancel {
        goal: GoalId,
        /// The reason why a target was refused, if the goal is cancelled for that reason.
        refused: Option<GoalError>,
    },
    Stop {
        goal: GoalId,
        /// True if motions are refused after the stop until it is released.
        latches: bool,
        ended: oneshot::Sender<Outcome>,
    },
    /// Brakes, ends the motion, and closes the connection. The reply comes when the control thread
    /// has ended.
    Shutdown {
        ended: oneshot::Sender<()>,
    },
    /// Closes the connection for this reason.
    Lose {
        reason: CloseReason,
    },
}

/// A motion that should begin.
#[derive(Debug)]
pub(crate) struct Beginning {
    pub(crate) motion: NewMotion,
    /// Destination of the goal, if it depends on the present poses.
    pub(crate) destination: Option<Box<Destination>>,
    /// Waypoints of the path.
    pub(crate) path: Option<Arc<[Waypoint]>>,
    /// Reason why the motion must not begin: the arm cannot move to the target in a straight line.
    pub(crate) refused: Option<GoalError>,
    /// Options of a motion of the joints that replaces the straight line in that case.
    pub(crate) joint_fallback: Option<Box<GoalOptions>>,
}

impl Beginning {
    /// Sets `posture` in the goal of the motion.
    pub(crate) fn lead(&mut self, posture: Option<[f64; 7]>) {
        if let NewMotion::Goal { goal, .. } = &mut self.motion {
            goal.posture = posture;
        }
    }

    /// Replaces the straight line by a motion of the joints to `q`, `[rad]`, if the options allow
    /// this. If they do not, the motion is refused with `error`.
    pub(crate) fn lead_joints(&mut self, q: [f64; 7], error: GoalError, model: &Model) {
        let (NewMotion::Goal { goal, .. }, Some(options)) =
            (&mut self.motion, &self.joint_fallback)
        else {
            self.refused = Some(error);
            return;
        };
        let limits = model.joint_limits();
        let joints = Goal::new(goal.id, Target::Joints(q), goal.on_arrival, limits);
        match options.apply(joints, model) {
            Ok(joints) => (**goal, self.destination) = (joints, None),
            Err(error) => self.refused = Some(error),
        }
    }
}

impl From<NewMotion> for Beginning {
    fn from(motion: NewMotion) -> Self {
        Self {
            motion,
            destination: None,
            path: None,
            refused: None,
            joint_fallback: None,
        }
    }
}

/// The newest motion that no caller waits for and that the bridge has not begun yet. Only one input
/// at a time is queued, regardless of the number of motions that are put here.
#[derive(Clone, Debug, Default)]
pub(crate) struct Waiting(Arc<Mutex<Option<Box<Beginning>>>>);

impl Waiting {
    /// Replaces the waiting motion. Returns true if none was waiting.
    pub(crate) fn put(&self, motion: Beginning) -> bool {
        self.lock().replace(Box::new(motion)).is_none()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.lock().is_none()
    }

    /// Returns the result of `look` on the waiting motion; `None` without one.
    #[cfg(feature = "record")]
    pub(crate) fn peek<T>(&self, look: impl FnOnce(&Beginning) -> T) -> Option<T> {
        self.lock().as_deref().map(look)
    }

    pub(crate) fn take(&self) -> Option<Beginning> {
        self.lock().take().map(|motion| *motion)
    }

    fn lock(&self) -> MutexGuard<'_, Option<Box<Beginning>>> {
        // Nothing can panic while the lock is held.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the outcome of a motion that the bridge never answered, which happens only if its
/// runtime drops the bridge.
pub(crate) fn unserved<E>(_: E) -> Outcome {
    let reason = CloseReason::RuntimeEnded;
    Err(MotionError::ConnectionClosed { reason })
}

/// Receivers of reports on a program, a session or a motion.
#[derive(Debug)]
pub(crate) struct Replies {
    /// Receives a message when a program or a session has begun.
    pub(crate) began: Option<oneshot::Sender<()>>,
    pub(crate) ended: EndReply,
}

/// Receivers of an outcome.
#[derive(Debug)]
pub(crate) enum EndReply {
    /// The future of the motion.
    One(oneshot::Sender<Outcome>),
    /// All handles of the session.
    All(watch::Sender<Option<Outcome>>),
}

impl EndReply {
    /// True if no future waits for the outcome.
    pub(crate) fn is_closed(&self) -> bool {
        match self {
            Self::One(ended) => ended.is_closed(),
            Self::All(ended) => ended.is_closed(),
        }
    }

    /// Sends the outcome. If the motion was dropped or detached, no one receives the outcome.
    pub(crate) fn send(self, outcome: Outcome) {
        match self {
            Self::One(ended) => drop(ended.send(outcome)),
            Self::All(ended) => drop(ended.send_replace(Some(outcome))),
        }
    }
}

/// Sender to the inbox of the bridge, and receivers of what the bridge publishes.
#[derive(Clone, Debug)]
pub(crate) struct BridgeHandle {
    /// Inbox of the bridge. It is unbounded, because dropping a motion must be able to send.
    /// Callers that await an answer limit themselves.
    pub(crate) inbox: mpsc::UnboundedSender<Input>,
    pub(crate) subscriptions: Subscriptions,
}
