//! One motion: what the two sides have said of it, and what that makes of its outcome.

use core::time::Duration;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::{Command, ControlFailure, MoveStatus, Refusal, Status};

use super::engagement::Engagement;
use super::outcome::Counted;
use super::{ControlError, END_TIMEOUT, MotionError, MotionReport, Stage};
use crate::control::Failure;
use crate::driver::{Ended, Ending, MotionId, Order, Program};
use crate::panic;
use crate::session::{
    Backend, ChunkWriter, Goal, GoalError, GoalId, OnArrival, Settlement, Target,
};
use crate::slot::SlotWriter;
use crate::stats::MotionTimes;

/// A goal, and whether its owner has taken it back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) goal: Goal,
    pub(super) cancelled: bool,
}

/// What waits for the motion under way to end.
#[derive(Debug)]
pub(super) struct Next {
    pub(super) waiting: Waiting,
    /// What else there is to the session that it begins, if that goes on from goal to goal.
    pub(super) engagement: Option<Engagement>,
}

impl Waiting {
    /// A goal that its owner wants.
    pub(super) fn new(goal: Goal) -> Self {
        Self {
            goal,
            cancelled: false,
        }
    }
}

/// What a robot does that starts a motion and shows no state of it.
pub(super) const NEVER_SHOWN: &str = "the robot never showed the modes of the motion";

/// One motion: what the two sides have said so far.
#[derive(Debug)]
pub(super) struct Active {
    pub(super) motion: MotionId,
    pub(super) work: Work,
    pub(super) command: CommandSide,
    pub(super) thread: ThreadSide,
    pub(super) deadline: Option<Duration>,
    /// What the robot had not done by a deadline, so that it was told to stop.
    pub(super) given_up: Option<&'static str>,
    /// Since when its last command is out.
    pub(super) finishing: Option<Duration>,
    /// Why its program could not go on.
    pub(super) failure: Option<MotionError>,
    /// Since when a `StopMove` is out, or about to be, because a stop was asked for or the program
    /// failed.
    pub(super) stopped: Option<Duration>,
    /// Where the thread counts the times of its cycles.
    pub(super) times: Arc<MotionTimes>,
}

/// What the motion is for.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per motion, in a box of its own already"
)]
pub(super) enum Work {
    /// Goals, one superseding the other.
    Goals(Goals),
    /// A program of the user's.
    Program(Programmed),
}

/// The goals of a motion under target control.
#[derive(Debug)]
pub(super) struct Goals {
    pub(super) slot: SlotWriter<Goal>,
    pub(super) current: Waiting,
    pub(super) settled: Option<Settled>,
    pub(super) bad_tool: bool,
    /// The session that the goals belong to, if it goes on from goal to goal.
    pub(super) engaged: Option<Engaged>,
    /// What turns setpoints into torques.
    pub(super) backend: Backend,
    /// The way of chunks to that session.
    pub(super) chunks: Option<ChunkWriter>,
    /// The goal that its newest chunk belongs to.
    pub(super) chunk_goal: GoalId,
    /// Goals that came for that session after it had ended and before its outcome was known.
    pub(super) late: Vec<GoalId>,
}

/// A session that goes on from goal to goal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Engaged {
    /// Names the caller that awaits its end. Between goals it is the name of the goal that the arm
    /// holds, too.
    pub(super) id: GoalId,
    /// Whether its end is what was asked for.
    pub(super) disengaged: bool,
}

/// A motion under a program of the user's.
#[derive(Debug)]
pub(super) struct Programmed {
    /// Names the caller that awaits its end.
    pub(super) id: GoalId,
    /// Other callers that asked for the end and await it.
    pub(super) stops: Vec<GoalId>,
}

/// What the session said of the goal it settled.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    pub(super) goal: GoalId,
    pub(super) settlement: Settlement,
    pub(super) duration_ms: u64,
    /// What the motion had come to by then.
    pub(super) counted: Counted,
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
#[expect(
    clippy::large_enum_variant,
    reason = "one per motion, in a box of its own already"
)]
pub(super) enum ThreadSide {
    Armed,
    Running,
    Ended(Ended),
}

impl Active {
    /// How the motion turned out with a robot of this model, once both sides have ended. The log
    /// moves into the error, if that holds one.
    pub(super) fn verdict(&mut self, model: &Arc<Model>) -> Result<MotionReport, MotionError> {
        let ThreadSide::Ended(ended) = &mut self.thread else {
            unreachable!("a motion concludes when its thread side has ended")
        };
        // What came after a failure is its consequence.
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
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
                    what: self.given_up.unwrap_or(NEVER_SHOWN),
                });
            }
        };
        let refusal = Refusal::new(Command::Move, Status::Move(status), ended.robot_mode);
        match refusal {
            Some(refusal) if ended.ending == Ending::Disarmed && is_rejection(status) => {
                return Err(MotionError::Rejected(refusal));
            }
            // So ends a program's motion on a stop that was asked for, even with its finishing
            // command on its way,
            Some(_) if status == MoveStatus::Preempted && self.stopped.is_some() => {
                return Err(MotionError::Stopped);
            }
            Some(refusal) => {
                return Err(match (status, self.given_up) {
                    // and any motion that was given up.
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
        // libfranka, `robot_impl.cpp`, has this text for it.
        outcome.unwrap_or(Err(MotionError::Protocol {
            what: "Unexpected reply to a Move command",
        }))
    }

    /// Whether one of its sides has ended.
    pub(super) fn is_ending(&self) -> bool {
        matches!(self.thread, ThreadSide::Ended(_))
            || matches!(self.command, CommandSide::Ended(_) | CommandSide::Cancelled)
    }

    /// Whether it is coming to its end, and no caller wants it to go on.
    pub(super) fn is_letting_go(&self) -> bool {
        self.is_ending()
            || self.stopped.is_some()
            || match &self.work {
                Work::Goals(goals) if goals.engaged.is_some() => !goals.goes_on(),
                Work::Goals(goals) => goals.current.cancelled,
                Work::Program(_) => false,
            }
    }

    /// Until when a motion under way may go on: without end, unless its last command is out or a
    /// stop was asked for.
    pub(super) fn running_deadline(&self) -> Option<Duration> {
        let since = self.finishing.or(self.stopped);
        since.map(|since| since + END_TIMEOUT)
    }

    /// Has the thread end the motion by what is in its hands, and returns the order that this
    /// takes: no caller waits for it any more. Goals come to rest; a program is left alone, and the
    /// robot stops for want of commands.
    pub(super) fn abandon(&mut self) -> Option<Order> {
        let motion = self.motion;
        match (&mut self.work, &self.thread) {
            (_, ThreadSide::Ended(_)) => None,
            (Work::Program(_), ThreadSide::Armed | ThreadSide::Running) => {
                Some(Order::Silence { motion })
            }
            (Work::Goals(goals), thread) => {
                goals.brake();
                matches!(thread, ThreadSide::Armed).then_some(Order::Disarm { motion })
            }
        }
    }
}

/// How the motion of a program turned out that finished well or was stopped as asked.
fn outcome_of_program(
    ended: &Ended,
    is_stopped: bool,
) -> Option<Result<MotionReport, MotionError>> {
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

impl Goals {
    fn brake(&mut self) {
        self.slot.write(&Goal {
            revision: self.current.goal.revision + 1,
            ..self.current.goal.at_rest(OnArrival::ReportAndFinish)
        });
    }

    /// Whether goals are still taken.
    pub(super) fn goes_on(&self) -> bool {
        self.current.goal.on_arrival != OnArrival::ReportAndFinish
    }

    /// Takes note that a goal of the session `engaged` has come to its end, and is held from now
    /// on. Returns how it turned out, unless a caller has been told of its end before.
    pub(super) fn reach(
        &mut self,
        engaged: GoalId,
        settled: &Settled,
    ) -> Option<Result<MotionReport, MotionError>> {
        let Waiting { goal, cancelled } = self.current;
        if goal.id == engaged {
            // Given up after it had arrived: it is not to be taken back there.
            if !matches!(settled.settlement, Settlement::Arrived(_)) {
                self.current.goal.target = Target::Rest;
            }
            return None;
        }
        if settled.goal != goal.id {
            return None;
        }
        let held = match settled.settlement {
            Settlement::Arrived(_) => Goal {
                on_arrival: OnArrival::Hold,
                ..goal
            },
            // One that did not arrive is not what the arm is held at.
            _ => goal.at_rest(OnArrival::Hold),
        };
        self.current = Waiting::new(Goal {
            id: engaged,
            watchdog: None,
            ..held
        });
        Some(settled.result(&settled.counted, cancelled))
    }

    /// How the session turned out whose last goal turned out like this.
    pub(super) fn end_of_engagement(
        &self,
        result: &Result<MotionReport, MotionError>,
    ) -> Option<(GoalId, Result<MotionReport, MotionError>)> {
        let engaged = self.engaged?;
        let result = match result {
            Ok(_) if !engaged.disengaged => Err(MotionError::Stopped),
            result => result.clone(),
        };
        Some((engaged.id, result))
    }

    /// Whether the motion ended well with an older goal than the current one.
    pub(super) fn came_too_late(&self, command: CommandSide, ended: &Ended) -> bool {
        let Program::Target(session) = &ended.program else {
            return false;
        };
        ended.ending == Ending::Finished
            && command == CommandSide::Ended(MoveStatus::Success)
            && session
                .last_goal()
                .is_some_and(|last| last != self.current.goal.id)
    }

    /// How the current goal turned out in a motion that finished well, if the session said so.
    fn outcome(&self, ended: &Ended) -> Option<Result<MotionReport, MotionError>> {
        if self.bad_tool {
            return Some(Err(GoalError::Tool.into()));
        }
        let settled = self.settled.as_ref()?;
        (settled.goal == self.current.goal.id)
            .then(|| settled.result(&Counted::of(ended), self.current.cancelled))
    }
}

/// Why a program could not go on, in words that can cross tasks.
impl From<Failure> for MotionError {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Invalid(invalid) => Self::Invalid(invalid),
            Failure::Panicked(payload) => Self::Panicked {
                message: panic::message(&*payload),
            },
        }
    }
}

impl ControlError {
    /// A robot of this model ended a motion with `refusal`. Takes the log of the motion.
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

impl Settled {
    /// How the goal turned out, in a motion whose cycles came to what was `counted`.
    pub(super) fn result(
        &self,
        counted: &Counted,
        cancelled: bool,
    ) -> Result<MotionReport, MotionError> {
        let final_error = match self.settlement {
            Settlement::Arrived(error) => Some(error),
            Settlement::AtRest if cancelled => return Err(MotionError::Stopped),
            Settlement::AtRest => None,
            Settlement::TargetNotReached(error) => {
                return Err(MotionError::TargetNotReached(error));
            }
            Settlement::Held(lapse) => return Err(MotionError::Held(lapse)),
            Settlement::Braked(lapse) => return Err(MotionError::Braked(lapse)),
            Settlement::Unstarted(fault) => return Err(fault.into()),
        };
        Ok(MotionReport::new(counted, self.duration_ms, final_error))
    }
}

/// Whether the robot did not let the motion begin, rather than ended it before the thread saw it
/// run.
fn is_rejection(status: MoveStatus) -> bool {
    matches!(
        status,
        MoveStatus::CommandNotPossibleRejected
            | MoveStatus::CommandRejectedDueToActivatedSafetyFunctions
            | MoveStatus::StartAtSingularPoseRejected
            | MoveStatus::InvalidArgumentRejected
    )
}
