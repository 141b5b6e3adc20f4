//! Outcome of a motion: the value that its future resolves with. `franka_diagnosis` finds the
//! reason why the robot ended it.

use core::fmt;
use core::time::Duration;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::{
    ControlFailure, Errors, MoveStatus, Refusal, RequestError, RobotMode, Status, Violation,
};

use super::{CloseReason, Unready};
use crate::driver::{Commander, ControlLog, Ended};
use crate::session::{GoalError, Lapse, PathError, PoseError, Reacted, Shortfall};
use crate::shaping::InvalidCommand;
use crate::stats::{CycleTimes, MotionStatistics, MotionTimes, Quantiles, Slack};
use crate::together::StartFault;

/// Outcome of a motion.
pub type Outcome = Result<MotionReport, MotionError>;

/// Report of a motion that ended as asked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionReport {
    /// Duration from the first state that the goal answered to the arrival, in the robot's time,
    /// with all pauses and delays. For a control function, the duration until the end of the
    /// motion.
    ///
    /// The arm must then rest at the target for [`Settling::hold`](crate::session::Settling::hold)
    /// before the motion resolves. The duration does not include that time; the counts below do.
    pub duration: Duration,
    /// Distance of the measured end effector from its target; `None` for a motion without one.
    pub final_error: Option<PoseError>,
    /// Distance after the arm was released at the end of the motion. The robot's own controller,
    /// which does not have the compensation, takes over after that. `None` without a target, if the
    /// arm stays held, and if the robot's controller ran the motion.
    pub released_error: Option<PoseError>,
    /// Greatest distance of the measured end effector from the straight line to its target, `[m]`.
    /// The line begins where the end effector was when the motion began. `None` for a motion
    /// without a line: to joint positions, through waypoints, of a control function, or one that
    /// has reacted to its condition.
    pub line_deviation: Option<f64>,
    /// Torques that compensated the friction and bias of each joint at the arrival, `[N m]`, in
    /// addition to the springs. `None` if this driver's law did not run: under the robot's
    /// controller, and for a control function.
    pub compensation: Option<[f64; 7]>,
    /// Values at the time when the condition of the motion became true, if the motion reacted to it
    /// instead of arriving: see [`Reaction`](crate::session::Reaction). `None` if the motion
    /// arrived, or has no condition.
    pub reacted: Option<Reacted>,
    /// Number of states that never arrived while the motion ran.
    pub lost_states: u64,
    /// Number of states that arrived but were skipped, because a newer state had come before they
    /// were read.
    pub skipped_states: u64,
    /// Lowest success rate that the robot reported while the motion ran, in `[0, 1]`.
    pub success_rate_min: f64,
    /// Mean success rate that the robot reported while the motion ran, in `[0, 1]`.
    pub success_rate_avg: f64,
    /// Longest time from the receipt of a state to the departure of its command.
    pub worst_turnaround: Duration,
    /// The least time that was left until the next state was due when a command departed. `None`,
    /// like the next options, if no command left.
    pub slack_min: Option<Slack>,
    /// Number of commands that left only after the next state was due. A simulator that waits for
    /// commands still has them in time.
    pub overruns: u64,
    /// The longest cycle, with its phases.
    pub worst_cycle: Option<CycleTimes>,
    /// Times between two consecutive states, by this host's clock.
    pub interval: Option<Quantiles>,
    /// Times from the receipt of a state to the departure of its command.
    pub turnaround: Option<Quantiles>,
}

impl MotionReport {
    pub(super) fn new(counted: &Counted, duration_ms: u64, final_error: Option<PoseError>) -> Self {
        let Counted { statistics, times } = counted;
        Self {
            duration: Duration::from_millis(duration_ms),
            final_error,
            released_error: None,
            line_deviation: None,
            compensation: None,
            reacted: None,
            lost_states: statistics.lost_states,
            skipped_states: statistics.skipped_states,
            success_rate_min: statistics.success_rate_min,
            success_rate_avg: statistics.success_rate_avg(),
            worst_turnaround: statistics.worst_turnaround,
            slack_min: statistics.slack_min(),
            overruns: statistics.overruns,
            worst_cycle: statistics.worst_cycle(),
            interval: times.interval.quantiles(),
            turnaround: times.turnaround.quantiles(),
        }
    }
}

/// Counts over the cycles of a motion.
#[derive(Clone, Debug, Default)]
pub(super) struct Counted {
    pub(super) statistics: MotionStatistics,
    pub(super) times: Arc<MotionTimes>,
}

impl Counted {
    pub(super) fn of(ended: &Ended) -> Self {
        Self {
            statistics: ended.statistics,
            times: ended.times.clone(),
        }
    }
}

/// Reason why a motion ended short of its goal, grouped by the party that can act on it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// Caller: the goal was not accepted. Nothing was sent to the robot.
    #[error(transparent)]
    Goal(#[from] GoalError),
    /// Caller: the path was not accepted. Nothing was sent to the robot.
    #[error(transparent)]
    Path(#[from] PathError),
    /// Caller: a newer goal took over.
    #[error("superseded by a newer goal")]
    Superseded,
    /// Caller: a stop was requested; the arm was braked and rests.
    #[error("stopped on request")]
    Stopped,
    /// Caller: the goal was given up. The arm is held at the last target, or where it stopped.
    #[error("the motion was given up and the arm holds its position: {0}")]
    Held(Lapse),
    /// The goal was given up and the arm braked, for this reason. The arm is held where it stopped.
    /// Caller: the targets stopped coming, or are too near to the arm itself or to a keep-out
    /// region, or the arm was pushed off its path.
    #[error("the motion was given up and the arm braked: {0}")]
    Braked(Lapse),
    /// Caller: the session that the goal is for has ended, or is about to. Nothing was sent.
    #[error("the arm is no longer engaged: call `engage` again")]
    Disengaged,
    /// Caller: something else controls the arm, and does not yield to this motion.
    #[error(
        "libfranka robot: Cannot perform this operation while another control or read operation is running."
    )]
    Busy,
    /// Caller: not all motions of a common start came. The arm was held, or never moved.
    #[error(transparent)]
    Start(#[from] StartFault),
    /// Caller: the protocol version does not have this motion. Nothing was sent.
    #[error(transparent)]
    Unsupported(#[from] RequestError),
    /// Caller: a command cannot be sent. A control function returned it, or it was computed from a
    /// state or a goal with non-finite numbers. The driver has asked the robot to stop.
    #[error(transparent)]
    Invalid(#[from] InvalidCommand),
    /// Caller: a control function gave up. The driver has asked the robot to stop.
    #[error("the control function gave up with code {code}")]
    GivenUp {
        /// The function's own code.
        code: i32,
    },
    /// Caller: a control function panicked. The driver has asked the robot to stop.
    #[error("the control function panicked: {message}")]
    Panicked {
        /// Message of the panic, if it was text.
        message: String,
    },
    /// Caller: the thread that runs active control has read no state for this long. The driver has
    /// asked the robot to stop.
    #[error(
        "active control has read no state for {} ms, expected a `read_once` every millisecond",
        .silence.as_millis()
    )]
    Stalled {
        /// Length of the silence when the motion was given up.
        silence: Duration,
    },
    /// Caller: the control thread has run no cycle for this long, and the robot has ended the
    /// motion because commands were missing. A control function has not returned, or the thread was
    /// not scheduled.
    #[error(
        "the control thread has run no cycle for {} ms, expected one every millisecond: the \
         control function has not returned, or this computer delays the thread",
        .silence.as_millis()
    )]
    Hung {
        /// Least time without a cycle.
        silence: Duration,
    },
    /// Robot: it refused to start the motion. The text is libfranka's, followed by the remedy after
    /// a reflex.
    #[error("{}{}", .0, recover_first(.0))]
    Rejected(Refusal),
    /// Robot: it ended the motion: by a reflex, a user stop, another client's stop, or a safety
    /// function. Clear the cause; after a reflex, recover.
    #[error(transparent)]
    Control(#[from] Box<ControlError>),
    /// Robot or link: the supervised robot accepts no motions now, and this motion did not wait, or
    /// no longer waits. It has not begun. Who can act depends on the reason.
    #[error("{}", not_ready(*.why, *.waited))]
    NotReady {
        /// Reason.
        why: Unready,
        /// Time that the motion waited.
        waited: Duration,
    },
    /// Robot or surroundings: the reference reached the target and the arm did not follow. The arm
    /// rests where it is.
    ///
    /// Caller: if a torque limit of the gains kept the arm back, see [`Shortfall::limited`].
    #[error("the arm stopped {0}")]
    TargetNotReached(Shortfall),
    /// Robot or surroundings: no motion runs, and the arm was not seen to rest after a stop. A hand
    /// guides it, or its joints still move.
    #[error("joint {joint} moves at {velocity:.3} rad/s without a motion, expected an arm at rest")]
    NotAtRest {
        /// A joint that moves, 1 to 7.
        joint: usize,
        /// Velocity of that joint, `[rad/s]`.
        velocity: f64,
    },
    /// The condition of the motion was true, but the arm did not reach its new target. `error` is
    /// [`Self::Held`], [`Self::Braked`] or [`Self::TargetNotReached`]; the party of `error` can act
    /// on it.
    #[error("{error} (after the motion's condition was true at {} ms)", .reacted.after.as_millis())]
    AfterReaction {
        /// Values at the time when the condition became true.
        reacted: Box<Reacted>,
        /// Reason why the arm did not reach the new target.
        error: Box<Self>,
    },
    /// Link: the robot fell silent.
    #[error("libfranka: UDP receive: Timeout (no robot state for {} ms)", .silence.as_millis())]
    LinkLost {
        /// Length of the silence when the motion was given up.
        silence: Duration,
    },
    /// The command connection has ended. Who can act depends on the reason.
    #[error("{reason}")]
    ConnectionClosed {
        /// Cause of the end.
        reason: CloseReason,
    },
    /// Peer: a reply of the robot cannot be read.
    #[error(transparent)]
    Violation(#[from] Violation),
    /// Peer: the robot broke the protocol. Please report it.
    #[error("{what}")]
    Protocol {
        /// Action of the robot that broke the protocol.
        what: &'static str,
    },
}

impl MotionError {
    /// True if the robot accepts a new motion after this error without help from outside.
    ///
    /// After a reflex the robot must be recovered first. After a lost link or connection, the
    /// program must reconnect. A failed control function may also have left the robot without
    /// commands until the robot stopped itself.
    pub fn is_ready_for_more(&self) -> bool {
        matches!(
            self,
            Self::Goal(_)
                | Self::Path(_)
                | Self::Superseded
                | Self::Stopped
                | Self::Held(_)
                | Self::Braked(_)
                | Self::Disengaged
                | Self::Busy
                | Self::Start(_)
                | Self::Unsupported(_)
                | Self::TargetNotReached(_)
                | Self::AfterReaction { .. }
        )
    }

    /// Returns the values at the time when the motion's condition became true, if the motion failed
    /// after that. For a motion that the robot ended, see
    /// [`Guard::Reaction`](crate::session::Guard::Reaction) in the records of the log.
    pub fn reacted(&self) -> Option<&Reacted> {
        match self {
            Self::AfterReaction { reacted, .. } => Some(reacted),
            _ => None,
        }
    }

    /// Returns this error for a motion whose condition was true before.
    pub(super) fn after(self, reacted: Reacted) -> Self {
        Self::AfterReaction {
            reacted: Box::new(reacted),
            error: Box::new(self),
        }
    }

    /// Returns the robot's report if the robot ended the motion.
    pub fn control(&self) -> Option<&ControlError> {
        match self {
            Self::Control(error) => Some(error),
            _ => None,
        }
    }

    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::Goal(error) => error.entry(),
            Self::Path(_) => "motion-path",
            Self::Superseded => "motion-superseded",
            Self::Stopped => "motion-stopped",
            Self::Held(lapse) | Self::Braked(lapse) => lapse.entry(),
            Self::Disengaged => "motion-disengaged",
            Self::Busy => "motion-busy",
            Self::Start(fault) => fault.entry(),
            Self::Unsupported(_) => "motion-unsupported",
            Self::Invalid(_) => "motion-invalid",
            Self::GivenUp { .. } => "motion-given-up",
            Self::Panicked { .. } => "motion-panicked",
            Self::Stalled { .. } => "motion-stalled",
            Self::Hung { .. } => "motion-hung",
            Self::Rejected(refusal) => refusal.entry(),
            Self::Control(error) => error.entry(),
            Self::NotReady { why, .. } => why.entry(),
            Self::TargetNotReached(_) => "motion-target-not-reached",
            Self::NotAtRest { .. } => "motion-not-at-rest",
            Self::AfterReaction { error, .. } => error.entry(),
            Self::LinkLost { .. } => "motion-link-lost",
            Self::ConnectionClosed { reason } => reason.entry(),
            Self::Violation(_) => "motion-violation",
            Self::Protocol { .. } => "motion-protocol",
        }
    }

    /// Returns the party that can act on this error.
    pub fn party(&self) -> Party {
        match self {
            // A person at the robot pushed the arm.
            Self::Held(Lapse::Displaced) | Self::Braked(Lapse::Displaced | Lapse::Unresponsive) => {
                Party::Robot
            }
            Self::Goal(_)
            | Self::Path(_)
            | Self::Superseded
            | Self::Stopped
            | Self::Held(_)
            | Self::Braked(_)
            | Self::Disengaged
            | Self::Busy
            | Self::Start(_)
            | Self::Unsupported(_)
            | Self::Invalid(_)
            | Self::GivenUp { .. }
            | Self::Panicked { .. }
            | Self::Stalled { .. }
            | Self::Hung { .. } => Party::Caller,
            Self::TargetNotReached(short) if short.limited.is_some() => Party::Caller,
            Self::Rejected(_)
            | Self::Control(_)
            | Self::TargetNotReached(_)
            | Self::NotAtRest { .. } => Party::Robot,
            Self::AfterReaction { error, .. } => error.party(),
            Self::LinkLost { .. } => Party::Link,
            Self::NotReady { why, .. } => why.party(),
            Self::ConnectionClosed { reason } => reason.party(),
            Self::Violation(_) | Self::Protocol { .. } => Party::Peer,
        }
    }
}

/// Returns the advice for a robot that refuses in the mode "Reflex".
fn recover_first(refusal: &Refusal) -> &'static str {
    let not_possible = Status::Move(MoveStatus::CommandNotPossibleRejected);
    match (refusal.status() == not_possible, refusal.mode()) {
        (true, RobotMode::Reflex) => " (`recover` first)",
        _ => "",
    }
}

fn not_ready(why: Unready, waited: Duration) -> String {
    match waited.as_millis() {
        0 => format!("the motion did not begin: {why}"),
        waited => format!("the motion did not begin, after waiting for {waited} ms: {why}"),
    }
}

/// Party that can act on an error. Every error has one, see [`MotionError::party`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Party {
    /// The program: it made an impossible request, or ended something itself.
    Caller,
    /// People at the robot: it refused, stopped itself, or something is in its way.
    Robot,
    /// The network.
    Link,
    /// This computer: privileges, kernel, resources.
    Host,
    /// The code of one side: the other side breaks the protocol, or has another version.
    Peer,
}

/// Prints one word, such as `caller`.
impl fmt::Display for Party {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Caller => "caller",
            Self::Robot => "robot",
            Self::Link => "link",
            Self::Host => "host",
            Self::Peer => "peer",
        })
    }
}

/// Progress of a motion when the robot ended it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stage {
    /// No state of the motion had been answered.
    Starting,
    /// The motion was under way.
    Running,
    /// The finishing command was sent: the robot may have refused to finish a moving command.
    Finishing,
}

/// Report on a motion that the robot ended.
///
/// `Display` prints the message of libfranka's `ControlException` for the same event. For a reflex
/// before the first cycle, the message also names the errors.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ControlError {
    /// The robot's answer, the errors that stopped it (`reflex_reason` of the state that ended the
    /// motion) and the success rate before it.
    pub failure: ControlFailure,
    /// Errors that are active in the last state.
    pub errors: Errors,
    /// Progress of the motion.
    pub stage: Stage,
    /// The last cycles of the motion. The newest one shows its end. An option of the connection
    /// sets their number.
    pub log: Arc<ControlLog>,
    /// Source of the motion's commands.
    pub commander: Commander,
    /// Counts over the motion.
    pub statistics: MotionStatistics,
    /// The model that control computed with.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub model: Arc<Model>,
}

impl ControlError {
    /// Returns the robot's last reply about the motion.
    pub fn refusal(&self) -> Refusal {
        self.failure.refusal
    }

    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`: the row
    /// of the first error that stopped the robot, or of the robot's answer.
    pub fn entry(&self) -> &'static str {
        let first = self.failure.reflex_reason.iter().next();
        match first.filter(|_| self.is_reflex()) {
            Some(error) => error.name(),
            None => self.refusal().entry(),
        }
    }

    /// True if the robot stopped itself for one of the reasons in
    /// [`ControlFailure::reflex_reason`]. It must then be recovered.
    pub fn is_reflex(&self) -> bool {
        self.failure.refusal.status() == Status::Move(MoveStatus::ReflexAborted)
    }
}

impl core::fmt::Display for ControlError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.stage {
            // libfranka 0.21, `robot_impl.cpp`: for a motion that has not begun, the text is the
            // refusal's.
            Stage::Starting if self.is_reflex() && !self.failure.reflex_reason.is_empty() => {
                write!(f, "{} {}", self.failure.refusal, self.failure.reflex_reason)
            }
            Stage::Starting => write!(f, "{}", self.failure.refusal),
            // For a motion that was finishing, this text replaces the refusal's.
            Stage::Finishing if self.is_reflex() => {
                write!(
                    f,
                    "Motion finished commanded, but the robot is still moving! {}",
                    self.failure.reflex_reason
                )?;
                let rate = self.failure.success_rate;
                rate.map_or(Ok(()), |rate| write!(f, "{rate}"))
            }
            Stage::Running | Stage::Finishing => write!(f, "{}", self.failure),
        }
    }
}

impl std::error::Error for ControlError {}
