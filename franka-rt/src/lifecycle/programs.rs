//! Programs of the user: control functions, and commands from a thread of the user. Each program
//! has its own motion.

use core::time::Duration;

use franka_proto::Request;

use super::current_motion::Work;
use super::{Lifecycle, LifecyclePhase};
use crate::session::GoalId;

#[derive(Debug)]
pub(super) struct UserProgram {
    /// Id under which a caller awaits the program's end.
    pub(super) id: GoalId,
    /// Ids of other callers that requested the end and await it.
    pub(super) stops: Vec<GoalId>,
}

impl Lifecycle {
    /// Stops the robot if the current program has this id. Returns true if it has.
    pub(super) fn cancel_program(&mut self, id: GoalId, now: Duration) -> bool {
        let named = self.program().is_some_and(|program| program.id == id);
        if named {
            self.send_stop(now);
        }
        named
    }

    /// Stops the robot if it runs a program. `id` resolves when the robot has stopped. Returns true
    /// if there is a program.
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

    /// Asks the robot to stop the current motion, unless it was already asked or has ended the
    /// motion. The driver does not wait for the reply, only for the end of the motion. If the robot
    /// continues, it is asked once more, and then the motion is given up.
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
