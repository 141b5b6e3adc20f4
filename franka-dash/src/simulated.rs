//! The simulated robot that viewers disturb.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use franka_async::model::Frame;
use franka_async::nalgebra::Vector3;
use franka_async::state::{RobotError, RobotState};
use franka_sim::{Robot, Running, Touch, TouchId};

use crate::request::{Disturbance, PUSH_MS};

/// The simulated robot to disturb.
#[derive(Clone)]
pub(crate) struct Simulated {
    running: Arc<Running>,
    pushing: Arc<Mutex<Option<TouchId>>>,
}

impl Simulated {
    pub(crate) fn new(running: Arc<Running>) -> Self {
        Self {
            running,
            pushing: Arc::default(),
        }
    }

    /// Disturbs it. Nothing happens once the simulation has stopped.
    pub(crate) async fn disturb(&self, disturbance: Disturbance) {
        let pushing = self.pushing.clone();
        let job = move |robot: &mut Robot| {
            let mut pushing = pushing.lock().unwrap_or_else(PoisonError::into_inner);
            apply(disturbance, robot, &mut pushing);
        };
        if let Err(error) = self.running.with(job).await {
            tracing::debug!(%error, "not disturbed");
        }
    }

    /// Copies the newest state to `watched`, as often as the page wants it. Ends with the
    /// simulation.
    pub(crate) async fn copy_to(&self, watched: impl Fn(RobotState) -> bool) {
        let mut clock = tokio::time::interval(Duration::from_millis(10));
        clock.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        loop {
            clock.tick().await;
            match self.running.state().await {
                Ok(state) if watched(state) => {}
                _ => return,
            }
        }
    }
}

/// Does what was [checked](crate::request::Request::check). `pushing` is the push that may still go
/// on.
fn apply(disturbance: Disturbance, robot: &mut Robot, pushing: &mut Option<TouchId>) {
    match disturbance {
        Disturbance::Push {
            link,
            offset,
            force,
        } => {
            let push = Touch::force(Vector3::from(force))
                .at(Frame::ALL[link - 1])
                .offset(Vector3::from(offset))
                .lasting(PUSH_MS);
            if let Some(before) = pushing.replace(robot.touch(push)) {
                robot.release(before);
            }
        }
        Disturbance::UserStop { pressed } => robot.press_user_stop(pressed),
        Disturbance::Guide { pressed } => {
            robot.guide(pressed);
        }
        Disturbance::Brakes { closed: true } => robot.close_brakes(),
        Disturbance::Brakes { closed: false } => robot.open_brakes(),
        Disturbance::Reflex {} => robot.trip(RobotError::CartesianReflex),
    }
}
