//! Outcome of a motion: the value that the motion's future resolves with. `franka_diagnosis` finds
//! out why the robot ended a motion.

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

/// Report of a motion that ended as requested.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionReport {
    /// Time from the first state that the goal answered to the arrival, in the robot's time, with
    /// all pauses and delays. For a control function, the time to the end of the motion.
    ///
    /// After the arrival, the arm must rest at the target for
    /// [`Settling::hold`](crate::session::Settling::hold) before the motion resolves. The duration
    /// does not include that time; the counts below include it.
    pub duration: Duration,
    /// Distance between the measured pose of the end effector and its target; `None` for a motion
    /// without a target.
    pub final_error: Option<PoseError>,
    /// Distance from the target after the arm was released at the end of the motion. Then the
    /// robot's own controller takes over, which does not have this driver's compensation. `None`
    /// without a target, if the arm stays held, and if the robot's controller ran the motion.
    pub released_error: Option<PoseError>,
    /// Greatest distance of the end effector's measured position from the straight line to its
    /// target, `[m]`. The line begins at the place of the end effector when the motion began.
    /// `None` for a motion without a line: a motion to joint positions, a motion through waypoints,
    /// a control function, or a motion that has reacted to its condition.
    pub line_deviation: Option<f64>,
    /// Torques that compensated the friction and bias of each joint at the arrival, `[N m]`, in
    /// addition to the springs. `None` under the robot's controller and for a control function,
    /// because this driver's law did not run.
    pub compensation: Option<[f64; 7]>,
    /// Values at the time when the condition of the motion became true, if the motion reacted to it
    /// instead of arriving: see [`Reaction`](crate::session::Reaction). `None` if the motion
    /// arrived, or has no condition.
    pub reacted: Option<Reacted>,
    /// Number of states that never arrived while the motion ran.
    pub lost_states: u64,
    /// Number of states that arrived but were skipped, because a newer state had arrived before
    /// they were read.
    pub skipped_states: u64,
    /// Lowest success rate that the robot reported while the motion ran, in `[0, 1]`.
    pub success_rate_min: f64,
    /// Mean success rate that the robot reported while the motion ran, in `[0, 1]`.
    pub success_rate_avg: f64,
    /// Longest time from the receipt of a state to the departure of its command.
    pub worst_turnaround: Duration,
    /// Shortest time between the departure of a command and the time when the next state was due.
    /// `None` if no command left; the same holds for the next optional fields.
    pub slack_min: Option<Slack>,
    /// Number of commands that left after the next state was due. A simulator that waits for
    /// commands still receives them in time.
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

/// Reason why a motion ended before it reached its goal. Most descriptions begin with the party
/// that can act on the error.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// Caller: the driver refused the goal. Nothing was sent to the robot.
    #[error(transparent)]
    Goal(#[from] GoalError),
    /// Caller: the driver refused the path. Nothing was sent to the robot.
    #[error(transparent)]
    Path(#[from] PathError),
    /// Caller: a newer goal replaced this goal.
    #[error("superseded by a newer goal")]
    Superseded,
    /// Caller: a stop was requested; the arm was braked and rests.
    #[error("stopped on request")]
    Stopped,
    /// Caller: the goal was given up. The arm is held at the last target or at the place where it
    /// stopped.
    #[error("the motion was given up and the arm holds its position: {0}")]
    Held(Lapse),
    /// The goal was given up and the arm braked, for the reason in [`Lapse`]. The arm is held where
    /// it stopped. Caller: the targets stopped arriving, or are too near to the arm itself or to a
    /// keep-out region, or the arm was pushed off its path.
    #[error("the motion was given up and the arm braked: {0}")]
    Braked(Lapse),
    /// Caller: the session that the goal belongs to has ended, or is about to end. Nothing was
    /// sent.
    #[error("the arm is no longer engaged: call `engage` again")]
    Disengaged,
    /// Caller: another motion or program controls the arm, and does not yield to this motion.
    #[error(
        "libfranka robot: Cannot perform this operation while another control or read operation is running."
    )]
    Busy,
    /// Caller: some motions of a common start did not arrive. The arm was held, or never moved.
    #[error(transparent)]
    Start(#[from] StartFault),
    /// Caller: the protocol version does not support this motion. Nothing was sent.
    #[error(transparent)]
    Unsupported(#[from] RequestError),
    /// Caller: a command cannot be sent. Either a control function returned it, or it was computed
    /// from a state or a goal with non-finite numbers. The driver has asked the robot to stop.
    #[error(transparent)]
    Invalid(#[from] InvalidCommand),
    /// Caller: a control function gave up. The driver has asked the robot to stop.
    #[error("the control function gave up with code {code}")]
    GivenUp {
        /// Code that the function returned.
        code: i32,
    },
    /// Caller: a control function panicked. The driver has asked the robot to stop.
    #[error("the control function panicked: {message}")]
    Panicked {
        /// Message of the panic, if it was a string.
        message: String,
    },
    /// Caller: the thread that runs active control has read no state for `silence`. The driver has
    /// asked the robot to stop.
    #[error(
        "active control has read no state for {} ms, expected a `read_once` every millisecond",
        .silence.as_millis()
    )]
    Stalled {
        /// Time without a read when the motion was given up.
        silence: Duration,
    },
    /// Caller: the control thread has run no cycle for `silence`, and the robot has ended the
    /// motion because commands were missing. Either a control function has not returned, or the
    /// thread was not scheduled.
    #[error(
        "the control thread has run no cycle for {} ms, expected one every millisecond: the \
         control function has not returned, or this computer delays the thread",
        .silence.as_millis()
    )]
    Hung {
        /// Time without a cycle, at least.
        silence: Duration,
    },
    /// Robot: it refused to start the motion. The text is libfranka's. After a reflex, the remedy
    /// follows the text.
    #[error("{}{}", .0, recover_first(.0))]
    Rejected(Refusal),
    /// Robot: it ended the motion, by a reflex, a user stop, another client's stop or a safety
    /// function. Remove the cause. After a reflex, recover the robot.
    #[error(transparent)]
    Control(#[from] Box<ControlError>),
    /// Robot or link: the supervised robot accepts no motions now, and this motion did not wait, or
    /// stopped waiting. It has not begun. The party that can act depends on the reason.
    #[error("{}", not_ready(*.why, *.waited))]
    NotReady {
        /// Reason why the robot accepts no motions.
        why: Unready,
        /// Time that the motion waited.
        waited: Duration,
    },
    /// Robot or surroundings: the reference reached the target, but the arm did not. The arm rests
    /// where it is.
    ///
    /// Caller: if a torque limit in the gains held the arm back, see [`Shortfall::limited`].
    #[error("the arm stopped {0}")]
    TargetNotReached(Shortfall),
    /// Robot or surroundings: no motion runs, but after a stop no state showed the arm at rest.
    /// Either a hand guides the arm, or its joints still move.
    #[error(
        "joint {joint} moves at {velocity:.3} rad/s although no motion runs, expected an arm at rest"
    )]
    NotAtRest {
        /// One of the joints that move, 1 to 7.
        joint: usize,
        /// Velocity of that joint, `[rad/s]`.
        velocity: f64,
    },
    /// The condition of the motion became true, but the arm did not reach its new target. `error`
    /// is [`Self::Held`], [`Self::Braked`] or [`Self::TargetNotReached`]; the party of `error` can
    /// act on it.
    #[error("{error} (the motion's condition had become true {} ms after the start)", .reacted.after.as_millis())]
    AfterReaction {
        /// Values at the time when the condition of the motion became true.
        reacted: Box<Reacted>,
        /// Reason why the arm did not reach the new target.
        error: Box<Self>,
    },
    /// Link: the robot stopped sending states.
    #[error("libfranka: UDP receive: Timeout (no robot state for {} ms)", .silence.as_millis())]
    LinkLost {
        /// Time without a state when the motion was given up.
        silence: Duration,
    },
    /// The command connection has ended. The party that can act depends on the reason.
    #[error("{reason}")]
    ConnectionClosed {
        /// Reason why the connection ended.
        reason: CloseReason,
    },
    /// Peer: a reply of the robot cannot be read.
    #[error(transparent)]
    Violation(#[from] Violation),
    /// Peer: the robot violated the protocol. Please report it.
    #[error("{what}")]
    Protocol {
        /// Action of the robot that violated the protocol.
        what: &'static str,
    },
}

impl MotionError {
    /// True if the robot accepts a new motion after this error without help from people or the
    /// program.
    ///
    /// After a reflex the robot must be recovered first. After a lost link or connection, the
    /// program must reconnect. After a failed control function, the robot may have received no
    /// commands and may have stopped itself.
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
    /// after that. If the robot ended the motion, look for
    /// [`Guard::Reaction`](crate::session::Guard::Reaction) in the records of the log.
    pub fn reacted(&self) -> Option<&Reacted> {
        match self {
            Self::AfterReaction { reacted, .. } => Some(reacted),
            _ => None,
        }
    }

    /// Returns this error for a motion whose condition became true before the error.
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
        self.row().0
    }

    /// Returns the party that can act on this error.
    pub fn party(&self) -> Party {
        self.row().1
    }

    fn row(&self) -> (&'static str, Party) {
        match self {
            Self::Goal(error) => (error.entry(), Party::Caller),
            Self::Path(_) => ("motion-path", Party::Caller),
            Self::Superseded => ("motion-superseded", Party::Caller),
            Self::Stopped => ("motion-stopped", Party::Caller),
            // A person at the robot pushed the arm.
            Self::Held(lapse @ Lapse::Displaced)
            | Self::Braked(lapse @ (Lapse::Displaced | Lapse::Unresponsive)) => {
                (lapse.entry(), Party::Robot)
            }
            Self::Held(lapse) | Self::Braked(lapse) => (lapse.entry(), Party::Caller),
            Self::Disengaged => ("motion-disengaged", Party::Caller),
            Self::Busy => ("motion-busy", Party::Caller),
            Self::Start(fault) => (fault.entry(), Party::Caller),
            Self::Unsupported(_) => ("motion-unsupported", Party::Caller),
            Self::Invalid(_) => ("motion-invalid", Party::Caller),
            Self::GivenUp { .. } => ("motion-given-up", Party::Caller),
            Self::Panicked { .. } => ("motion-panicked", Party::Caller),
            Self::Stalled { .. } => ("motion-stalled", Party::Caller),
            Self::Hung { .. } => ("motion-hung", Party::Caller),
            Self::Rejected(refusal) => (refusal.entry(), Party::Robot),
            Self::Control(error) => (error.entry(), Party::Robot),
            Self::NotReady { why, .. } => why.row(),
            Self::TargetNotReached(short) => {
                let is_limited = short.limited.is_some();
                let party = if is_limited {
                    Party::Caller
                } else {
                    Party::Robot
                };
                ("motion-target-not-reached", party)
            }
            Self::NotAtRest { .. } => ("motion-not-at-rest", Party::Robot),
            Self::AfterReaction { error, .. } => error.row(),
            Self::LinkLost { .. } => ("motion-link-lost", Party::Link),
            Self::ConnectionClosed { reason } => reason.row(),
            Self::Violation(_) => ("motion-violation", Party::Peer),
            Self::Protocol { .. } => ("motion-protocol", Party::Peer),
        }
    }
}

fn recover_first(refusal: &Refusal) -> &'static str {
    let not_possible = Status::Move(MoveStatus::CommandNotPossibleRejected);
    match (refusal.status() == not_possible, refusal.mode()) {
        (true, RobotMode::Reflex) => " (call `recover` first)",
        _ => "",
    }
}

fn not_ready(why: Unready, waited: Duration) -> String {
    match waited.as_millis() {
        0 => format!("the motion did not begin: {why}"),
        waited => format!("the motion waited for {waited} ms and did not begin: {why}"),
    }
}

/// Party that can act on an error. Every error has one: see [`MotionError::party`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Party {
    /// The program: it made an impossible request, or it ended something itself.
    Caller,
    /// People at the robot: the robot refused or stopped itself, or something is in its way.
    Robot,
    /// The network.
    Link,
    /// This computer: its privileges, its kernel or its resources.
    Host,
    /// The code of one side: the other side violates the protocol, or uses a different version of
    /// it.
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
    /// No state of the motion had been answered yet.
    Starting,
    /// The motion was under way.
    Running,
    /// The finishing command was sent. The robot may have refused to finish a motion in which the
    /// arm still moved.
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
    /// The robot's answer, the errors that stopped the robot (`reflex_reason` of the state that
    /// ended the motion), and the success rate before that state.
    pub failure: ControlFailure,
    /// Errors that are active in the last state of the motion.
    pub errors: Errors,
    /// Progress of the motion.
    pub stage: Stage,
    /// The last cycles of the motion. The newest cycle shows the end of the motion. An option of
    /// the connection sets the number of cycles.
    pub log: Arc<ControlLog>,
    /// Source of the commands of the motion.
    pub commander: Commander,
    /// Counts over all cycles of the motion.
    pub statistics: MotionStatistics,
    /// Model with which the driver computed the commands.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub model: Arc<Model>,
}

impl ControlError {
    /// Returns the reply with which the robot refused or ended the motion.
    pub fn refusal(&self) -> Refusal {
        self.failure.refusal
    }

    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`. It is the
    /// row of the first error that stopped the robot; without such an error, it is the row of the
    /// robot's answer.
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
            // libfranka 0.21, `robot_impl.cpp`: if the motion has not begun, the text is the text
            // of the refusal.
            Stage::Starting if self.is_reflex() && !self.failure.reflex_reason.is_empty() => {
                write!(f, "{} {}", self.failure.refusal, self.failure.reflex_reason)
            }
            Stage::Starting => write!(f, "{}", self.failure.refusal),
            // If the motion was finishing, this text replaces the text of the refusal.
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
