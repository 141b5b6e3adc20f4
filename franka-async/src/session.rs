//! State that all handles of a session share.

use std::future::Future;
use std::sync::{Arc, OnceLock};

use franka_rt::lifecycle::{MotionError, Outcome, Tuning};
use franka_rt::session::{GoalId, Lapse, Pulse};
use tokio::sync::{oneshot, watch};

use crate::input::{Input, Waiting, unserved};
use crate::kept_tuning::KeptTuning;
use crate::link::Link;
use crate::robot::Robot;

/// A session of target control. Dropping it brakes the arm and ends the session.
#[derive(Debug)]
pub(crate) struct Session {
    robot: Robot,
    id: GoalId,
    tuning: KeptTuning,
    /// Joint positions at the start, `[rad]`, which are the default posture of goals.
    posture: OnceLock<[f64; 7]>,
    /// Pulse of the deadman to which the session is bound.
    pulse: Option<Arc<Pulse>>,
    /// Newest goal that was set without waiting.
    pub(crate) waiting: Waiting,
    ended: watch::Receiver<Option<Outcome>>,
}

impl Session {
    /// Returns the session `id`, whose outcome `ended` receives.
    pub(crate) fn new(
        robot: Robot,
        id: GoalId,
        tuning: Tuning,
        pulse: Option<Arc<Pulse>>,
        ended: watch::Receiver<Option<Outcome>>,
    ) -> Self {
        Self {
            robot,
            id,
            tuning: KeptTuning::new(tuning),
            posture: OnceLock::new(),
            pulse,
            waiting: Waiting::default(),
            ended,
        }
    }

    pub(crate) fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Returns the newest connection of the session's robot: the session's own, or a later one.
    pub(crate) fn link(&self) -> Arc<Link> {
        self.robot.link()
    }

    pub(crate) fn id(&self) -> GoalId {
        self.id
    }

    pub(crate) fn tuning(&self) -> &KeptTuning {
        &self.tuning
    }

    /// Stores the joint positions at the start of the session, if known.
    pub(crate) fn keep(&self, posture: Option<[f64; 7]>) {
        if let Some(posture) = posture {
            self.posture.get_or_init(|| posture);
        }
    }

    pub(crate) fn posture(&self) -> Option<[f64; 7]> {
        self.posture.get().copied()
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.ended.borrow().is_some()
    }

    /// Returns the error for a call after the end of the session.
    pub(crate) fn check(&self) -> Result<(), MotionError> {
        match &*self.ended.borrow() {
            None => Ok(()),
            Some(Ok(_)) => Err(MotionError::Disengaged),
            Some(Err(error)) => Err(error.clone()),
        }
    }

    /// Returns the errors of [`Self::check`]. Also returns the error for a goal while a stop is
    /// latched or a deadman holds the arm.
    pub(crate) fn check_goal(&self) -> Result<(), MotionError> {
        self.robot.supervisor().check_latch()?;
        self.check()?;
        match &self.pulse {
            Some(pulse) if pulse.is_silent() => Err(MotionError::Held(Lapse::Deadman)),
            _ => Ok(()),
        }
    }

    /// Waits for the end of the session and returns its outcome.
    pub(crate) fn ended(&self) -> impl Future<Output = Outcome> + Send + 'static {
        let (mut ended, robot) = (self.ended.clone(), self.robot.clone());
        async move {
            // A waiting caller keeps the connection open.
            let _robot = robot;
            match ended.wait_for(Option::is_some).await {
                Ok(outcome) => outcome.clone().expect("it was waited for"),
                Err(error) => unserved(error),
            }
        }
    }

    /// Sends an input to the bridge and waits for the reply.
    pub(crate) async fn ask(
        &self,
        input: impl FnOnce(oneshot::Sender<Result<(), MotionError>>) -> Input,
    ) -> Result<(), MotionError> {
        let (taken, reply) = oneshot::channel();
        let link = self.robot.send(input(taken));
        let reply = reply.await.unwrap_or_else(|_| Err(link.closed()));
        reply.map_err(|error| self.explain(error))
    }

    /// Replaces [`MotionError::Disengaged`] by the reason why the session ended, because the
    /// lifecycle knows only the last session of its connection. Calls after the end of the session
    /// and of its connection also return that reason.
    pub(crate) fn explain(&self, error: MotionError) -> MotionError {
        match (&*self.ended.borrow(), error) {
            (Some(Err(ended)), MotionError::Disengaged | MotionError::ConnectionClosed { .. }) => {
                ended.clone()
            }
            (_, error) => error,
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.robot.cancel(self.id);
    }
}
