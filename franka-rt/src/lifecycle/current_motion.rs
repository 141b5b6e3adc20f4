//! One motion: the reports of robot and thread, and the outcome that results from them.

use core::time::Duration;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::{Command, ControlFailure, MoveStatus, Refusal, Status};

use super::goal_progress::{Goals, Owner};
use super::outcome::{Counted, Outcome};
use super::programs::UserProgram;
use super::{ControlError, END_TIMEOUT, MotionError, MotionReport, Stage};
use crate::control::Failure;
use crate::driver::{Ended, Ending, MotionId, Order};
use crate::panic;
use crate::stats::MotionTimes;

/// Fault of a robot that starts a motion but shows no state of it.
pub(super) const NEVER_SHOWN: &str = "the robot's states never showed the motion's modes";

#[derive(Debug)]
pub(super) struct CurrentMotion {
    pub(super) motion: MotionId,
    pub(super) work: Work,
    pub(super) command: CommandSide,
    pub(super) thread: ThreadSide,
    pub(super) deadline: Option<Duration>,
    /// Step that the robot had not taken by a deadline. After the deadline, the robot was asked to
    /// stop.
    pub(super) given_up: Option<&'static str>,
    /// Time at which the last command was sent.
    pub(super) finishing: Option<Duration>,
    /// Reason why the motion's program could not continue.
    pub(super) failure: Option<MotionError>,
    /// Time at which a `StopMove` was sent, or is about to be sent. The cause is a request to stop,
    /// a failed program, or an arm that does not stop.
    pub(super) stopped: Option<Duration>,
    /// Durations of the motion's cycles, counted by the thread.
    pub(super) times: Arc<MotionTimes>,
}

/// Purpose of the motion.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per motion, in a box of its own already"
)]
pub(super) enum Work {
    /// Goals. Each goal supersedes the previous one.
    Goals(Goals),
    /// A program of the user.
    Program(UserProgram),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CommandSide {
    /// The `Move` was sent.
    Requested,
    /// The robot has started the motion.
    Started,
    /// The robot did not end the motion in time, and a `StopMove` was sent.
    Cancelled,
    /// The robot has reported the end of the motion, or why it did not begin.
    Ended(MoveStatus),
}

#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per motion, in a box of its own already"
)]
pub(super) enum ThreadSide {
    Armed,
    Running,
    Ended(Ended),
}

impl CurrentMotion {
    /// Returns the outcome of the motion on a robot of this model. Robot and thread must both have
    /// ended the motion. If the outcome is an error with a log, the log is moved into the error.
    pub(super) fn verdict(&mut self, model: &Arc<Model>) -> Outcome {
        let ThreadSide::Ended(ended) = &mut self.thread else {
            unreachable!("a motion concludes when its thread side has ended")
        };
        // Events after a failure are its consequences.
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let status = match (ended.ending, self.command) {
            (Ending::LinkLost { silence }, _) => return Err(MotionError::LinkLost { silence }),
            (Ending::Refused, _) => {
                return Err(MotionError::Protocol {
                    what: "another motion was running",
                });
            }
            (_, CommandSide::Ended(status)) => status,
            (_, CommandSide::Requested | CommandSide::Started | CommandSide::Cancelled) => {
                return Err(MotionError::Protocol {
                    what: self.given_up.unwrap_or(NEVER_SHOWN),
                });
            }
        };
        let refusal = Refusal::new(Command::Move, Status::Move(status), ended.robot_mode);
        match refusal {
            Some(refusal) if ended.ending == Ending::Disarmed && is_rejection(status) => {
                return Err(MotionError::Rejected(refusal));
            }
            // If the robot was asked to stop a motion, the motion ends with this status, even if
            // its finishing command was already sent.
            Some(_) if status == MoveStatus::Preempted && self.stopped.is_some() => {
                return match &self.work {
                    Work::Goals(goals) => goals.outcome_of_stop(ended),
                    Work::Program(_) => Err(MotionError::Stopped),
                };
            }
            Some(refusal) => {
                return Err(match (status, self.given_up) {
                    // A motion that the driver gave up also ends with this status.
                    (MoveStatus::Preempted, Some(what)) => MotionError::Protocol { what },
                    _ => ControlError::new(refusal, ended, model).into(),
                });
            }
            None => {}
        }
        let outcome = match &self.work {
            Work::Goals(goals) if ended.ending == Ending::Finished => goals.outcome(ended),
            Work::Goals(_) => None,
            Work::Program(_) => outcome_of_program(ended, self.stopped.is_some()),
        };
        // This is libfranka's text for this case (`robot_impl.cpp`).
        outcome.unwrap_or(Err(MotionError::Protocol {
            what: "Unexpected reply to a Move command",
        }))
    }

    /// True if robot or thread has ended the motion, or if the robot was asked to stop it.
    pub(super) fn is_ending(&self) -> bool {
        self.stopped.is_some()
            || matches!(self.thread, ThreadSide::Ended(_))
            || matches!(self.command, CommandSide::Ended(_) | CommandSide::Cancelled)
    }

    /// True if the motion is about to end, and no caller needs it to continue.
    pub(super) fn is_letting_go(&self) -> bool {
        self.is_ending()
            || match &self.work {
                Work::Goals(goals) if goals.owner != Owner::Goal => !goals.goes_on(),
                Work::Goals(goals) => goals.cancelled,
                Work::Program(_) => false,
            }
    }

    /// Returns the deadline of the current motion. Returns `None` unless its last command was sent
    /// or a stop was requested.
    pub(super) fn running_deadline(&self) -> Option<Duration> {
        let since = self.finishing.or(self.stopped);
        since.map(|since| since + END_TIMEOUT)
    }

    /// True if the motion accepts goals from callers outside a session. Programs and lasting
    /// sessions do not accept them.
    pub(super) fn takes_goals(&self) -> bool {
        match &self.work {
            Work::Goals(goals) => goals.owner == Owner::Goal || !goals.goes_on(),
            Work::Program(_) => false,
        }
    }

    /// True if the robot has not reported the end of the motion and the driver has not given up
    /// waiting for it.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.command, CommandSide::Requested | CommandSide::Started)
    }

    /// Returns the order that makes the thread end the motion, unless the order was sent before.
    /// Call this when no caller waits for the motion any more. An arm on its way to a goal then
    /// brakes. A program gets no more states, and the robot stops because commands are missing.
    pub(super) fn abandon(&mut self) -> Option<Order> {
        if let Work::Goals(goals) = &mut self.work {
            goals.brake();
        }
        let motion = self.motion;
        let has_ended = matches!(self.thread, ThreadSide::Ended(_));
        (!has_ended).then_some(Order::Abandon { motion })
    }
}

fn outcome_of_program(ended: &Ended, is_stopped: bool) -> Option<Outcome> {
    match ended.ending {
        Ending::Finished => {
            if let Some(fault) = ended.start_fault() {
                return Some(Err(fault.into()));
            }
            let duration_ms = ended.statistics.duration_ms();
            Some(Ok(MotionReport::new(
                &Counted::of(ended),
                duration_ms,
                None,
            )))
        }
        _ if is_stopped => Some(Err(MotionError::Stopped)),
        _ => None,
    }
}

/// Converts the reason why a program could not continue into an error that tasks can share.
impl From<Failure> for MotionError {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Invalid(invalid) => Self::Invalid(invalid),
            Failure::GivenUp(code) => Self::GivenUp { code },
            Failure::Panicked(payload) => {
                let message = panic::message(&*payload);
                // Report the panic itself, and ignore a panic while its payload is dropped.
                let _ = panic::free(payload);
                Self::Panicked { message }
            }
        }
    }
}

impl ControlError {
    /// Creates the error for a robot of this model that ended a motion with `refusal`. Moves the
    /// motion's log into it.
    fn new(refusal: Refusal, ended: &mut Ended, model: &Arc<Model>) -> Box<Self> {
        let log = core::mem::take(&mut ended.log);
        Box::new(Self {
            failure: ControlFailure {
                refusal,
                reflex_reason: ended.reflex_reason,
                success_rate: log.success_rate(),
            },
            errors: ended.errors,
            stage: match ended.ending {
                Ending::Finished => Stage::Finishing,
                Ending::Aborted => Stage::Running,
                Ending::Disarmed | Ending::Refused | Ending::LinkLost { .. } => Stage::Starting,
            },
            log: Arc::new(log),
            commander: (&ended.program).into(),
            statistics: ended.statistics,
            model: model.clone(),
        })
    }
}

/// True if the robot refused to begin the motion. False if the robot ended the motion before the
/// thread saw it run.
fn is_rejection(status: MoveStatus) -> bool {
    matches!(
        status,
        MoveStatus::CommandNotPossibleRejected
            | MoveStatus::CommandRejectedDueToActivatedSafetyFunctions
            | MoveStatus::StartAtSingularPoseRejected
            | MoveStatus::InvalidArgumentRejected
    )
}
