//! What handles and motions ask of the bridge, and how it answers.

use franka_rt::lifecycle::{MotionError, MotionReport, Tuning};
use franka_rt::session::{Chunk, Goal, GoalError, GoalId, Target};
use tokio::sync::{mpsc, oneshot, watch};

use crate::motion::Work;
use crate::publish::Subscriptions;

/// How a motion ended, on its way to whoever awaits it.
pub(crate) type Outcome = Result<MotionReport, MotionError>;

/// What handles and motions ask of the bridge.
#[derive(Debug)]
pub(crate) enum Input {
    Begin {
        work: Work,
        waiting: Waiting,
    },
    /// `taken` hears whether the goal is still the newest.
    Update {
        goal: GoalId,
        target: Target,
        taken: oneshot::Sender<Result<bool, GoalError>>,
    },
    /// A goal that nobody awaits, for the session `id`; `taken` hears whether it is accepted. So
    /// does that of the next.
    Set {
        id: GoalId,
        goal: Box<Goal>,
        taken: oneshot::Sender<Result<(), MotionError>>,
    },
    Chunk {
        id: GoalId,
        goal: Box<Goal>,
        chunk: Box<Chunk>,
        taken: oneshot::Sender<Result<(), MotionError>>,
    },
    Tune {
        id: GoalId,
        tuning: Box<Tuning>,
        taken: oneshot::Sender<Result<(), MotionError>>,
    },
    Disengage {
        id: GoalId,
    },
    Close {
        goal: GoalId,
    },
    Cancel {
        goal: GoalId,
    },
    Stop {
        goal: GoalId,
        done: oneshot::Sender<Outcome>,
    },
    /// Brake, finish, close; `done` hears when the thread has ended.
    Shutdown {
        done: oneshot::Sender<()>,
    },
}

/// Whoever awaits something that was begun.
#[derive(Debug)]
pub(crate) struct Waiting {
    /// Hears that a program or a session runs.
    pub(crate) began: Option<oneshot::Sender<()>>,
    /// Hears how it ended.
    pub(crate) done: Done,
}

/// Who hears how something ended.
#[derive(Debug)]
pub(crate) enum Done {
    /// Whoever began it.
    One(oneshot::Sender<Outcome>),
    /// Everybody who cares.
    All(watch::Sender<Option<Outcome>>),
}

impl Done {
    /// Nobody listens to what was dropped or detached.
    pub(crate) fn tell(self, outcome: Outcome) {
        match self {
            Self::One(done) => drop(done.send(outcome)),
            Self::All(done) => drop(done.send_replace(Some(outcome))),
        }
    }
}

/// The ways into the bridge, and the one way out of it that others subscribe to.
#[derive(Clone, Debug)]
pub(crate) struct Inputs {
    /// Unbounded, since dropping a motion must be able to send; what awaits an answer bounds
    /// itself.
    pub(crate) queue: mpsc::UnboundedSender<Input>,
    pub(crate) subscriptions: Subscriptions,
}
