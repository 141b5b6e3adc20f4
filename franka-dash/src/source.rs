//! Where states come from: a connected robot, or a simulated one that another program controls.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use franka_async::Robot;
use franka_async::model::{Model, RobotKind};
use franka_async::state::RobotState;
use franka_sim::{Running, TouchId};

use crate::disturbance::Disturbance;

/// What the page shows of one moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) state: RobotState,
    /// Joint positions that this driver has the arm at, `[rad]`; `None` while it moves nothing.
    pub(crate) reference: Option<[f64; 7]>,
}

/// Where states come from.
pub(crate) enum Source {
    /// A robot that this process is connected to, simulated or not.
    Robot(Robot),
    /// A simulated robot whose client is another program.
    Watched(Box<Watched>),
}

/// A simulated robot whose client is another program.
pub(crate) struct Watched {
    model: &'static Model,
    newest: Mutex<RobotState>,
}

impl Watched {
    pub(crate) fn new(kind: RobotKind, state: RobotState) -> Self {
        Self {
            model: Model::of(kind),
            newest: Mutex::new(state),
        }
    }
}

impl Source {
    pub(crate) fn newest(&self) -> Sample {
        match self {
            Self::Robot(robot) => Sample {
                state: robot.state(),
                reference: robot.reference().map(|reference| reference.q),
            },
            Self::Watched(watched) => Sample {
                state: *watched
                    .newest
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner),
                reference: None,
            },
        }
    }

    pub(crate) fn model(&self) -> &Model {
        match self {
            Self::Robot(robot) => robot.model(),
            Self::Watched(watched) => watched.model,
        }
    }

    pub(crate) fn robot(&self) -> Option<&Robot> {
        match self {
            Self::Robot(robot) => Some(robot),
            Self::Watched(_) => None,
        }
    }
}

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
        let job = move |robot: &mut franka_sim::Robot| {
            let mut pushing = pushing.lock().unwrap_or_else(PoisonError::into_inner);
            disturbance.apply(robot, &mut pushing);
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

impl Watched {
    pub(crate) fn set(&self, state: RobotState) {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = state;
    }
}
