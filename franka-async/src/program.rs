//! Programs: motions whose commands come from outside the control thread.

use franka_proto::MoveRequest;
use franka_rt::driver::Program;
use franka_rt::lifecycle::{MotionError, NewMotion, Outcome};
use franka_rt::session::GoalId;
use tokio::sync::oneshot;

use crate::cancel::CancelOnDrop;
use crate::input::{EndReply, Input, Replies, unserved};
use crate::robot::Robot;

impl Robot {
    /// Begins a program and waits until it runs. Returns the receiver of its outcome. Dropping the
    /// future stops the robot.
    ///
    /// # Errors
    /// Returns the reason why the motion ended before it ran.
    pub(crate) async fn begin_program(
        &self,
        id: GoalId,
        program: Program,
        request: MoveRequest,
    ) -> Result<oneshot::Receiver<Outcome>, MotionError> {
        let (began, begun) = oneshot::channel();
        let (ended, outcome) = oneshot::channel();
        self.send(Input::Begin {
            motion: NewMotion::Program {
                id,
                program,
                request: Box::new(request),
                ticket: None,
            }
            .into(),
            replies: Replies {
                began: Some(began),
                ended: EndReply::One(ended),
            },
        });
        let stop = CancelOnDrop::new(self, id);
        if begun.await.is_ok() {
            stop.defuse();
            return Ok(outcome);
        }
        // The program will never run, and the outcome contains the reason.
        let outcome = outcome.await.unwrap_or_else(unserved);
        stop.defuse();
        Err(outcome.err().unwrap_or(MotionError::Stopped))
    }
}
