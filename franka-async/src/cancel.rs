//! Cancelling and pausing of motions. Dropping the future of a motion cancels it.
//!
//! A motion towards goals brakes within the robot's limits, and so does a session before it ends. A
//! control function or a program ends because the robot is stopped. Each request is one input to
//! the bridge, which acts after `cancel` or `drop` has returned. The future of a
//! motion is `Moving`; its `Drop` is in `move_to`. Handles that cancel when dropped are in
//! `session`, `active_control` and `asynchronous_control`. `Lifecycle::cancel`, in
//! `franka_rt::lifecycle::goals`, decides what happens.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_rt::lifecycle::{NewMotion, Outcome};
use franka_rt::session::GoalId;
use tokio::sync::oneshot;
use tokio_util::sync::CancellationToken;

use crate::input::{Beginning, Input};
use crate::robot::{Robot, WeakRobot};

/// A handle with which any task can cancel a motion. An arm on its way to a goal brakes; for a
/// control function or a program, the robot is stopped. Clones cancel the same motion. A canceller
/// does not count as a handle of the robot: dropping the last [`Robot`] still brakes the arm and
/// closes the connection.
#[derive(Clone, Debug)]
pub struct Canceller {
    robot: WeakRobot,
    id: GoalId,
    cancelled: CancellationToken,
    /// True if the motion should pause. The lock is held while the request is sent.
    paused: Arc<Mutex<bool>>,
}

impl Canceller {
    pub(crate) fn new(robot: &Robot, id: GoalId) -> Self {
        Self {
            robot: robot.downgrade(),
            id,
            cancelled: CancellationToken::new(),
            paused: Arc::default(),
        }
    }

    /// Brakes the arm and cancels the motion, which resolves as
    /// [`MotionError::Stopped`](crate::MotionError::Stopped). A motion that has not begun never
    /// begins, and resolves in the same way when it is awaited. The call has no effect after the
    /// motion has ended or was superseded.
    pub fn cancel(&self) {
        self.cancelled.cancel();
        // If the robot is gone, its motions have been braked.
        if let Some(robot) = self.robot() {
            robot.cancel(self.id);
        }
    }

    /// Pauses or resumes the motion. A motion that has not begun will begin paused.
    pub(crate) fn set_paused(&self, paused: bool) {
        let mut wanted = self.lock_paused();
        *wanted = paused;
        // This input has no effect on a motion that has not begun.
        let goal = self.id;
        if let Some(robot) = self.robot() {
            robot.send(Input::Pause { goal, paused });
        }
    }

    fn lock_paused(&self) -> MutexGuard<'_, bool> {
        // Nothing panics while the lock is held.
        self.paused.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the robot, unless its last handle was dropped.
    pub(crate) fn robot(&self) -> Option<Robot> {
        self.robot.upgrade()
    }

    pub(crate) fn id(&self) -> GoalId {
        self.id
    }

    /// Begins `motion` on its robot, unless this canceller was already used. Returns the receiver
    /// of the outcome.
    pub(crate) fn begin(
        &self,
        robot: &Robot,
        mut motion: Beginning,
    ) -> Option<oneshot::Receiver<Outcome>> {
        if self.cancelled.is_cancelled() {
            return None;
        }
        // The lock makes a pause that comes now wait until the motion has been sent.
        let paused = self.lock_paused();
        if let NewMotion::Goal { goal, .. } = &mut motion.motion {
            goal.paused = *paused;
        }
        let outcome = robot.begin(motion);
        drop(paused);
        // `cancel` sets the token before it sends its input. If that input came before the motion,
        // it had no effect, but the token is already set here.
        if self.cancelled.is_cancelled() {
            robot.cancel(self.id);
        }
        Some(outcome)
    }
}

/// Cancels a motion when this value is dropped, unless it was defused.
pub(crate) struct CancelOnDrop<'a>(Option<(&'a Robot, GoalId)>);

impl<'a> CancelOnDrop<'a> {
    pub(crate) fn new(robot: &'a Robot, id: GoalId) -> Self {
        Self(Some((robot, id)))
    }

    pub(crate) fn defuse(mut self) {
        self.0 = None;
    }
}

impl Drop for CancelOnDrop<'_> {
    fn drop(&mut self) {
        if let Some((robot, id)) = self.0 {
            robot.cancel(id);
        }
    }
}
