//! The goals of one motion under target control, and their outcomes.

use std::sync::Arc;

use franka_proto::MoveStatus;

use super::current_motion::CommandSide;
use super::outcome::{Counted, Outcome};
use super::{MotionError, MotionReport};
use crate::driver::{Ended, Ending, Program};
use crate::session::{
    Backend, Chunk, ChunkWriter, Goal, GoalError, GoalId, Lapse, OnArrival, Pulse, Reacted,
    Settlement, Target, TooManyChunks,
};
use crate::triple_buffer::Writer;

#[derive(Debug)]
pub(super) struct Goals {
    pub(super) newest: Writer<Goal>,
    /// The newest goal.
    pub(super) current: Goal,
    pub(super) cancelled: bool,
    /// Result of the motion, according to the reports of its session.
    pub(super) verdict: Verdict,
    pub(super) owner: Owner,
    /// Pulse of the deadman that the session is bound to.
    pub(super) pulse: Option<Arc<Pulse>>,
    pub(super) backend: Backend,
    /// Writer of the chunks for the session.
    pub(super) chunks: ChunkWriter,
    pub(super) stream: ChunkStream,
    /// Goals that arrived for that session after its end, before its outcome was known.
    pub(super) after_end: Vec<GoalId>,
}

/// Receiver of the outcome of a motion's goals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Owner {
    /// The caller of the goal. The motion ends with the goal.
    Goal,
    /// A session that lasts from goal to goal. The id belongs to the caller that awaits the
    /// session's end. Between goals, it is also the id of the goal that holds the arm.
    Engaged(GoalId),
    /// A session that lasted from goal to goal and was asked to end.
    Disengaged(GoalId),
}

impl Owner {
    /// Returns the id of the session that lasts, or lasted, from goal to goal.
    pub(super) fn session(self) -> Option<GoalId> {
        match self {
            Self::Goal => None,
            Self::Engaged(id) | Self::Disengaged(id) => Some(id),
        }
    }
}

/// Report of a motion's session about its end.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per motion, in a box of its own already"
)]
pub(super) enum Verdict {
    Open,
    /// The session cannot begin with the robot's tool.
    BadTool,
    /// The session has settled a goal: the current goal or an earlier one.
    Settled(Settled),
}

/// The chunks of a session. They share one goal until another goal arrives.
#[derive(Clone, Debug)]
pub(super) enum ChunkStream {
    /// The chunks have no goal yet; the next chunk begins with its own goal.
    None,
    /// The newest chunk belongs to this goal. The next chunk continues it while this goal is the
    /// current goal. The path of a goal does not count as such a chunk: the next goal or chunk
    /// supersedes it.
    Of {
        goal: GoalId,
        /// `message_id` of the observation from which the newest chunk was computed.
        observed_at: Option<u64>,
    },
    /// Reason why the goal of the chunks was given up. The next chunk returns this error, because
    /// no caller awaits the end of chunks.
    GivenUp(MotionError),
}

/// Report of the session about the goal that it settled.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    pub(super) goal: GoalId,
    pub(super) settlement: Settlement,
    pub(super) duration_ms: u64,
    pub(super) compensation: Option<[f64; 7]>,
    pub(super) line_deviation: Option<f64>,
    pub(super) reacted: Option<Reacted>,
    /// Counts of the motion up to that time.
    pub(super) counted: Counted,
}

impl Goals {
    /// Returns the goals of a separate motion to `goal`, which the slot of `newest` already holds.
    pub(super) fn new(goal: Goal, newest: Writer<Goal>, chunks: ChunkWriter) -> Self {
        Self {
            newest,
            current: goal,
            cancelled: false,
            verdict: Verdict::Open,
            owner: Owner::Goal,
            pulse: None,
            backend: Backend::default(),
            chunks,
            stream: ChunkStream::None,
            after_end: Vec::new(),
        }
    }

    /// Checks that no deadman holds the arm.
    pub(super) fn check_deadman(&self) -> Result<(), MotionError> {
        let silent = self.pulse.as_ref().is_some_and(|pulse| pulse.is_silent());
        if silent {
            return Err(MotionError::Held(Lapse::Deadman));
        }
        Ok(())
    }

    /// True if a chunk or a path can be sent. Also frees the chunks that the session no longer
    /// needs.
    pub(super) fn has_room(&mut self) -> bool {
        while let Some(done) = self.chunks.collect() {
            drop(done);
        }
        self.chunks.has_room()
    }

    pub(super) fn send(&mut self, goal: GoalId, chunk: Chunk) -> Result<(), TooManyChunks> {
        if !self.has_room() {
            return Err(TooManyChunks);
        }
        self.chunks.send(goal, chunk).map_err(|_| TooManyChunks)
    }

    /// Makes the arm brake, and ends the motion when the arm rests.
    pub(super) fn brake(&mut self) {
        self.newest.write(Goal {
            revision: self.current.revision + 1,
            ..self.current.at_rest(OnArrival::ReportAndFinish)
        });
    }

    /// Continues with `goal`. Returns the outcome of the previous goal, with the error `reason` if
    /// the arm has not reached it. Returns `None` if the session only held the arm there.
    pub(super) fn supersede(
        &mut self,
        goal: Goal,
        reason: MotionError,
    ) -> Option<(GoalId, Outcome)> {
        self.newest.write(goal);
        self.take_chunk_error();
        let previous = core::mem::replace(&mut self.current, goal).id;
        let cancelled = core::mem::take(&mut self.cancelled);
        let result = match &self.verdict {
            // The arm has reached a goal that has settled, regardless of what follows.
            Verdict::Settled(settled) if settled.goal == previous => {
                settled.result(&settled.counted, cancelled)
            }
            _ => Err(reason),
        };
        (self.owner.session() != Some(previous)).then_some((previous, result))
    }

    /// True if the motion still accepts goals.
    pub(super) fn goes_on(&self) -> bool {
        self.current.on_arrival != OnArrival::ReportAndFinish
    }

    /// Records that a goal of the session `engaged` has ended and that the arm is held from now on.
    /// Returns the goal's outcome, unless a caller has already received it.
    pub(super) fn reach(&mut self, engaged: GoalId, settled: &Settled) -> Option<Outcome> {
        let goal = self.current;
        if goal.id == engaged {
            // The goal was given up after its arrival, so the arm must not return there.
            if !matches!(settled.settlement, Settlement::Arrived(_)) {
                self.current.target = Target::Rest;
            }
            return None;
        }
        if settled.goal != goal.id {
            return None;
        }
        let reaction = goal.reaction.filter(|_| settled.reacted.is_some());
        let held = match settled.settlement {
            Settlement::Arrived(_) => Goal {
                target: reaction.map_or(goal.target, |reaction| reaction.then),
                along_path: false,
                on_arrival: OnArrival::Hold,
                reaction: None,
                ..goal
            },
            // The arm is not held at a goal that it did not reach.
            _ => goal.at_rest(OnArrival::Hold),
        };
        self.current = Goal {
            id: engaged,
            watchdog: None,
            round: None,
            ..held
        };
        let cancelled = core::mem::take(&mut self.cancelled);
        let result = settled.result(&settled.counted, cancelled);
        self.take_chunk_error();
        match (&result, &self.stream) {
            // Only goals that a caller awaits have a watchdog.
            (
                Err(error @ (MotionError::Held(lapse) | MotionError::Braked(lapse))),
                ChunkStream::Of { goal: of, .. },
            ) if goal.id == *of && !matches!(lapse, Lapse::Silent { .. }) => {
                self.stream = ChunkStream::GivenUp(error.clone());
            }
            _ => {}
        }
        Some(result)
    }

    /// Removes and returns the reason why a goal of chunks was given up, if it was not reported
    /// yet.
    pub(super) fn take_chunk_error(&mut self) -> Option<MotionError> {
        match core::mem::replace(&mut self.stream, ChunkStream::None) {
            ChunkStream::GivenUp(error) => Some(error),
            stream => {
                self.stream = stream;
                None
            }
        }
    }

    pub(super) fn end_of_engagement(&self, result: &Outcome) -> Option<(GoalId, Outcome)> {
        match (self.owner, result) {
            (Owner::Goal, _) => None,
            (Owner::Engaged(id), Ok(_)) => Some((id, Err(MotionError::Stopped))),
            (Owner::Engaged(id) | Owner::Disengaged(id), result) => Some((id, result.clone())),
        }
    }

    /// True if the current goal came too late for the motion. The motion then ended with an older
    /// goal, either as `Ok` or by a stop request to the robot (`told`).
    pub(super) fn came_too_late(&self, command: CommandSide, told: bool, ended: &Ended) -> bool {
        let Program::Target(session) = &ended.program else {
            return false;
        };
        let well =
            ended.ending == Ending::Finished && command == CommandSide::Ended(MoveStatus::Success);
        let stopped = told && command == CommandSide::Ended(MoveStatus::Preempted);
        (well || stopped)
            && session
                .last_goal()
                .is_some_and(|last| last != self.current.id)
    }

    /// Returns the outcome of the current goal after a motion that succeeded, if the session
    /// reported one.
    pub(super) fn outcome(&self, ended: &Ended) -> Option<Outcome> {
        let settled = match &self.verdict {
            Verdict::Open => return None,
            Verdict::BadTool => return Some(Err(GoalError::Tool.into())),
            Verdict::Settled(settled) => settled,
        };
        let released = match &ended.program {
            Program::Target(session) => session.released(),
            _ => None,
        };
        (settled.goal == self.current.id).then(|| {
            let result = settled.result(&Counted::of(ended), self.cancelled)?;
            Ok(MotionReport {
                released_error: released,
                ..result
            })
        })
    }

    /// Returns the outcome of the current goal after a motion that the robot was asked to stop,
    /// because the arm did not stop before. If the session has reported an outcome, returns that
    /// outcome. Otherwise returns a report if the goal was only a brake, and
    /// [`MotionError::Stopped`] if it was not.
    pub(super) fn outcome_of_stop(&self, ended: &Ended) -> Outcome {
        let brakes = self.current.target == Target::Rest && !self.goes_on() && !self.cancelled;
        self.outcome(ended).unwrap_or_else(|| {
            if !brakes {
                return Err(MotionError::Stopped);
            }
            let duration_ms = ended.statistics.duration_ms();
            Ok(MotionReport::new(&Counted::of(ended), duration_ms, None))
        })
    }
}

impl Settled {
    pub(super) fn result(&self, counted: &Counted, cancelled: bool) -> Outcome {
        let failed = |error: MotionError| match self.reacted {
            Some(reacted) => Err(error.after(reacted)),
            None => Err(error),
        };
        let final_error = match self.settlement {
            Settlement::Arrived(error) => Some(error),
            Settlement::AtRest if cancelled => return Err(MotionError::Stopped),
            Settlement::AtRest => None,
            Settlement::TargetNotReached(error) => {
                return failed(MotionError::TargetNotReached(error));
            }
            Settlement::Held(lapse) => return failed(MotionError::Held(lapse)),
            Settlement::Braked(lapse) => return failed(MotionError::Braked(lapse)),
            Settlement::Unstarted(fault) => return Err(fault.into()),
        };
        Ok(MotionReport {
            compensation: self.compensation,
            line_deviation: self.line_deviation,
            reacted: self.reacted,
            ..MotionReport::new(counted, self.duration_ms, final_error)
        })
    }
}
