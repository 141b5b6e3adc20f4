//! Goals of target control: taken, changed, taken back, superseded.

use core::time::Duration;

use franka_proto::RobotState;

use super::active::{Engaged, Goals, Next, Settled, Waiting, Work};
use super::engagement::Engagement;
use super::outcome::Counted;
use super::{Lifecycle, MotionError, MotionReport, Phase};
use crate::driver::{MotionId, Program};
use crate::session::check::check_keep_out;
use crate::session::{
    self, Backend, Goal, GoalError, GoalId, OnArrival, SessionEvent, Target, TargetSession,
};
use crate::slot;
use crate::stats::MotionStatistics;
use crate::together::StartTicket;

impl Lifecycle {
    /// Takes a goal, for a robot in `state`, and starts towards it or hands it to the running
    /// motion. It supersedes every goal before it. Its `id` has to be one that was never used
    /// before.
    ///
    /// # Errors
    /// [`MotionError::Goal`] for a goal that is not accepted, which leaves everything as it was;
    /// [`MotionError::Busy`] while a program of the user's, or a session that goes from goal to
    /// goal, controls the arm; [`MotionError::ConnectionClosed`] after the connection was lost.
    /// Nothing is resolved in any of these cases.
    pub fn submit(
        &mut self,
        goal: Goal,
        state: &RobotState,
        now: Duration,
    ) -> Result<(), MotionError> {
        self.check_open()?;
        let engages = |next: &Next| next.engagement.is_some();
        if self.runs_program()
            || self.is_engaged_for_more()
            || self.next.as_ref().is_some_and(engages)
        {
            return Err(MotionError::Busy);
        }
        goal.check(&self.model, state)?;
        let waiting = Waiting::new(goal);
        if self.is_engaged() {
            // The session is about to let the arm go.
            self.wait(waiting, None, MotionError::Superseded);
        } else {
            self.replace(waiting, MotionError::Superseded, now);
        }
        Ok(())
    }

    /// Takes a goal that begins together with the motions of other robots: once all are there;
    /// until then the arm is held. It supersedes nothing. One that comes later supersedes it as
    /// usual, and takes it out of the common start.
    ///
    /// # Errors
    /// As [`Self::submit`]; [`MotionError::Busy`] while anything controls the arm;
    /// [`MotionError::Start`] if the others are not to come. The ticket is dropped in any of these
    /// cases.
    pub fn submit_together(
        &mut self,
        goal: Goal,
        ticket: StartTicket,
        state: &RobotState,
        now: Duration,
    ) -> Result<(), MotionError> {
        self.check_free(Some(&ticket))?;
        goal.check(&self.model, state)?;
        let waiting = Waiting::new(goal);
        self.start_goal(waiting, Some(ticket), None, now);
        Ok(())
    }

    /// Moves the target of a goal under way, for a goal that follows a stream. Returns whether the
    /// goal is still the one being followed: one that was taken back is not, whatever was still on
    /// its way for it.
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

    /// Lets a goal that is held come to its end: the motion settles at the newest target and
    /// finishes, unless its session goes on from goal to goal.
    pub fn close(&mut self, id: GoalId) {
        let on_arrival = self.end_of(id);
        let end = |goal: &Goal| Goal {
            target: match goal.target {
                Target::Guide(_) => Target::Rest, // Guiding has no target to hold.
                target => target,
            },
            on_arrival,
            ..*goal
        };
        let amended = self.amend(id, end, None);
        debug_assert!(amended.is_ok(), "only targets are checked");
    }

    /// Takes back a goal: an arm on its way to it is braked as by a stop, and the goal resolves as
    /// [`MotionError::Stopped`]. Without effect on a goal that is no longer the newest. A program
    /// is taken back in the same way, by having the robot stop.
    pub fn cancel(&mut self, id: GoalId, now: Duration) {
        if let Some(next) = self.next.take_if(|next| next.waiting.goal.id == id) {
            return self.resolve(next.waiting.goal.id, Err(MotionError::Stopped));
        }
        if self.cancel_program(id, now) || self.release(id, now) {
            return;
        }
        let on_arrival = self.end_of(id);
        let amended = self.amend(id, |goal| goal.at_rest(on_arrival), None);
        debug_assert!(amended.is_ok(), "only targets are checked");
        if let Some(goals) = self.goals()
            && goals.current.goal.id == id
        {
            goals.current.cancelled = true;
        }
    }

    /// Brakes whatever moves, as a goal of its own named `id`, which resolves once the arm rests
    /// and the motion has ended. The goals before it resolve as [`MotionError::Stopped`]. Returns
    /// false, and does nothing, if there is no motion.
    pub fn stop(&mut self, id: GoalId, now: Duration) -> bool {
        if self.stop_program(id, now) {
            // A session that waits for the program's end.
            if let Some(next) = self.next.take() {
                self.resolve(next.waiting.goal.id, Err(MotionError::Stopped));
            }
            return true;
        }
        let Some(goals) = self.goals() else {
            return false;
        };
        let goal = Goal {
            id,
            ..goals.current.goal.at_rest(OnArrival::ReportAndFinish)
        };
        self.replace(Waiting::new(goal), MotionError::Stopped, now);
        true
    }

    pub(super) fn on_session_event(
        &mut self,
        motion: MotionId,
        event: SessionEvent,
        statistics: MotionStatistics,
    ) {
        let Some(active) = self.active(motion) else {
            return;
        };
        let Work::Goals(goals) = &mut active.work else {
            return;
        };
        match event {
            SessionEvent::Settled {
                goal,
                settlement,
                duration_ms,
            } => {
                let settled = Settled {
                    goal,
                    settlement,
                    duration_ms,
                    counted: Counted {
                        statistics,
                        times: active.times.clone(),
                    },
                };
                match goals.engaged {
                    Some(engaged) if goals.goes_on() => {
                        let settled = goals.reach(engaged.id, &settled);
                        if let Some(result) = settled {
                            self.resolve(goal, result);
                        }
                    }
                    _ => goals.settled = Some(settled),
                }
            }
            SessionEvent::BadTool => goals.bad_tool = true,
        }
    }

    /// Takes up what waited for the motion before it, which has ended with `before`. If rest is all
    /// that it asks for, the end of that motion has brought it, and no motion is started to brake
    /// nothing.
    pub(super) fn follow(
        &mut self,
        Next {
            waiting,
            engagement,
        }: Next,
        before: &Result<(), MotionError>,
        counted: &Counted,
        now: Duration,
    ) {
        if waiting.goal.target != Target::Rest
            || waiting.goal.on_arrival != OnArrival::ReportAndFinish
        {
            return self.start_goal(waiting, None, engagement, now);
        }
        let result = match before {
            // Whether the arm rests is unknown, or up to the robot.
            Err(error)
                if !error.is_ready_for_more() && !matches!(error, MotionError::Rejected(_)) =>
            {
                Err(error.clone())
            }
            _ if waiting.cancelled => Err(MotionError::Stopped),
            _ => Ok(MotionReport::new(counted, 0, None)),
        };
        self.resolve(waiting.goal.id, result);
    }

    /// The goals of the motion under way, if target control runs it.
    pub(super) fn goals(&mut self) -> Option<&mut Goals> {
        match &mut self.phase {
            Phase::Active(active) => match &mut active.work {
                Work::Goals(goals) => Some(goals),
                Work::Program(_) => None,
            },
            Phase::Idle | Phase::Closed(_) => None,
        }
    }

    /// Puts a goal in the place of all others, which resolve with `reason`. No program may be
    /// running.
    pub(super) fn replace(&mut self, waiting: Waiting, reason: MotionError, now: Duration) {
        if let Some(next) = self.next.take() {
            self.resolve(next.waiting.goal.id, Err(reason.clone()));
        }
        let Phase::Active(active) = &mut self.phase else {
            return self.start_goal(waiting, None, None, now);
        };
        let ending = active.is_ending();
        match &mut active.work {
            Work::Goals(goals) if !ending => {
                goals.slot.write(&waiting.goal);
                let previous = core::mem::replace(&mut goals.current, waiting);
                let settled = goals.settled.take();
                // A goal that has settled was reached, whatever comes after it.
                let result = match settled {
                    Some(settled) if settled.goal == previous.goal.id => {
                        settled.result(&settled.counted, previous.cancelled)
                    }
                    _ => Err(reason),
                };
                if goals
                    .engaged
                    .is_none_or(|engaged| engaged.id != previous.goal.id)
                {
                    self.resolve(previous.goal.id, result);
                }
            }
            Work::Goals(_) | Work::Program(_) => self.wait(waiting, None, reason),
        }
    }

    /// Has a goal wait until the motion under way has ended. One that waited before it resolves
    /// with `reason`.
    pub(super) fn wait(
        &mut self,
        waiting: Waiting,
        engagement: Option<Engagement>,
        reason: MotionError,
    ) {
        let next = Next {
            waiting,
            engagement,
        };
        if let Some(before) = self.next.replace(next) {
            self.resolve(before.waiting.goal.id, Err(reason));
        }
    }

    /// Changes a goal that has not been superseded. Returns whether there was one of that name.
    pub(super) fn amend(
        &mut self,
        id: GoalId,
        change: impl FnOnce(&Goal) -> Goal,
        state: Option<&RobotState>,
    ) -> Result<bool, GoalError> {
        let model = self.model.clone();
        let (waiting, slot, backend) = match &mut self.next {
            Some(next) if next.waiting.goal.id == id => (&mut next.waiting, None, Backend::Torques),
            _ => match self.goals() {
                Some(goals) if goals.current.goal.id == id => {
                    (&mut goals.current, Some(&mut goals.slot), goals.backend)
                }
                _ => return Ok(false),
            },
        };
        if waiting.cancelled {
            return Ok(false);
        }
        let goal = Goal {
            revision: waiting.goal.revision + 1,
            ..change(&waiting.goal)
        };
        if let Some(state) = state {
            goal.check(&model, state)?;
            backend.check(&goal)?;
        }
        waiting.goal = goal;
        if let Some(slot) = slot {
            slot.write(&goal);
        }
        Ok(true)
    }

    /// Starts a motion towards a goal; of a session that goes on from goal to goal if `engagement`
    /// tells of one.
    pub(super) fn start_goal(
        &mut self,
        waiting: Waiting,
        ticket: Option<StartTicket>,
        engagement: Option<Engagement>,
        now: Duration,
    ) {
        let (mut slot, reader) = slot::slot();
        slot.write(&waiting.goal);
        let mut session =
            TargetSession::new(self.model.clone(), self.version, reader).out_of(self.keep_out);
        let (mut backend, mut observer, mut chunks) = (Backend::default(), None, None);
        let engaged = engagement.is_some().then_some(Engaged {
            id: waiting.goal.id,
            disengaged: false,
        });
        if let Some(engagement) = engagement {
            (backend, observer) = (engagement.backend, engagement.observer);
            let (writer, reader) = session::chunk_ring();
            chunks = Some(writer);
            session = session.with_backend(backend).with_chunks(reader).going_on();
            if let Some(regions) = engagement.keep_out {
                // Checked where the session was asked for.
                session = session.out_of(check_keep_out(&regions).unwrap_or(self.keep_out));
            }
            if let Some(deadman) = engagement.deadman {
                session = session.bound_to(deadman);
            }
        }
        let program = Program::Target(Box::new(session));
        let request = backend.request(self.version);
        let work = Work::Goals(Goals {
            slot,
            current: waiting,
            settled: None,
            bad_tool: false,
            engaged,
            backend,
            chunks,
            chunk_goal: GoalId::default(),
            late: Vec::new(),
        });
        self.start(work, program, request, (ticket, observer), now);
    }
}
