//! The source of states: a connected robot, or a simulated robot that another program controls.

use std::sync::{Mutex, PoisonError};

use franka_async::Robot;
use franka_async::model::Model;
use franka_async::record::Bindings;
use franka_async::state::RobotState;

/// The data that the page shows for one moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) state: RobotState,
    /// This driver's reference joint positions, `[rad]`; `None` while this driver does not move the
    /// arm.
    pub(crate) reference: Option<[f64; 7]>,
    /// Guards (safety checks of the driver) that were active recently.
    pub(crate) guards: Bindings,
}

/// The source of states.
pub(crate) enum Source {
    /// A robot (real or simulated) to which this process is connected.
    Robot(Robot),
    /// A simulated robot that another program controls.
    Watched(Box<Watched>),
}

/// A simulated robot that another program controls.
pub(crate) struct Watched {
    /// Model from the simulated robot's description.
    model: Model,
    newest: Mutex<RobotState>,
}

impl Watched {
    pub(crate) fn new(model: Model, state: RobotState) -> Self {
        Self {
            model,
            newest: Mutex::new(state),
        }
    }

    pub(crate) fn set(&self, state: RobotState) {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = state;
    }
}

impl Source {
    pub(crate) fn newest(&self) -> Sample {
        match self {
            Self::Robot(robot) => {
                let reference = robot.reference();
                Sample {
                    state: robot.state(),
                    reference: reference.map(|reference| reference.q),
                    guards: reference.map_or(Bindings::default(), |reference| reference.guards),
                }
            }
            Self::Watched(watched) => Sample {
                state: *watched
                    .newest
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner),
                reference: None,
                guards: Bindings::default(),
            },
        }
    }

    pub(crate) fn model(&self) -> &Model {
        match self {
            Self::Robot(robot) => robot.model(),
            Self::Watched(watched) => &watched.model,
        }
    }

    pub(crate) fn robot(&self) -> Option<&Robot> {
        match self {
            Self::Robot(robot) => Some(robot),
            Self::Watched(_) => None,
        }
    }
}
