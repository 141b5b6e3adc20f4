//! The modes of a motion.

use franka_proto::{ControllerMode, MotionGeneratorMode, MoveRequest, RobotState};

/// The motion generator mode and the controller mode that states show while a motion runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// The motion generator mode, numbered as in the state.
    pub generator: MotionGeneratorMode,
    /// The controller mode.
    pub controller: ControllerMode,
}

impl Modes {
    /// Returns the modes of the motion that `request` starts.
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

    /// True if the motion expects joint torques.
    pub fn is_external(self) -> bool {
        self.controller == ControllerMode::ExternalController
    }

    /// True if `state` shows both modes. Ignores `robot_mode`, because it may change later than
    /// these two modes when a motion starts.
    pub fn shown_by(&self, state: &RobotState) -> bool {
        state.motion_generator_mode == self.generator && state.controller_mode == self.controller
    }
}
