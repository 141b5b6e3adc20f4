//! Programs of the user's: control functions and commands from outside, one per motion.

use core::time::Duration;

use franka_proto::Request;

use super::current_motion::Work;
use super::{Lifecycle, LifecyclePhase};
use crate::session::GoalId;

/// A motion under a program of the user's.
#[derive(Debug)]
pub(super) struct UserProgram {
    /// Names the caller that awaits its end.
    pub(super) id: GoalId,
    /// Other callers that asked for the end and await it.
    pub(super) stops: Vec<GoalId>,
}

impl Lifecycle {
    /// Stops the robot that runs the program of that name. Returns true if it is the current
    /// program.
    pub(super) fn cancel_program(&mut self, id: GoalId, now: Duration) -> bool {
        let named = self.program().is_some_and(|program| program.id == id);
        if named {
            self.send_stop(now);
        }
        named
    }

    /// Stops the robot that runs the current program; `id` resolves when it has stopped. Returns
    /// true if there is one.
    pub(super) fn stop_program(&mut self, id: GoalId, now: Duration) -> bool {
        let Some(program) = self.program() else {
            return false;
        };
        program.stops.push(id);
        self.send_stop(now);
        true
    }

    fn program(&mut self) -> Option<&mut UserProgram> {
        match &mut self.phase {
            LifecyclePhase::UnderWay(current) => match &mut current.work {
                Work::Program(program) => Some(program),
                Work::Goals(_) => None,
            },
            _ => None,
        }
    }

    /// Asks the robot to stop the motion under way, unless it has been asked or the motion is over
    /// for it. Its answer is not awaited; only the end of the motion counts. A robot that continues
    /// is asked once more, then given up.
    pub(super) fn send_stop(&mut self, now: Duration) {
        let LifecyclePhase::UnderWay(current) = &mut self.phase else {
            return;
        };
        let motion = current.motion;
        if current.is_open() && current.stopped.is_none() {
            current.stopped = Some(now);
            let ending = current.running_deadline();
            current.deadline = current.deadline.or(ending);
            self.send(motion, Request::StopMove);
        }
    }
}
