//! Programs of the user's: control functions and commands from outside, one per motion.

use core::time::Duration;

use franka_proto::{MoveRequest, Request};

use super::active::{CommandSide, Programmed, Work};
use super::{Lifecycle, MotionError, Phase};
use crate::control::{Callback, Failure};
use crate::driver::{MotionId, Program};
use crate::session::GoalId;
use crate::together::StartTicket;

impl Lifecycle {
    /// Starts the motion that `request` asks for under a program of the user's, as work named `id`,
    /// which resolves once the motion has ended. Its `id` has to be one that was never used before.
    ///
    /// # Errors
    /// [`MotionError::Busy`] while anything else controls the arm,
    /// [`MotionError::ConnectionClosed`] after the connection was lost. Nothing is resolved then.
    pub fn control(
        &mut self,
        id: GoalId,
        program: Program,
        request: MoveRequest,
        now: Duration,
    ) -> Result<(), MotionError> {
        self.begin_program(id, program, request, None, now)
    }

    /// Like [`Self::control`], for a control function that begins together with the motions of
    /// other robots. Until they are all there it is not called: the driver holds the arm.
    ///
    /// # Errors
    /// As [`Self::control`]; [`MotionError::Start`] if the others are not to come. The ticket is
    /// dropped in any of these cases.
    pub fn control_together(
        &mut self,
        id: GoalId,
        callback: Box<Callback>,
        request: MoveRequest,
        ticket: StartTicket,
        now: Duration,
    ) -> Result<(), MotionError> {
        let program = Program::Callback(callback);
        self.begin_program(id, program, request, Some(ticket), now)
    }

    fn begin_program(
        &mut self,
        id: GoalId,
        program: Program,
        request: MoveRequest,
        ticket: Option<StartTicket>,
        now: Duration,
    ) -> Result<(), MotionError> {
        self.check_free(ticket.as_ref())?;
        let work = Work::Program(Programmed {
            id,
            stops: Vec::new(),
        });
        self.start(work, program, request, (ticket, None), now);
        Ok(())
    }

    /// Whether a motion can begin that neither supersedes another one nor waits for its end.
    pub(super) fn check_free(&self, ticket: Option<&StartTicket>) -> Result<(), MotionError> {
        self.check_open()?;
        if !self.is_idle() {
            return Err(MotionError::Busy);
        }
        match ticket.and_then(StartTicket::fault) {
            Some(fault) => Err(fault.into()),
            None => Ok(()),
        }
    }

    /// Whether a program of the user's controls the arm.
    pub(super) fn runs_program(&self) -> bool {
        matches!(&self.phase, Phase::Active(active) if matches!(active.work, Work::Program(_)))
    }

    /// Has the robot stop the program of that name. Returns whether it is the one that runs.
    pub(super) fn cancel_program(&mut self, id: GoalId, now: Duration) -> bool {
        let named = self.program().is_some_and(|program| program.id == id);
        if named {
            self.send_stop(now);
        }
        named
    }

    /// Has the robot stop the program that runs, and `id` resolve when it has. Returns whether
    /// there is one.
    pub(super) fn stop_program(&mut self, id: GoalId, now: Duration) -> bool {
        let Some(program) = self.program() else {
            return false;
        };
        program.stops.push(id);
        self.send_stop(now);
        true
    }

    /// Takes note that the program of a motion could not go on, and has the robot stop.
    pub(super) fn on_failure(&mut self, motion: MotionId, failure: Failure, now: Duration) {
        if let Some(active) = self.active(motion) {
            active.failure = Some(failure.into());
            self.send_stop(now);
        }
    }

    fn program(&mut self) -> Option<&mut Programmed> {
        match &mut self.phase {
            Phase::Active(active) => match &mut active.work {
                Work::Program(program) => Some(program),
                Work::Goals(_) => None,
            },
            Phase::Idle | Phase::Closed(_) => None,
        }
    }

    /// Asks the robot to stop the motion under way, unless it has been asked or the motion is over
    /// for it. Its answer is not awaited: that the motion has ended is what counts, and a robot
    /// that goes on is told once more, then given up.
    fn send_stop(&mut self, now: Duration) {
        let Phase::Active(active) = &mut self.phase else {
            return;
        };
        let motion = active.motion;
        let open = matches!(
            active.command,
            CommandSide::Requested | CommandSide::Started
        );
        if open && active.stopped.is_none() {
            active.stopped = Some(now);
            let ending = active.running_deadline();
            active.deadline = active.deadline.or(ending);
            self.send(motion, Request::StopMove);
        }
    }
}
