//! What the world outside asks of the driver.

use std::sync::Arc;

use franka_proto::{ControllerMode, MotionGeneratorMode, MoveRequest, RobotState};

use crate::driver::{ControlLog, MotionTimes, Observer, Program};
use crate::together::StartTicket;

/// Names one motion for the life of a driver, from arming to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MotionId(pub u64);

/// An order into the thread. Orders cross in a bounded queue and are never lost or reordered.
#[derive(Debug)]
pub enum Order {
    /// Watch for `modes`, then answer every state with `program`. Comes before the `Move` goes out
    /// on TCP.
    Arm {
        /// The motion that this begins.
        motion: MotionId,
        /// The modes in which the robot runs it.
        modes: Modes,
        /// What answers the states.
        program: Program,
        /// Where its last cycles are noted; empty.
        log: ControlLog,
        /// Of a motion that begins together with others. Until they are all there the driver holds
        /// the arm, by goals or a control function; other programs do not wait.
        ticket: Option<StartTicket>,
        /// Where the times of its cycles are counted; empty.
        times: Arc<MotionTimes>,
        /// Who sees its cycles.
        observer: Option<Observer>,
    },
    /// Forget the armed motion: its `Move` was refused. Has no effect once the motion runs.
    Disarm {
        /// The motion to forget.
        motion: MotionId,
    },
    /// Answer no more states of the motion: nobody is in charge of its program any more. The robot
    /// stops by itself when its commands stay away. An armed motion is disarmed.
    Silence {
        /// The motion to leave alone.
        motion: MotionId,
    },
}

/// The two modes that the states of a running motion show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// The motion generator mode, in the state's numbering.
    pub generator: MotionGeneratorMode,
    /// The controller mode.
    pub controller: ControllerMode,
}

impl Modes {
    /// The modes of the motion that `request` asks for.
    pub fn of(request: &MoveRequest) -> Self {
        Self {
            generator: request.generator.in_state(),
            controller: request.controller.in_state(),
        }
    }

    /// Whether a motion generator takes commands.
    pub fn has_generator(self) -> bool {
        !matches!(
            self.generator,
            MotionGeneratorMode::Idle | MotionGeneratorMode::None
        )
    }

    /// Whether the joints take torques.
    pub fn is_external(self) -> bool {
        self.controller == ControllerMode::ExternalController
    }

    /// Whether `state` shows both modes. `robot_mode` is no part of it: it may still be on its way
    /// at the start.
    pub fn shown_by(&self, state: &RobotState) -> bool {
        state.motion_generator_mode == self.generator && state.controller_mode == self.controller
    }
}
