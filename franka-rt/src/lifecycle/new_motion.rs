//! Motions that callers request. They are accepted or refused, kept waiting, and started here.

use core::time::Duration;
use std::sync::Arc;

use franka_proto::{MoveRequest, Request, RobotState};

use super::current_motion::{CommandSide, CurrentMotion, ThreadSide, Work};
use super::goal_progress::{Goals, Owner};
use super::programs::UserProgram;
use super::{Engagement, Lifecycle, LifecyclePhase, MotionError, Output, START_TIMEOUT};
use crate::control::Modes;
use crate::driver::{ControlLog, MotionId, Observer, Order, Program};
use crate::session::check::check_keep_out;
use crate::session::{
    self, Backend, Chunk, Goal, GoalError, GoalId, OnArrival, Target, TargetSession, TooManyChunks,
};
use crate::stats::MotionTimes;
use crate::together::StartTicket;
use crate::triple_buffer::triple_buffer;

/// A motion to begin. The id of its goal, or its own id, must never have been used before.
#[derive(Debug)]
pub enum NewMotion {
    /// A motion to a goal. It supersedes every earlier goal.
    Goal {
        /// The goal. Its `id` identifies the motion.
        goal: Box<Goal>,
        /// The path to the goal's target. The target is the end of the path.
        path: Option<Box<Chunk>>,
        /// Ticket of a common start with other robots, if any. The arm is held until all robots are
        /// ready. A goal with a ticket supersedes nothing. A later goal supersedes it as usual, and
        /// removes it from the common start.
        ticket: Option<StartTicket>,
        /// The session that the goal belongs to. `None` begins a separate motion.
        session: Option<GoalId>,
    },
    /// A session that holds the arm where it is, and then lasts from goal to goal. The motion
    /// resolves when the session has ended.
    Session {
        /// Gains and budget with which the arm is held. The goal's `id` identifies the session.
        goal: Box<Goal>,
        /// Options of the session in addition to its goals.
        engagement: Engagement,
    },
    /// A motion under a program of the user. It supersedes nothing and is not superseded.
    Program {
        /// Id of the motion.
        id: GoalId,
        /// Program that answers the states.
        program: Program,
        /// The motion to request from the robot.
        request: Box<MoveRequest>,
        /// Ticket of a common start with other robots, for a control function. Until all robots are
        /// ready, the driver holds the arm and does not call the function. Other programs do not
        /// wait.
        ticket: Option<StartTicket>,
    },
}

impl NewMotion {
    /// Returns a separate motion to `goal`.
    pub fn to(goal: Goal) -> Self {
        Self::Goal {
            goal: Box::new(goal),
            path: None,
            ticket: None,
            session: None,
        }
    }

    /// Returns the id with which the motion is cancelled and resolved.
    pub fn id(&self) -> GoalId {
        match self {
            Self::Goal { goal, .. } | Self::Session { goal, .. } => goal.id,
            Self::Program { id, .. } => *id,
        }
    }

    /// Returns the goal with which this host's law begins. Returns `None` for a program, and for a
    /// session under the robot's controller.
    pub(super) fn compliant_goal(&self) -> Option<&Goal> {
        match self {
            Self::Session { engagement, .. } if engagement.backend != Backend::Torques => None,
            Self::Goal { goal, .. } | Self::Session { goal, .. } => Some(goal),
            Self::Program { .. } => None,
        }
    }

    /// True if the motion is a goal for an existing session.
    pub(crate) fn is_within_a_session(&self) -> bool {
        matches!(
            self,
            Self::Goal {
                session: Some(_),
                ..
            }
        )
    }

    /// True if the motion begins together with motions of other robots.
    pub(crate) fn has_ticket(&self) -> bool {
        match self {
            Self::Goal { ticket, .. } | Self::Program { ticket, .. } => ticket.is_some(),
            Self::Session { .. } => false,
        }
    }

    pub(crate) fn is_superseded_by_goals(&self) -> bool {
        matches!(self, Self::Goal { .. })
    }

    pub(crate) fn supersedes_goals(&self) -> bool {
        matches!(self, Self::Goal { ticket: None, .. })
    }
}

impl Lifecycle {
    /// Begins a motion of a robot in `state`, or passes its goal to the current motion. If the
    /// current motion is ending, or was stopped or cancelled, the new motion waits for its end.
    ///
    /// # Errors
    /// After an error, nothing has been resolved or changed, and a ticket is dropped.
    /// - [`MotionError::Goal`] if a goal, a region or a posture is not accepted, or if there is no
    ///   room for a path because too many chunks are under way.
    /// - [`MotionError::Busy`] if another motion runs or waits and does not yield. A running motion
    ///   yields if it is ending, stopped or cancelled. Goals outside a session also yield to a new
    ///   goal without a ticket.
    /// - [`MotionError::Start`] if other motions of its common start will not arrive.
    /// - If the goal belongs to a session that has ended: [`MotionError::Disengaged`] if the end
    ///   was requested, otherwise the error that ended the session.
    /// - [`MotionError::Protocol`] if the previous motion was given up and the robot continues it.
    /// - [`MotionError::ConnectionClosed`] if the connection has ended.
    pub fn begin(
        &mut self,
        mut motion: NewMotion,
        state: &RobotState,
        now: Duration,
    ) -> Result<(), MotionError> {
        if let NewMotion::Goal { goal, path, .. } = &mut motion {
            goal.along_path = path.is_some();
            if let Some(path) = path {
                goal.target = path.target();
                self.check_room()?;
            }
        }
        match &mut motion {
            NewMotion::Goal {
                goal,
                path,
                ticket: None,
                session: Some(session),
            } => return self.submit_within(*session, **goal, path.take(), state),
            NewMotion::Session { goal, .. } => {
                **goal = Goal {
                    target: Target::Rest,
                    on_arrival: OnArrival::Hold,
                    watchdog: None,
                    ..**goal
                }
            }
            NewMotion::Goal { .. } | NewMotion::Program { .. } => {}
        }
        self.check_open()?;
        self.check_turn(&motion)?;
        self.check_options(&motion, state)?;
        if motion.compliant_goal().is_some()
            && let Some(known) = self.known.take()
        {
            self.learned = known.learned(&self.model, state);
        }
        match (&self.phase, motion) {
            (LifecyclePhase::Idle, motion) => self.start(motion, now),
            // A session that controls the arm is about to release it.
            (
                LifecyclePhase::UnderWay(_),
                NewMotion::Goal {
                    goal,
                    path,
                    ticket: None,
                    ..
                },
            ) if !self.is_engaged() => self.replace(*goal, path, MotionError::Superseded),
            (_, motion) => self.wait(motion, MotionError::Superseded),
        }
        Ok(())
    }

    fn check_room(&mut self) -> Result<(), GoalError> {
        match self.goals_mut().map(Goals::has_room) {
            Some(false) => Err(TooManyChunks.into()),
            Some(true) | None => Ok(()),
        }
    }

    /// Checks that the current motion and the waiting motion yield to `motion`.
    fn check_turn(&self, motion: &NewMotion) -> Result<(), MotionError> {
        let current_gives_way = match &self.phase {
            LifecyclePhase::UnderWay(current) => {
                current.is_letting_go() || motion.supersedes_goals() && current.takes_goals()
            }
            _ => true,
        };
        let next_gives_way = self
            .next
            .as_ref()
            .is_none_or(|next| motion.supersedes_goals() && next.is_superseded_by_goals());
        if current_gives_way && next_gives_way {
            Ok(())
        } else {
            Err(MotionError::Busy)
        }
    }

    fn check_options(&self, motion: &NewMotion, state: &RobotState) -> Result<(), MotionError> {
        match motion {
            NewMotion::Goal { goal, ticket, .. } => {
                check_ticket(ticket.as_ref())?;
                goal.check(&self.model, state)?;
            }
            NewMotion::Session { goal, engagement } => {
                goal.check(&self.model, state)?;
                engagement.check(goal, state)?;
            }
            NewMotion::Program { ticket, .. } => check_ticket(ticket.as_ref())?,
        }
        Ok(())
    }

    /// Makes a motion wait until the previous motion has ended. If another motion waits, that
    /// motion resolves with `reason`.
    pub(super) fn wait(&mut self, motion: NewMotion, reason: MotionError) {
        if let Some(before) = self.next.replace(motion) {
            self.resolve(before.id(), Err(reason));
        }
    }

    /// Sends [`Order::Arm`] to the thread and `Move` to the robot.
    pub(super) fn start(&mut self, motion: NewMotion, now: Duration) {
        match motion {
            NewMotion::Goal {
                goal, path, ticket, ..
            } => self.start_goal(*goal, path, ticket, None, now),
            NewMotion::Session { goal, engagement } => {
                self.start_goal(*goal, None, None, Some(engagement), now);
            }
            NewMotion::Program {
                id,
                program,
                request,
                ticket,
            } => {
                let stops = Vec::new();
                let work = Work::Program(UserProgram { id, stops });
                self.arm(work, program, *request, (ticket, None), now);
            }
        }
    }

    /// Starts a motion to a goal. With an `engagement`, the motion is a session that lasts from
    /// goal to goal.
    fn start_goal(
        &mut self,
        goal: Goal,
        path: Option<Box<Chunk>>,
        ticket: Option<StartTicket>,
        engagement: Option<Engagement>,
        now: Duration,
    ) {
        let (mut newest, reader) = triple_buffer();
        newest.write(goal);
        let mut session = TargetSession::new(self.model.clone(), self.version, reader)
            .out_of(self.keep_out)
            .knowing(self.learned);
        let (writer, reader) = session::chunk_ring();
        session = session.with_chunks(reader);
        let mut goals = Goals::new(goal, newest, writer);
        if let Some(path) = path
            && goal.along_path
        {
            // The ring is new, so it has room.
            let _ = goals.send(goal.id, *path);
        }
        let mut observer = None;
        if let Some(engagement) = engagement {
            goals.owner = Owner::Engaged(goal.id);
            goals.backend = engagement.backend;
            observer = engagement.observer;
            session = session.with_backend(goals.backend).going_on();
            if let Some(regions) = engagement.keep_out {
                // The regions were checked when the session was requested.
                session = session.out_of(check_keep_out(&regions).unwrap_or(self.keep_out));
            }
            if let Some(cap) = engagement.speed_cap {
                session = session.no_faster_than(cap);
            }
            if let Some(deadman) = engagement.deadman {
                goals.pulse = Some(deadman.pulse());
                session = session.bound_to(deadman);
            }
            if let Some(member) = engagement.team {
                session = session.in_team(member);
            }
        }
        let program = Program::Target(Box::new(session));
        let request = goals.backend.request(self.version);
        self.arm(
            Work::Goals(goals),
            program,
            request,
            (ticket, observer),
            now,
        );
    }

    fn arm(
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
        self.phase = LifecyclePhase::UnderWay(Box::new(CurrentMotion {
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
}

fn check_ticket(ticket: Option<&StartTicket>) -> Result<(), MotionError> {
    match ticket.and_then(StartTicket::fault) {
        Some(fault) => Err(fault.into()),
        None => Ok(()),
    }
}
