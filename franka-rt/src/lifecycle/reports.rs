//! Reports from the command connection, the thread and the clock.

use core::time::Duration;

use franka_proto::{MoveStatus, Request, Violation};

use super::current_motion::{CommandSide, NEVER_SHOWN, ThreadSide, Work};
use super::ending::STILL_SHOWN;
use super::goal_progress::{Owner, Settled, Verdict};
use super::outcome::Counted;
use super::{
    CloseReason, END_TIMEOUT, Lifecycle, LifecyclePhase, MotionError, Output, START_TIMEOUT,
};
use crate::driver::{Event, MotionId, Order};
use crate::session::SessionEvent;
use crate::stats::MotionStatistics;

impl Lifecycle {
    /// Processes a reply to the `Move` of `motion`. Replies to motions that have ended are ignored.
    pub fn on_move_reply(&mut self, motion: MotionId, status: MoveStatus, now: Duration) {
        let Some(current) = self.current(motion) else {
            return;
        };
        match (status, current.command) {
            (MoveStatus::MotionStarted, CommandSide::Requested) => {
                current.command = CommandSide::Started;
                current.deadline = match current.thread {
                    ThreadSide::Armed => Some(now + START_TIMEOUT),
                    ThreadSide::Running => current.running_deadline(),
                    ThreadSide::Ended(_) => Some(now + END_TIMEOUT),
                };
            }
            (MoveStatus::MotionStarted, _) => {}
            (status, _) => {
                current.command = CommandSide::Ended(status);
                current.deadline = Some(now + END_TIMEOUT);
                if matches!(current.thread, ThreadSide::Armed) {
                    let order = Order::Disarm { motion };
                    self.outputs.push_back(Output::Order(order));
                }
            }
        }
        self.conclude(now);
    }

    /// Processes a reply to the `Move` of `motion` that could not be read. It is then unknown what
    /// the robot does. Therefore the arm is braked, the robot is asked to stop, and the goal
    /// resolves. New motions wait until states show that this motion has ended.
    pub fn on_move_violation(&mut self, motion: MotionId, violation: Violation, now: Duration) {
        if self.current(motion).is_some() {
            self.give_up(MotionError::Violation(violation), now);
        }
    }

    /// Processes an event of the thread.
    pub fn on_event(&mut self, event: Event, now: Duration) {
        match event {
            Event::Started { motion, .. } => {
                let Some(current) = self.current(motion) else {
                    return;
                };
                current.thread = ThreadSide::Running;
                if current.command == CommandSide::Started {
                    current.deadline = current.running_deadline();
                }
                let begun = match &current.work {
                    Work::Program(program) => Some(program.id),
                    Work::Goals(goals) => goals.owner.session(),
                };
                self.outputs.extend(begun.map(|id| Output::Began { id }));
            }
            Event::Program {
                motion,
                event,
                statistics,
            } => self.on_session_event(motion, event, statistics, now),
            Event::Failed { motion, failure } => {
                if let Some(current) = self.current(motion) {
                    current.failure = Some(failure.into());
                    self.send_stop(now);
                }
            }
            Event::Finishing { motion } => {
                if let Some(current) = self.current(motion) {
                    current.finishing = Some(now);
                    if current.command == CommandSide::Started {
                        current.deadline = current.running_deadline();
                    }
                }
            }
            Event::Ended(ended) => self.on_ended(ended, now),
            // If the silence ends a motion, another event reports it. A motion without an observer
            // continues.
            Event::LinkLost { .. } | Event::Unobserved { .. } => {}
        }
    }

    fn on_session_event(
        &mut self,
        motion: MotionId,
        event: SessionEvent,
        statistics: MotionStatistics,
        now: Duration,
    ) {
        let Some(current) = self.current(motion) else {
            return;
        };
        let Work::Goals(goals) = &mut current.work else {
            return;
        };
        match event {
            SessionEvent::Settled {
                goal,
                settlement,
                duration_ms,
                compensation,
                line_deviation,
                reacted,
            } => {
                let settled = Settled {
                    goal,
                    settlement,
                    duration_ms,
                    compensation,
                    line_deviation,
                    reacted,
                    counted: Counted {
                        statistics,
                        times: current.times.clone(),
                    },
                };
                match goals.owner {
                    Owner::Engaged(engaged) | Owner::Disengaged(engaged) if goals.goes_on() => {
                        let settled = goals.reach(engaged, &settled);
                        if let Some(result) = settled {
                            self.resolve(goal, result);
                        }
                    }
                    _ => goals.verdict = Verdict::Settled(settled),
                }
            }
            SessionEvent::BadTool => goals.verdict = Verdict::BadTool,
            SessionEvent::Restless => self.send_stop(now),
        }
    }

    /// Closes the lifecycle, because the command connection has ended. Every goal resolves with an
    /// error, and no motion starts any more.
    ///
    /// If the arm is on its way to a goal, it is braked as long as the thread runs: see
    /// [`Self::is_braking`]. If a program of the user moves the arm, no more commands are sent, and
    /// the robot stops the arm.
    pub fn on_connection_closed(&mut self, reason: CloseReason) {
        let closed = LifecyclePhase::Closed {
            reason: reason.clone(),
            braking: None,
        };
        let error = MotionError::ConnectionClosed { reason };
        let unfinished = match core::mem::replace(&mut self.phase, closed) {
            LifecyclePhase::UnderWay(mut current) => {
                let runs_goals = matches!(
                    (&current.work, &current.thread),
                    (Work::Goals(_), ThreadSide::Running)
                );
                let order = current.abandon();
                self.outputs.extend(order.map(Output::Order));
                self.resolve_work(current.work, &Err(error.clone()), &Err(error.clone()));
                runs_goals.then_some(current.motion)
            }
            LifecyclePhase::Abandoned { motion, .. } => Some(motion),
            LifecyclePhase::Closed { braking, .. } => braking,
            LifecyclePhase::Idle | LifecyclePhase::Stalled { .. } => None,
        };
        if let LifecyclePhase::Closed { braking, .. } = &mut self.phase {
            *braking = unfinished;
        }
        self.resolve_next(error.clone());
        self.fail_stops(&error);
    }

    /// Processes a stall: a thread that has borrowed the cycle has not run it for `silence`. With
    /// `None`, the thread runs the cycle again. During a stall, no state arrives and no motion can
    /// run. The current motion and the waiting motion are given up and resolve as
    /// [`MotionError::Stalled`].
    pub fn on_stall(&mut self, silence: Option<Duration>, now: Duration) {
        match (&self.phase, silence) {
            (
                LifecyclePhase::Idle
                | LifecyclePhase::UnderWay(_)
                | LifecyclePhase::Abandoned { .. },
                Some(silence),
            ) => {
                let error = MotionError::Stalled { silence };
                self.resolve_next(error.clone());
                self.give_up(error, now);
                let abandoned = match self.phase {
                    LifecyclePhase::Abandoned { motion, .. } => Some(motion),
                    _ => None,
                };
                self.phase = LifecyclePhase::Stalled { abandoned };
            }
            (&LifecyclePhase::Stalled { abandoned }, None) => {
                self.phase = match abandoned {
                    Some(motion) => LifecyclePhase::abandoned(motion, now),
                    None => LifecyclePhase::Idle,
                };
            }
            _ => {}
        }
    }

    /// Returns the time at which [`Self::on_time`] must be called if no other input arrives before.
    pub fn deadline(&self) -> Option<Duration> {
        let deadlines = [self.phase_deadline(), self.deadline_of_stops()];
        deadlines.into_iter().flatten().min()
    }

    fn phase_deadline(&self) -> Option<Duration> {
        match &self.phase {
            LifecyclePhase::UnderWay(current) => current.deadline,
            LifecyclePhase::Abandoned { deadline, .. } => deadline.as_ref().ok().copied(),
            LifecyclePhase::Idle
            | LifecyclePhase::Stalled { .. }
            | LifecyclePhase::Closed { .. } => None,
        }
    }

    /// Returns the error of a motion whose end was not seen, if no state has arrived for `silence`.
    /// Returns `None` if the silence is too short to matter. `turning` is true if the control
    /// thread has run during the silence.
    pub fn unseen(silence: Duration, turning: bool) -> Option<MotionError> {
        (silence >= END_TIMEOUT / 2).then_some(match turning {
            true => MotionError::LinkLost { silence },
            false => MotionError::Hung { silence },
        })
    }

    /// Postpones the deadlines of the current or abandoned motion, and of stops, that have passed
    /// by `now`.
    fn postpone(&mut self, now: Duration, until: Duration) {
        self.postpone_stops(now, until);
        if self.phase_deadline().is_none_or(|deadline| now < deadline) {
            return;
        }
        match &mut self.phase {
            LifecyclePhase::UnderWay(current) => current.deadline = Some(until),
            LifecyclePhase::Abandoned { deadline, .. } => *deadline = Ok(until),
            LifecyclePhase::Idle
            | LifecyclePhase::Stalled { .. }
            | LifecyclePhase::Closed { .. } => {}
        }
    }

    /// Processes a deadline that has passed by `now`. If neither robot nor thread has ended the
    /// motion, the robot is asked to stop it within [`END_TIMEOUT`]. Otherwise the motion is given
    /// up. If no state was seen, the motion resolves as [`unseen`](Self::unseen), but only after
    /// the link counts as lost.
    pub fn on_time(&mut self, now: Duration, unseen: Option<MotionError>) {
        if self.deadline().is_none_or(|deadline| now < deadline) {
            return;
        }
        if let Some(MotionError::LinkLost { silence }) = unseen
            && silence < self.link_timeout
        {
            return self.postpone(now, now + self.link_timeout - silence);
        }
        self.give_up_stops(now, unseen.as_ref());
        if self.phase_deadline().is_none_or(|deadline| now < deadline) {
            return;
        }
        let current = match (&mut self.phase, unseen) {
            (LifecyclePhase::UnderWay(_), Some(unseen)) => return self.give_up(unseen, now),
            (LifecyclePhase::UnderWay(current), None) => current,
            (LifecyclePhase::Abandoned { deadline, .. }, unseen) => {
                let why = unseen.unwrap_or(STILL_SHOWN);
                *deadline = Err(why.clone());
                return self.resolve_next(why);
            }
            (
                LifecyclePhase::Idle
                | LifecyclePhase::Stalled { .. }
                | LifecyclePhase::Closed { .. },
                _,
            ) => return,
        };
        let motion = current.motion;
        match (current.command, &current.thread) {
            (
                CommandSide::Requested | CommandSide::Started,
                ThreadSide::Armed | ThreadSide::Running,
            ) => {
                current.given_up = Some(match (current.command, &current.thread) {
                    (_, ThreadSide::Armed) => NEVER_SHOWN,
                    (CommandSide::Requested, _) => "the robot never answered the Move command",
                    _ => "the robot did not end the finished motion",
                });
                current.command = CommandSide::Cancelled;
                current.deadline = Some(now + END_TIMEOUT);
                let order = current.abandon();
                self.outputs.extend(order.map(Output::Order));
                self.send(motion, Request::StopMove);
            }
            (command, _) => {
                let what = match command {
                    CommandSide::Cancelled => "the robot neither ran nor stopped the motion",
                    CommandSide::Ended(_) => {
                        "the robot has ended the motion, but its states still show it"
                    }
                    CommandSide::Requested | CommandSide::Started => {
                        "the robot did not report how the motion ended"
                    }
                };
                self.give_up(MotionError::Protocol { what }, now);
            }
        }
    }
}
