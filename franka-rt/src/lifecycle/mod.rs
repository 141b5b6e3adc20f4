//! One motion from its goal to the robot's last word on it, across the command connection and the
//! thread.
//!
//! ```text
//!            submit                     both sides have ended
//!   Idle -------------> Active -------------------------------------> Idle (or the next goal)
//!                         |  command side: Requested -> Started -> Ended(status)
//!                         |  thread side:  Armed -> Running -> Ended(how)
//! ```
//!
//! The thread is told to arm before the `Move` goes out, so the first state of the motion finds it
//! ready. The two sides then report in any order; the motion is over when both have. Goals come and
//! go meanwhile: a newer one supersedes the older within the same motion, one that came too late
//! for it gets a motion of its own. A program of the user's has the motion for itself.
//!
//! Inputs are `submit`, `update`, `close`, `control`, `cancel`, `stop` (from users), the `on_*`
//! methods (from the command connection, the thread and the clock); effects come out of
//! [`Lifecycle::poll`]. No clock, socket or task in here: `now` is an argument, counted from any
//! fixed moment.

mod active;
mod close_reason;
mod engagement;
mod goals;
mod outcome;
mod programs;
#[cfg(test)]
mod tests;

use core::time::Duration;
use std::collections::VecDeque;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::{MoveRequest, MoveStatus, Request, Version, Violation};

use crate::control::Modes;
use crate::driver::{ControlLog, Ending, Event, MotionId, Observer, Order, Program};
use crate::session::{GoalId, KeepOut};
use crate::stats::MotionTimes;
use crate::together::StartTicket;

use active::{Active, CommandSide, NEVER_SHOWN, Next, ThreadSide, Work};
pub use close_reason::CloseReason;
pub use engagement::{Engagement, Tuning};
use outcome::Counted;
pub use outcome::{ControlError, MotionError, MotionReport, Party, Stage};

/// Time for the robot to answer a `Move`, and to show the motion's modes after that.
pub const START_TIMEOUT: Duration = Duration::from_secs(5);

/// Time for the second of the two sides to end after the first has.
pub const END_TIMEOUT: Duration = Duration::from_secs(2);

/// Something to carry out, in the order given.
#[derive(Debug)]
pub enum Output {
    /// Hand this to the thread.
    Order(Order),
    /// Send this on the command connection. Replies to `Move` come back through
    /// [`Lifecycle::on_move_reply`] with this motion; replies to other requests are not awaited.
    Send {
        /// The motion that it is about.
        motion: MotionId,
        /// The request.
        request: Request,
    },
    /// Tell the caller that began this program or session, if it asked, that it runs now.
    Began {
        /// Its name.
        id: GoalId,
    },
    /// Tell the caller that awaits this goal. Each goal that was taken is told exactly once.
    Resolve {
        /// The goal.
        goal: GoalId,
        /// How it turned out.
        result: Result<MotionReport, MotionError>,
    },
}

/// The state machine. See the module's documentation.
#[derive(Debug)]
pub struct Lifecycle {
    model: Arc<Model>,
    version: Version,
    phase: Phase,
    /// What waits for the running motion to end.
    next: Option<Next>,
    /// The last session that goes from goal to goal, if it did not end as asked, and how it ended.
    ended: Option<(GoalId, MotionError)>,
    motions: u64,
    /// The motion that was given up in a stall, or is braked because the connection is gone, until
    /// the thread has ended it.
    unfinished: Option<MotionId>,
    /// Whether a thread that has borrowed the cycle does not run it.
    is_stalled: bool,
    /// Cycles that the log of a motion holds.
    log_size: usize,
    /// Regions that the arm keeps out of under target control.
    keep_out: KeepOut,
    outputs: VecDeque<Output>,
}

#[derive(Debug)]
enum Phase {
    Idle,
    Active(Box<Active>),
    /// The connection is gone, for this reason; nothing starts any more.
    Closed(CloseReason),
}

impl Lifecycle {
    /// For a robot of this model, whose limits goals have to keep, that speaks `version`.
    pub fn new(model: Arc<Model>, version: Version) -> Self {
        Self {
            model,
            version,
            phase: Phase::Idle,
            next: None,
            ended: None,
            motions: 0,
            unfinished: None,
            is_stalled: false,
            log_size: ControlLog::DEFAULT_CAPACITY,
            keep_out: KeepOut::default(),
            outputs: VecDeque::new(),
        }
    }

    /// Replaces the number of cycles that the log of a motion holds,
    /// [`ControlLog::DEFAULT_CAPACITY`] by default.
    #[must_use]
    pub fn with_log_size(mut self, cycles: usize) -> Self {
        self.log_size = cycles;
        self
    }

    /// Keeps the arm out of these regions under target control, from the next motion that starts.
    pub fn keep_out_of(&mut self, regions: KeepOut) {
        self.keep_out = regions;
    }

    /// Whether nothing moves and nothing waits to move.
    pub fn is_idle(&self) -> bool {
        matches!(self.phase, Phase::Idle | Phase::Closed(_)) && self.next.is_none()
    }

    /// Takes a reply to the `Move` of `motion`. Replies to motions that are over are ignored.
    pub fn on_move_reply(&mut self, motion: MotionId, status: MoveStatus, now: Duration) {
        let Some(active) = self.active(motion) else {
            return;
        };
        match (status, active.command) {
            (MoveStatus::MotionStarted, CommandSide::Requested) => {
                active.command = CommandSide::Started;
                active.deadline = match active.thread {
                    ThreadSide::Armed => Some(now + START_TIMEOUT),
                    ThreadSide::Running => active.running_deadline(),
                    ThreadSide::Ended(_) => Some(now + END_TIMEOUT),
                };
            }
            (MoveStatus::MotionStarted, _) => {}
            (status, _) => {
                active.command = CommandSide::Ended(status);
                active.deadline = Some(now + END_TIMEOUT);
                if matches!(active.thread, ThreadSide::Armed) {
                    self.disarm(motion);
                }
            }
        }
        self.conclude(now);
    }

    /// Takes note that a reply to the `Move` of `motion` could not be read: it is unknown what the
    /// robot is doing, so the arm is braked, the robot told to stop, and the goal resolves.
    pub fn on_move_violation(&mut self, motion: MotionId, violation: Violation, now: Duration) {
        if self.active(motion).is_some() {
            self.finish(now, Some(MotionError::Violation(violation)));
        }
    }

    /// Takes an event of the thread.
    pub fn on_event(&mut self, event: Event, now: Duration) {
        match event {
            Event::Started { motion, .. } => {
                let Some(active) = self.active(motion) else {
                    return;
                };
                active.thread = ThreadSide::Running;
                if active.command == CommandSide::Started {
                    active.deadline = active.running_deadline();
                }
                let begun = match &active.work {
                    Work::Program(program) => Some(program.id),
                    Work::Goals(goals) => goals.engaged.map(|engaged| engaged.id),
                };
                self.outputs.extend(begun.map(|id| Output::Began { id }));
            }
            Event::Program {
                motion,
                event,
                statistics,
            } => self.on_session_event(motion, event, statistics),
            Event::Failed { motion, failure } => self.on_failure(motion, failure, now),
            Event::Finishing { motion } => {
                if let Some(active) = self.active(motion) {
                    active.finishing = Some(now);
                    if active.command == CommandSide::Started {
                        active.deadline = active.running_deadline();
                    }
                }
            }
            Event::Ended(ended) => {
                self.unfinished.take_if(|motion| *motion == ended.motion);
                let Some(active) = self.active(ended.motion) else {
                    return;
                };
                active.thread = ThreadSide::Ended(ended);
                active.deadline = Some(now + END_TIMEOUT);
                self.conclude(now);
            }
            // A motion that the silence ended has an event of its own; one without an observer goes
            // on.
            Event::LinkLost { .. } | Event::Unobserved { .. } => {}
        }
    }

    /// The command connection is gone: every goal resolves and nothing starts any more.
    ///
    /// An arm on its way to a goal is braked, for as long as the thread goes on: see
    /// [`Self::is_braking`]. One that a program of the user's moves gets no more commands, and the
    /// robot stops it.
    pub fn on_connection_closed(&mut self, reason: CloseReason) {
        let phase = core::mem::replace(&mut self.phase, Phase::Closed(reason.clone()));
        let error = MotionError::ConnectionClosed { reason };
        if !matches!(phase, Phase::Closed(_)) {
            self.unfinished = None;
        }
        if let Phase::Active(mut active) = phase {
            let runs_goals = matches!(
                (&active.work, &active.thread),
                (Work::Goals(_), ThreadSide::Running)
            );
            self.unfinished = runs_goals.then_some(active.motion);
            let order = active.abandon();
            self.outputs.extend(order.map(Output::Order));
            self.resolve_work(active.work, &Err(error.clone()), &Err(error.clone()));
        }
        if let Some(next) = self.next.take() {
            self.resolve(next.waiting.goal.id, Err(error));
        }
    }

    /// Whether the thread is still needed after the end of the connection: to brake an arm that was
    /// on its way to a goal.
    pub fn is_braking(&self) -> bool {
        matches!(self.phase, Phase::Closed(_)) && self.unfinished.is_some()
    }

    /// Takes note that a thread that has borrowed the cycle has not run it for `silence`, or that
    /// it does again (`None`). Meanwhile no state arrives and no motion can run: the one under way
    /// is given up and resolves as [`MotionError::Stalled`], and none begins until the cycle has
    /// seen its end.
    pub fn on_stall(&mut self, silence: Option<Duration>, now: Duration) {
        self.is_stalled = silence.is_some();
        if let (Some(silence), Phase::Active(active)) = (silence, &self.phase) {
            let runs = matches!(active.thread, ThreadSide::Running);
            self.unfinished = runs.then_some(active.motion);
            self.finish(now, Some(MotionError::Stalled { silence }));
        }
    }

    /// When [`Self::on_time`] has to be called, if nothing else happens before.
    pub fn deadline(&self) -> Option<Duration> {
        match &self.phase {
            Phase::Active(active) => active.deadline,
            Phase::Idle | Phase::Closed(_) => None,
        }
    }

    /// Tells the time. A side of the motion that has not done its part by the deadline is given up.
    pub fn on_time(&mut self, now: Duration) {
        let Phase::Active(active) = &mut self.phase else {
            return;
        };
        if active.deadline.is_none_or(|deadline| now < deadline) {
            return;
        }
        let motion = active.motion;
        match (active.command, &active.thread) {
            (
                CommandSide::Requested | CommandSide::Started,
                ThreadSide::Armed | ThreadSide::Running,
            ) => {
                active.given_up = Some(match (active.command, &active.thread) {
                    (_, ThreadSide::Armed) => NEVER_SHOWN,
                    (CommandSide::Requested, _) => "the robot never answered the Move command",
                    _ => "the robot did not end a motion that was finished",
                });
                active.command = CommandSide::Cancelled;
                active.deadline = Some(now + END_TIMEOUT);
                let order = active.abandon();
                self.outputs.extend(order.map(Output::Order));
                self.send(motion, Request::StopMove);
            }
            (command, _) => {
                let what = match command {
                    CommandSide::Cancelled => "the robot neither ran the motion nor stopped it",
                    CommandSide::Ended(_) => {
                        "the robot has ended the motion but goes on showing it"
                    }
                    CommandSide::Requested | CommandSide::Started => {
                        "the robot never said how the motion ended"
                    }
                };
                self.finish(now, Some(MotionError::Protocol { what }));
            }
        }
    }

    /// The next effect to carry out.
    pub fn poll(&mut self) -> Option<Output> {
        self.outputs.pop_front()
    }

    fn active(&mut self, motion: MotionId) -> Option<&mut Active> {
        match &mut self.phase {
            Phase::Active(active) if active.motion == motion => Some(active),
            _ => None,
        }
    }

    fn check_open(&self) -> Result<(), MotionError> {
        match &self.phase {
            Phase::Closed(reason) => Err(MotionError::ConnectionClosed {
                reason: reason.clone(),
            }),
            Phase::Idle | Phase::Active(_) if self.is_stalled || self.unfinished.is_some() => {
                Err(MotionError::Busy)
            }
            Phase::Idle | Phase::Active(_) => Ok(()),
        }
    }

    fn send(&mut self, motion: MotionId, request: Request) {
        self.outputs.push_back(Output::Send { motion, request });
    }

    fn disarm(&mut self, motion: MotionId) {
        let order = Order::Disarm { motion };
        self.outputs.push_back(Output::Order(order));
    }

    /// Tells every caller that awaits a motion how it turned out; those who asked for its stop,
    /// whether it rests.
    fn resolve_work(
        &mut self,
        work: Work,
        result: &Result<MotionReport, MotionError>,
        rest: &Result<MotionReport, MotionError>,
    ) {
        match work {
            Work::Goals(goals) => {
                let end = goals.end_of_engagement(result);
                let current = goals.current.goal.id;
                if end.as_ref().is_none_or(|(engaged, _)| *engaged != current) {
                    self.resolve(current, result.clone());
                }
                self.resolve_session(goals.late, end);
            }
            Work::Program(program) => {
                self.resolve(program.id, result.clone());
                for stop in program.stops {
                    self.resolve(stop, rest.clone());
                }
            }
        }
    }

    /// Tells every caller that awaits the session of a motion how it turned out, and goals that
    /// came too late for it.
    fn resolve_session(
        &mut self,
        late: Vec<GoalId>,
        end: Option<(GoalId, Result<MotionReport, MotionError>)>,
    ) {
        let reason = match &end {
            Some((_, Err(error))) => error.clone(),
            _ => MotionError::Disengaged,
        };
        for goal in late {
            self.resolve(goal, Err(reason.clone()));
        }
        if let Some((engaged, result)) = end {
            if let Err(error) = &result {
                self.ended = Some((engaged, error.clone()));
            }
            self.resolve(engaged, result);
        }
    }

    fn resolve(&mut self, goal: GoalId, result: Result<MotionReport, MotionError>) {
        self.outputs.push_back(Output::Resolve { goal, result });
    }

    fn start(
        &mut self,
        work: Work,
        program: Program,
        request: MoveRequest,
        (ticket, observer): (Option<StartTicket>, Option<Observer>),
        now: Duration,
    ) {
        self.motions += 1;
        let motion = MotionId(self.motions);
        let times = Arc::new(MotionTimes::default());
        self.outputs.push_back(Output::Order(Order::Arm {
            motion,
            modes: Modes::of(&request),
            program,
            log: ControlLog::with_capacity(self.log_size),
            ticket,
            times: times.clone(),
            observer,
        }));
        self.send(motion, Request::Move(request));
        self.phase = Phase::Active(Box::new(Active {
            motion,
            work,
            command: CommandSide::Requested,
            thread: ThreadSide::Armed,
            deadline: Some(now + START_TIMEOUT),
            given_up: None,
            finishing: None,
            failure: None,
            stopped: None,
            times,
        }));
    }

    /// Ends the motion if both sides have.
    fn conclude(&mut self, now: Duration) {
        let Phase::Active(active) = &self.phase else {
            return;
        };
        let ThreadSide::Ended(ended) = &active.thread else {
            return;
        };
        let done = match ended.ending {
            Ending::LinkLost { .. } | Ending::Refused => true,
            Ending::Disarmed => !matches!(active.command, CommandSide::Requested),
            Ending::Finished | Ending::Aborted => matches!(active.command, CommandSide::Ended(_)),
        };
        if done {
            self.finish(now, None);
        }
    }

    /// Ends the motion, with `error` for its goal (or the failure of its program, from which
    /// everything else followed), or else by what the two sides have said. A robot that has not
    /// said that the motion is over is told to stop it, and a thread that goes on is told to brake
    /// or to fall silent.
    fn finish(&mut self, now: Duration, error: Option<MotionError>) {
        let Phase::Active(mut active) = core::mem::replace(&mut self.phase, Phase::Idle) else {
            return;
        };
        if matches!(
            active.command,
            CommandSide::Requested | CommandSide::Started
        ) {
            self.send(active.motion, Request::StopMove);
        }
        let (result, counted) = match (error, &active.thread) {
            (Some(error), _) => {
                let order = active.abandon();
                self.outputs.extend(order.map(Output::Order));
                let error = active.failure.take().unwrap_or(error);
                (Err(error), Counted::default())
            }
            (None, ThreadSide::Ended(ended)) => {
                if let Work::Goals(goals) = &active.work
                    && goals.came_too_late(active.command, ended)
                {
                    // The session had let go before it saw this goal: the goal gets a motion of its
                    // own.
                    let (current, counted) = (goals.current, Counted::of(ended));
                    let well = Ok(MotionReport::new(&counted, 0, None));
                    let end = goals.end_of_engagement(&well);
                    // The end of a session, as of its own goal, is told below.
                    let end = end.filter(|(engaged, _)| *engaged != current.goal.id);
                    self.resolve_session(goals.late.clone(), end);
                    let current = Next {
                        waiting: current,
                        engagement: None,
                    };
                    self.follow(current, &Ok(()), &counted, now);
                    // One that was taken back asked for nothing more.
                    if let Phase::Idle = self.phase
                        && let Some(next) = self.next.take()
                    {
                        self.follow(next, &Ok(()), &counted, now);
                    }
                    return;
                }
                let counted = Counted::of(ended);
                (active.verdict(&self.model), counted)
            }
            (None, ThreadSide::Armed | ThreadSide::Running) => {
                unreachable!("a motion concludes when its thread side has ended")
            }
        };
        let rest = match &result {
            Err(error) if !error.is_ready_for_more() => Err(error.clone()),
            _ => Ok(MotionReport::new(&counted, 0, None)),
        };
        self.resolve_work(active.work, &result, &rest);
        if let Some(next) = self.next.take() {
            self.follow(next, &result.map(drop), &counted, now);
        }
    }
}
