//! What handles and motions ask of the bridge, and how it answers.

use franka_proto::MoveRequest;
use franka_rt::control::Callback;
use franka_rt::driver::Program;
use franka_rt::lifecycle::{Engagement, MotionError, MotionReport, Tuning};
use franka_rt::session::{Chunk, Goal, GoalError, GoalId, Target};
use franka_rt::together::StartTicket;
use tokio::sync::{mpsc, oneshot, watch};

use crate::publish::Subscriptions;

/// How a motion ended.
pub(crate) type Outcome = Result<MotionReport, MotionError>;

/// A motion to begin.
#[derive(Debug)]
pub(crate) enum NewMotion {
    Goal {
        goal: Box<Goal>,
        ticket: Option<StartTicket>,
        /// The session that the goal is for; `None` begins a motion of its own.
        within: Option<GoalId>,
    },
    Session {
        goal: Box<Goal>,
        engagement: Engagement,
    },
    Function {
        id: GoalId,
        callback: Box<Callback>,
        request: Box<MoveRequest>,
        ticket: Option<StartTicket>,
    },
    Program {
        id: GoalId,
        program: Program,
        request: Box<MoveRequest>,
    },
    /// Options that are not accepted.
    Refused { id: GoalId, error: GoalError },
}

impl NewMotion {
    /// Returns the name under which the motion is cancelled and resolved.
    pub(crate) fn id(&self) -> GoalId {
        match self {
            Self::Goal { goal, .. } | Self::Session { goal, .. } => goal.id,
            Self::Function { id, .. } | Self::Program { id, .. } | Self::Refused { id, .. } => *id,
        }
    }
}

/// What handles and motions ask of the bridge.
#[derive(Debug)]
pub(crate) enum Input {
    Begin {
        motion: NewMotion,
        replies: Replies,
    },
    /// Moves the target of a goal. The reply is whether the goal is still the newest.
    Update {
        goal: GoalId,
        target: Target,
        taken: oneshot::Sender<Result<bool, GoalError>>,
    },
    /// Sets a goal without an outcome, for the session `id`. The reply, as of the next two, is
    /// whether it is accepted.
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
        ended: oneshot::Sender<Outcome>,
    },
    /// Brakes, finishes and closes. The reply comes when the control thread has ended.
    Shutdown {
        ended: oneshot::Sender<()>,
    },
}

/// Where to report on something that was begun.
#[derive(Debug)]
pub(crate) struct Replies {
    /// Receives the beginning of a program or a session.
    pub(crate) began: Option<oneshot::Sender<()>>,
    /// Receives the outcome.
    pub(crate) ended: EndReply,
}

/// Receivers of an outcome.
#[derive(Debug)]
pub(crate) enum EndReply {
    /// The future of the motion.
    One(oneshot::Sender<Outcome>),
    /// Every handle of the session.
    All(watch::Sender<Option<Outcome>>),
}

impl EndReply {
    /// Sends the outcome. What was dropped or detached has no receiver.
    pub(crate) fn send(self, outcome: Outcome) {
        match self {
            Self::One(ended) => drop(ended.send(outcome)),
            Self::All(ended) => drop(ended.send_replace(Some(outcome))),
        }
    }
}

/// The sending end of the bridge's inbox, and what the bridge publishes.
#[derive(Clone, Debug)]
pub(crate) struct BridgeHandle {
    /// Unbounded, since dropping a motion must be able to send; callers that await an answer bound
    /// themselves.
    pub(crate) inbox: mpsc::UnboundedSender<Input>,
    pub(crate) subscriptions: Subscriptions,
}
