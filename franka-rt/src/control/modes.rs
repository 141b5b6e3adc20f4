//! The modes of a motion.

use franka_proto::{ControllerMode, MotionGeneratorMode, MoveRequest, RobotState};

/// The two modes that the states of a running motion show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// The motion generator mode, in the state's numbering.
    pub generator: MotionGeneratorMode,
    /// The controller mode.
    pub controller: ControllerMode,
}

impl Modes {
    /// Returns the modes of the motion that `request` asks for.
    pub fn of(request: &MoveRequest) -> Self {
        Self {
            generator: request.generator.in_state(),
            controller: request.controller.in_state(),
        }
    }

    /// True if a motion generator expects commands.
    pub fn has_generator(self) -> bool {
        !matches!(
            self.generator,
            MotionGeneratorMode::Idle | MotionGeneratorMode::None
        )
    }

    /// True if the joints expect torques.
    pub fn is_external(self) -> bool {
        self.controller == ControllerMode::ExternalController
    }

    /// True if `state` shows both modes. Ignores `robot_mode`, which may change later than the
    /// modes at the start.
    pub fn shown_by(&self, state: &RobotState) -> bool {
        state.motion_generator_mode == self.generator && state.controller_mode == self.controller
    }
}
