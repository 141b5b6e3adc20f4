//! One motion: what the two sides have said of it, and what that makes of its goal.

use core::time::Duration;

use franka_proto::{Command, ControlFailure, MoveStatus, Refusal, Status};

use super::{MotionError, MotionReport, Reflex};
use crate::driver::{Ended, Ending, MotionId, MotionStatistics, Program};
use crate::session::{Goal, GoalError, GoalId, Settlement, Target, Then};
use crate::slot::SlotWriter;

/// A goal, and whether its owner has taken it back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) goal: Goal,
    pub(super) cancelled: bool,
}

/// One motion: what the two sides have said so far.
#[derive(Debug)]
pub(super) struct Active {
    pub(super) motion: MotionId,
    pub(super) slot: SlotWriter<Goal>,
    pub(super) current: Waiting,
    pub(super) settled: Option<Settled>,
    pub(super) bad_tool: bool,
    pub(super) command: CommandSide,
    pub(super) thread: ThreadSide,
    pub(super) deadline: Option<Duration>,
}

/// What the session said of the goal it settled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled {
    pub(super) goal: GoalId,
    pub(super) settlement: Settlement,
    pub(super) duration_ms: u64,
    pub(super) statistics: MotionStatistics,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CommandSide {
    /// The `Move` is out.
    Requested,
    /// The robot has started the motion.
    Started,
    /// It did not end in time; a `StopMove` is out.
    Cancelled,
    /// The robot has said how it ended, or why it did not begin.
    Ended(MoveStatus),
}

#[derive(Debug)]
pub(super) enum ThreadSide {
    Armed,
    Running,
    Ended(Ended),
}

impl Active {
    /// Has the thread come to rest and finish, whatever it was doing: nobody waits for this motion any more.
    pub(super) fn brake(&mut self) {
        self.slot.write(&Goal {
            target: Target::Rest,
            then: Then::Finish,
            ..self.current.goal
        });
    }

    /// Whether the motion ended well with an older goal than the current one.
    pub(super) fn came_too_late(&self, ended: &Ended) -> bool {
        let Program::Target(session) = &ended.program;
        ended.ending == Ending::Finished
            && self.command == CommandSide::Ended(MoveStatus::Success)
            && session
                .last_goal()
                .is_some_and(|last| last != self.current.goal.id)
    }

    /// How the current goal turned out, both sides having ended.
    pub(super) fn verdict(&self, ended: &Ended) -> Result<MotionReport, MotionError> {
        let status = match (ended.ending, self.command) {
            (Ending::LinkLost { silence }, _) => return Err(MotionError::LinkLost { silence }),
            (Ending::Refused, _) => {
                return Err(MotionError::Protocol {
                    what: "another motion was under way",
                });
            }
            (_, CommandSide::Ended(status)) => status,
            (_, CommandSide::Requested | CommandSide::Started | CommandSide::Cancelled) => {
                return Err(MotionError::Protocol {
                    what: "the robot never showed the modes of the motion",
                });
            }
        };
        let refusal = Refusal::new(Command::Move, Status::Move(status), ended.robot_mode);
        match (refusal, ended.ending, &self.settled) {
            (Some(refusal), ending, _) if status == MoveStatus::ReflexAborted => {
                Err(MotionError::Reflex(Reflex {
                    failure: ControlFailure {
                        refusal,
                        reflex_reason: ended.reflex_reason,
                        success_rate: ended.statistics.success_rate_at_the_end(),
                    },
                    while_finishing: ending == Ending::Finished,
                }))
            }
            (Some(refusal), Ending::Disarmed, _) if is_rejection(status) => {
                Err(MotionError::Rejected(refusal))
            }
            (None, Ending::Finished, _) if self.bad_tool => Err(GoalError::Tool.into()),
            (Some(refusal), _, _) => Err(MotionError::Aborted {
                refusal,
                errors: ended.errors,
            }),
            (None, Ending::Finished, Some(settled)) if settled.goal == self.current.goal.id => {
                settled.result(self.current.cancelled)
            }
            // libfranka, `robot_impl.cpp`, has this text for it.
            (None, _, _) => Err(MotionError::Protocol {
                what: "Unexpected reply to a Move command",
            }),
        }
    }
}

impl Settled {
    pub(super) fn result(&self, cancelled: bool) -> Result<MotionReport, MotionError> {
        let final_error = match self.settlement {
            Settlement::Arrived(error) => Some(error),
            Settlement::AtRest if cancelled => return Err(MotionError::Stopped),
            Settlement::AtRest => None,
            Settlement::Short(error) => return Err(MotionError::Short(error)),
        };
        Ok(MotionReport::new(
            &self.statistics,
            self.duration_ms,
            final_error,
        ))
    }
}

/// Whether the robot did not let the motion begin, rather than ended it before the thread saw it run.
fn is_rejection(status: MoveStatus) -> bool {
    matches!(
        status,
        MoveStatus::CommandNotPossibleRejected
            | MoveStatus::CommandRejectedDueToActivatedSafetyFunctions
            | MoveStatus::StartAtSingularPoseRejected
            | MoveStatus::InvalidArgumentRejected
    )
}
