//! The end of a motion: its goals resolve, and the waiting motion begins.

use core::time::Duration;

use franka_proto::Request;

use super::current_motion::{CommandSide, ThreadSide, Work};
use super::outcome::{Counted, Outcome};
use super::{Lifecycle, LifecyclePhase, MotionError, MotionReport, NewMotion, Output};
use crate::driver::{Ended, Ending, Program};
use crate::session::{GoalId, OnArrival, Target};

/// Reason why no motion begins: the previous motion was given up, but the robot still runs it.
pub(super) const STILL_SHOWN: MotionError = MotionError::Protocol {
    what: "the robot's states still show the previous motion, which it was asked to stop",
};

impl Lifecycle {
    pub(super) fn on_ended(&mut self, ended: Ended, now: Duration) {
        if let Program::Target(session) = &ended.program {
            self.learned = session.learned();
        }
        match &mut self.phase {
            LifecyclePhase::UnderWay(current) if current.motion == ended.motion => {
                current.thread = ThreadSide::Ended(ended);
                current.deadline = Some(now + super::END_TIMEOUT);
                self.conclude(now);
            }
            LifecyclePhase::Abandoned { motion, .. } if *motion == ended.motion => {
                self.phase = LifecyclePhase::Idle;
                let before = match ended.ending {
                    Ending::LinkLost { silence } => Err(MotionError::LinkLost { silence }),
                    _ => Ok(()),
                };
                self.follow(&before, &Counted::of(&ended), now);
            }
            LifecyclePhase::Stalled { abandoned: motion }
            | LifecyclePhase::Closed {
                braking: motion, ..
            } => {
                motion.take_if(|motion| *motion == ended.motion);
            }
            LifecyclePhase::Idle
            | LifecyclePhase::UnderWay(_)
            | LifecyclePhase::Abandoned { .. } => {}
        }
    }

    /// Ends the motion if the thread has ended it and no more replies are expected on the command
    /// connection.
    pub(super) fn conclude(&mut self, now: Duration) {
        let LifecyclePhase::UnderWay(current) = &self.phase else {
            return;
        };
        let ThreadSide::Ended(ended) = &current.thread else {
            return;
        };
        let done = match ended.ending {
            Ending::LinkLost { .. } | Ending::Refused => true,
            Ending::Disarmed => !matches!(current.command, CommandSide::Requested),
            Ending::Finished | Ending::Aborted => matches!(current.command, CommandSide::Ended(_)),
        };
        if done {
            self.finish(now);
        }
    }

    /// Resolves the motion, which robot and thread have ended, according to their reports. If the
    /// robot has not reported the end of the motion, asks the robot to stop it.
    fn finish(&mut self, now: Duration) {
        let Some(mut current) = self.take_current() else {
            return;
        };
        let ThreadSide::Ended(ended) = &mut current.thread else {
            unreachable!("a motion concludes when its thread side has ended")
        };
        let counted = Counted::of(ended);
        let told = current.stopped.is_some() && current.failure.is_none();
        if let Work::Goals(goals) = &current.work
            && goals.came_too_late(current.command, told, ended)
        {
            // The session had ended before it saw this goal: the goal gets its own motion.
            let unseen = goals.current;
            let end = goals.end_of_engagement(&Ok(MotionReport::new(&counted, 0, None)));
            // If the unseen goal is the session's own goal, its end is resolved below.
            let end = end.filter(|(engaged, _)| *engaged != unseen.id);
            self.resolve_session(goals.after_end.clone(), end);
            if goals.cancelled {
                // A cancelled goal needs no motion.
                self.resolve(unseen.id, Err(MotionError::Stopped));
            } else {
                let path = match &mut ended.program {
                    Program::Target(session) => session.take_path(unseen.id),
                    _ => None,
                };
                let motion = NewMotion::Goal {
                    goal: Box::new(unseen),
                    path: path.map(Box::new),
                    ticket: None,
                    session: None,
                };
                self.take_up(motion, &Ok(()), &counted, now);
            }
            return self.follow(&Ok(()), &counted, now);
        }
        let outcome = current.verdict(&self.model);
        self.tell(current.work, outcome, &counted, now);
    }

    /// Gives up the current motion, if any, and resolves it at once. If its program failed before,
    /// the motion resolves with that failure, otherwise with `error`. Sends `StopMove` unless the
    /// robot has reported the end. If the thread still runs the motion, it brakes (for goals) or
    /// sends no more commands (for programs).
    pub(super) fn give_up(&mut self, error: MotionError, now: Duration) {
        let Some(mut current) = self.take_current() else {
            return;
        };
        if let Some(order) = current.abandon() {
            self.outputs.push_back(Output::Order(order));
            self.phase = LifecyclePhase::abandoned(current.motion, now);
        }
        let error = current.failure.unwrap_or(error);
        self.tell(current.work, Err(error), &Counted::default(), now);
    }

    /// Removes and returns the current motion. Sends `StopMove` unless the robot has reported its
    /// end.
    fn take_current(&mut self) -> Option<Box<super::current_motion::CurrentMotion>> {
        self.phase = match core::mem::replace(&mut self.phase, LifecyclePhase::Idle) {
            LifecyclePhase::UnderWay(current) => {
                if current.is_open() {
                    self.send(current.motion, Request::StopMove);
                }
                return Some(current);
            }
            phase => phase,
        };
        None
    }

    /// Resolves everything that waits for the motion with `outcome`. Then starts the next motion.
    fn tell(&mut self, work: Work, outcome: Outcome, counted: &Counted, now: Duration) {
        let rest = match &outcome {
            Err(error) if !error.is_ready_for_more() => Err(error.clone()),
            _ => Ok(MotionReport::new(counted, 0, None)),
        };
        self.resolve_work(work, &outcome, &rest);
        self.follow(&outcome.map(drop), counted, now);
    }

    /// Starts the waiting motion, if any, once no other motion is running. `before` is the outcome
    /// of the previous motion.
    fn follow(&mut self, before: &Result<(), MotionError>, counted: &Counted, now: Duration) {
        if let LifecyclePhase::Idle = self.phase
            && let Some(next) = self.next.take()
        {
            self.take_up(next, before, counted, now);
        }
    }

    /// Begins `motion` after another motion, which ended with `before`. If `motion` only asks the
    /// arm to stop, starts no motion, and resolves it at once with that outcome.
    fn take_up(
        &mut self,
        motion: NewMotion,
        before: &Result<(), MotionError>,
        counted: &Counted,
        now: Duration,
    ) {
        match &motion {
            NewMotion::Goal { goal, .. }
                if goal.target == Target::Rest && goal.on_arrival == OnArrival::ReportAndFinish => {
            }
            _ => return self.start(motion, now),
        }
        let outcome = match before {
            // Either it is unknown whether the arm rests, or the robot decides it.
            Err(error)
                if !error.is_ready_for_more() && !matches!(error, MotionError::Rejected(_)) =>
            {
                Err(error.clone())
            }
            _ => Ok(MotionReport::new(counted, 0, None)),
        };
        self.resolve(motion.id(), outcome);
    }

    /// Resolves everything that waits for the end of a motion. The goals or the program resolve
    /// with `outcome`; requests to stop resolve with `rest`.
    pub(super) fn resolve_work(&mut self, work: Work, outcome: &Outcome, rest: &Outcome) {
        match work {
            Work::Goals(goals) => {
                let end = goals.end_of_engagement(outcome);
                let current = goals.current.id;
                if end.as_ref().is_none_or(|(engaged, _)| *engaged != current) {
                    self.resolve(current, outcome.clone());
                }
                self.resolve_session(goals.after_end, end);
            }
            Work::Program(program) => {
                self.resolve(program.id, outcome.clone());
                for stop in program.stops {
                    self.resolve(stop, rest.clone());
                }
            }
        }
    }

    /// Resolves the session of a motion, and the goals that arrived after the session's end.
    fn resolve_session(&mut self, after_end: Vec<GoalId>, end: Option<(GoalId, Outcome)>) {
        let reason = match &end {
            Some((_, Err(error))) => error.clone(),
            _ => MotionError::Disengaged,
        };
        for goal in after_end {
            self.resolve(goal, Err(reason.clone()));
        }
        if let Some((engaged, outcome)) = end {
            if let Err(error) = &outcome {
                self.ended = Some((engaged, error.clone()));
            }
            self.resolve(engaged, outcome);
        }
    }

    pub(super) fn resolve_next(&mut self, error: MotionError) {
        if let Some(next) = self.next.take() {
            self.resolve(next.id(), Err(error));
        }
    }

    pub(super) fn resolve(&mut self, goal: GoalId, result: Outcome) {
        if let Some(result) = self.share_with_stops(goal, result) {
            self.outputs.push_back(Output::Resolve { goal, result });
        }
    }
}
