//! One motion from its goal to the robot's last word on it, across the command connection and the thread.
//!
//! ```text
//!            submit                     both sides have ended
//!   Idle -------------> Active -------------------------------------> Idle (or the next goal)
//!                         |  command side: Requested -> Started -> Ended(status)
//!                         |  thread side:  Armed -> Running -> Ended(how)
//! ```
//!
//! The thread is told to arm before the `Move` goes out, so the first state of the motion finds it ready. The two sides
//! then report in any order; the motion is over when both have. Goals come and go meanwhile: a newer one supersedes the
//! older within the same motion, one that came too late for it gets a motion of its own.
//!
//! Inputs are `submit`, `update`, `close`, `cancel`, `stop` (from users), the `on_*` methods (from the command
//! connection, the thread and the clock); effects come out of [`Lifecycle::poll`]. No clock, socket or task in here:
//! `now` is an argument, counted from any fixed moment.

mod active;
mod outcome;

use core::time::Duration;
use std::collections::VecDeque;

use franka_model::Model;
use franka_proto::{
    MoveControllerMode, MoveRequest, MoveStatus, Request, RobotState, Version, Violation,
};

use crate::driver::{Ending, Event, Modes, MotionId, MotionStatistics, Order, Program};
use crate::session::{Goal, GoalError, GoalId, SessionEvent, Target, TargetSession, Then};
use crate::slot;

use active::{Active, CommandSide, Settled, ThreadSide, Waiting};
pub use outcome::{MotionError, MotionReport, Reflex};

/// Time for the robot to answer a `Move`, and to show the motion's modes after that.
pub const START_TIMEOUT: Duration = Duration::from_secs(5);

/// Time for the second of the two sides to end after the first has.
pub const END_TIMEOUT: Duration = Duration::from_secs(2);

/// Something to carry out, in the order given.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "a handful per motion, passed on at once"
)]
pub enum Output {
    /// Hand this to the thread.
    Order(Order),
    /// Send this on the command connection. Replies to `Move` come back through [`Lifecycle::on_move_reply`] with this
    /// motion; replies to other requests are not awaited.
    Send {
        /// The motion that it is about.
        motion: MotionId,
        /// The request.
        request: Request,
    },
    /// Tell whoever awaits this goal. Each goal that was taken is told exactly once.
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
    model: &'static Model,
    version: Version,
    phase: Phase,
    /// A goal that waits for the running motion to end.
    next: Option<Waiting>,
    motions: u64,
    outputs: VecDeque<Output>,
}

#[derive(Debug)]
enum Phase {
    Idle,
    Active(Box<Active>),
    /// The connection is gone, for this reason; nothing starts any more.
    Closed(String),
}

impl Lifecycle {
    /// For a robot of this model that speaks `version`.
    pub fn new(model: &'static Model, version: Version) -> Self {
        Self {
            model,
            version,
            phase: Phase::Idle,
            next: None,
            motions: 0,
            outputs: VecDeque::new(),
        }
    }

    /// Whether nothing moves and nothing waits to move.
    pub fn is_idle(&self) -> bool {
        matches!(self.phase, Phase::Idle | Phase::Closed(_)) && self.next.is_none()
    }

    /// Takes a goal, for a robot in `state`, and starts towards it or hands it to the running motion. It supersedes every
    /// goal before it. Its `id` has to be one that was never used before.
    ///
    /// # Errors
    /// [`MotionError::Goal`] for a goal that is not accepted, which leaves everything as it was;
    /// [`MotionError::ConnectionClosed`] after the connection was lost. Nothing is resolved in either case.
    pub fn submit(
        &mut self,
        goal: Goal,
        state: &RobotState,
        now: Duration,
    ) -> Result<(), MotionError> {
        if let Phase::Closed(reason) = &self.phase {
            return Err(MotionError::ConnectionClosed {
                reason: reason.clone(),
            });
        }
        goal.check(self.model, state)?;
        self.replace(
            Waiting {
                goal,
                cancelled: false,
            },
            MotionError::Superseded,
            now,
        );
        Ok(())
    }

    /// Moves the target of a goal under way, for a goal that follows a stream. Returns whether the goal is still the
    /// one being followed: one that was taken back is not, whatever was still on its way for it.
    ///
    /// # Errors
    /// [`GoalError`] for a target that is not accepted; the previous one stays.
    pub fn update(
        &mut self,
        id: GoalId,
        target: Target,
        state: &RobotState,
    ) -> Result<bool, GoalError> {
        self.amend(id, |goal| Goal { target, ..*goal }, Some(state))
    }

    /// Lets a goal that is held come to its end: the motion settles at the newest target and finishes.
    pub fn close(&mut self, id: GoalId) {
        let amended = self.amend(
            id,
            |goal| Goal {
                then: Then::Finish,
                ..*goal
            },
            None,
        );
        debug_assert!(amended.is_ok(), "only targets are checked");
    }

    /// Takes back a goal: an arm on its way to it is braked as by a stop, and the goal resolves as
    /// [`MotionError::Stopped`]. Without effect on a goal that is no longer the newest.
    pub fn cancel(&mut self, id: GoalId) {
        if let Some(next) = self.next.take_if(|next| next.goal.id == id) {
            return self.resolve(next.goal.id, Err(MotionError::Stopped));
        }
        let amended = self.amend(
            id,
            |goal| Goal {
                target: Target::Rest,
                then: Then::Finish,
                ..*goal
            },
            None,
        );
        debug_assert!(amended.is_ok(), "only targets are checked");
        if let Phase::Active(active) = &mut self.phase
            && active.current.goal.id == id
        {
            active.current.cancelled = true;
        }
    }

    /// Brakes whatever moves, as a goal of its own named `id`, which resolves once the arm rests and the motion has ended.
    /// The goals before it resolve as [`MotionError::Stopped`]. Returns false, and does nothing, if there is no motion.
    pub fn stop(&mut self, id: GoalId, now: Duration) -> bool {
        let Phase::Active(active) = &self.phase else {
            return false;
        };
        let goal = Goal {
            id,
            target: Target::Rest,
            then: Then::Finish,
            ..active.current.goal
        };
        self.replace(
            Waiting {
                goal,
                cancelled: false,
            },
            MotionError::Stopped,
            now,
        );
        true
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
                    ThreadSide::Running => None,
                    ThreadSide::Ended(_) => Some(now + END_TIMEOUT),
                };
            }
            (MoveStatus::MotionStarted, _) => {}
            (status, _) => {
                active.command = CommandSide::Ended(status);
                active.deadline = Some(now + END_TIMEOUT);
                if matches!(active.thread, ThreadSide::Armed) {
                    self.outputs
                        .push_back(Output::Order(Order::Disarm { motion }));
                }
            }
        }
        self.conclude(now);
    }

    /// Takes note that a reply to the `Move` of `motion` could not be read: nobody knows what the robot is doing, so the arm
    /// is braked, the robot told to stop, and the goal resolves.
    pub fn on_move_violation(&mut self, motion: MotionId, violation: Violation, now: Duration) {
        let Some(active) = self.active(motion) else {
            return;
        };
        if matches!(active.thread, ThreadSide::Armed) {
            self.outputs
                .push_back(Output::Order(Order::Disarm { motion }));
        }
        self.finish(now, Some(MotionError::Violation(violation)));
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
                    active.deadline = None;
                }
            }
            Event::Program {
                motion,
                event,
                statistics,
            } => self.on_session_event(motion, event, statistics),
            Event::Finishing { motion } => {
                if let Some(active) = self.active(motion)
                    && active.command == CommandSide::Started
                {
                    active.deadline = Some(now + END_TIMEOUT);
                }
            }
            Event::Ended(ended) => {
                let Some(active) = self.active(ended.motion) else {
                    return;
                };
                active.thread = ThreadSide::Ended(ended);
                active.deadline = Some(now + END_TIMEOUT);
                self.conclude(now);
            }
            // A motion that the silence ended has been told by its own event.
            Event::LinkLost { .. } => {}
        }
    }

    /// The command connection is gone: every goal resolves, an arm that moves is braked, nothing starts any more.
    pub fn on_connection_closed(&mut self, reason: &str) {
        let phase = core::mem::replace(&mut self.phase, Phase::Closed(reason.to_owned()));
        let error = MotionError::ConnectionClosed {
            reason: reason.to_owned(),
        };
        if let Phase::Active(mut active) = phase {
            active.brake();
            if matches!(active.thread, ThreadSide::Armed) {
                self.outputs.push_back(Output::Order(Order::Disarm {
                    motion: active.motion,
                }));
            }
            self.resolve(active.current.goal.id, Err(error.clone()));
        }
        if let Some(next) = self.next.take() {
            self.resolve(next.goal.id, Err(error));
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
                active.command = CommandSide::Cancelled;
                active.deadline = Some(now + END_TIMEOUT);
                active.brake();
                if matches!(active.thread, ThreadSide::Armed) {
                    self.outputs
                        .push_back(Output::Order(Order::Disarm { motion }));
                }
                self.outputs.push_back(Output::Send {
                    motion,
                    request: Request::StopMove,
                });
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

    fn resolve(&mut self, goal: GoalId, result: Result<MotionReport, MotionError>) {
        self.outputs.push_back(Output::Resolve { goal, result });
    }

    /// Puts a goal in the place of all others, which resolve with `reason`.
    fn replace(&mut self, waiting: Waiting, reason: MotionError, now: Duration) {
        if let Some(next) = self.next.take() {
            self.resolve(next.goal.id, Err(reason.clone()));
        }
        match &mut self.phase {
            Phase::Idle | Phase::Closed(_) => self.start(waiting, now),
            Phase::Active(active) if matches!(active.thread, ThreadSide::Ended(_)) => {
                self.next = Some(waiting)
            }
            Phase::Active(active)
                if matches!(
                    active.command,
                    CommandSide::Ended(_) | CommandSide::Cancelled
                ) =>
            {
                self.next = Some(waiting);
            }
            Phase::Active(active) => {
                active.slot.write(&waiting.goal);
                let previous = core::mem::replace(&mut active.current, waiting);
                let settled = active.settled.take();
                // A goal that has settled was reached, whatever comes after it.
                let result = match settled {
                    Some(settled) if settled.goal == previous.goal.id => {
                        settled.result(previous.cancelled)
                    }
                    _ => Err(reason),
                };
                self.resolve(previous.goal.id, result);
            }
        }
    }

    /// Changes a goal that has not been superseded. Returns whether there was one of that name.
    fn amend(
        &mut self,
        id: GoalId,
        change: impl FnOnce(&Goal) -> Goal,
        state: Option<&RobotState>,
    ) -> Result<bool, GoalError> {
        let waiting = match (&mut self.next, &mut self.phase) {
            (Some(next), _) if next.goal.id == id => next,
            (_, Phase::Active(active)) if active.current.goal.id == id => &mut active.current,
            _ => return Ok(false),
        };
        if waiting.cancelled {
            return Ok(false);
        }
        let goal = change(&waiting.goal);
        if let Some(state) = state {
            goal.check(self.model, state)?;
        }
        waiting.goal = goal;
        if let Phase::Active(active) = &mut self.phase
            && active.current.goal.id == id
        {
            active.slot.write(&goal);
        }
        Ok(true)
    }

    fn start(&mut self, waiting: Waiting, now: Duration) {
        self.motions += 1;
        let motion = MotionId(self.motions);
        let (mut writer, reader) = slot::slot();
        writer.write(&waiting.goal);
        let program = Program::Target(Box::new(TargetSession::new(self.model, reader)));
        let request = MoveRequest::new(
            MoveControllerMode::ExternalController,
            self.version.torque_generator(),
        );
        let modes = Modes {
            generator: request.generator.in_state(),
            controller: request.controller.in_state(),
        };
        self.outputs.push_back(Output::Order(Order::Arm {
            motion,
            modes,
            program,
        }));
        self.outputs.push_back(Output::Send {
            motion,
            request: Request::Move(request),
        });
        self.phase = Phase::Active(Box::new(Active {
            motion,
            slot: writer,
            current: waiting,
            settled: None,
            bad_tool: false,
            command: CommandSide::Requested,
            thread: ThreadSide::Armed,
            deadline: Some(now + START_TIMEOUT),
        }));
    }

    fn on_session_event(
        &mut self,
        motion: MotionId,
        event: SessionEvent,
        statistics: MotionStatistics,
    ) {
        let Some(active) = self.active(motion) else {
            return;
        };
        match event {
            SessionEvent::Settled {
                goal,
                settlement,
                duration_ms,
            } => {
                active.settled = Some(Settled {
                    goal,
                    settlement,
                    duration_ms,
                    statistics,
                });
            }
            SessionEvent::BadTool => active.bad_tool = true,
        }
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

    /// Ends the motion, with `error` for its goal or else by what the two sides have said. A robot that has not said that
    /// the motion is over is told to stop it, and a thread that goes on is told to brake.
    fn finish(&mut self, now: Duration, error: Option<MotionError>) {
        let Phase::Active(mut active) = core::mem::replace(&mut self.phase, Phase::Idle) else {
            return;
        };
        if matches!(
            active.command,
            CommandSide::Requested | CommandSide::Started
        ) {
            self.outputs.push_back(Output::Send {
                motion: active.motion,
                request: Request::StopMove,
            });
        }
        let (result, statistics) = match (error, &active.thread) {
            (Some(error), _) => {
                active.brake();
                (Err(error), MotionStatistics::default())
            }
            (None, ThreadSide::Ended(ended)) => {
                if active.came_too_late(ended) {
                    // The session had let go before it saw this goal: the goal gets a motion of its own.
                    debug_assert!(
                        self.next.is_none(),
                        "a newer goal would have taken its place"
                    );
                    return self.follow(active.current, &Ok(()), &ended.statistics, now);
                }
                (active.verdict(ended), ended.statistics)
            }
            (None, ThreadSide::Armed | ThreadSide::Running) => {
                unreachable!("a motion concludes when its thread side has ended")
            }
        };
        self.resolve(active.current.goal.id, result.clone());
        if let Some(next) = self.next.take() {
            self.follow(next, &result.map(drop), &statistics, now);
        }
    }

    /// Takes up a goal that waited for the motion before it, which has ended with `before`. If rest is all that it asks
    /// for, the end of that motion has brought it, and no motion is started to brake nothing.
    fn follow(
        &mut self,
        waiting: Waiting,
        before: &Result<(), MotionError>,
        statistics: &MotionStatistics,
        now: Duration,
    ) {
        if waiting.goal.target != Target::Rest || waiting.goal.then != Then::Finish {
            return self.start(waiting, now);
        }
        let result = match before {
            // Nobody knows, or the robot sees to it, whether the arm rests.
            Err(error)
                if !error.is_ready_for_more() && !matches!(error, MotionError::Rejected(_)) =>
            {
                Err(error.clone())
            }
            _ if waiting.cancelled => Err(MotionError::Stopped),
            _ => Ok(MotionReport::new(statistics, 0, None)),
        };
        self.resolve(waiting.goal.id, result);
    }
}
