//! What the world outside asks of the driver.

use franka_proto::{
    ControllerMode, MotionGeneratorMode, MoveGeneratorMode, RobotCommand, RobotState, Version,
};

use crate::driver::Record;
use crate::session::{SessionEvent, TargetSession};

/// Names one motion for the life of a driver, from arming to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MotionId(pub u64);

/// An order into the thread. Orders cross in a bounded queue and are never lost or reordered.
#[derive(Debug)]
pub enum Order {
    /// Watch for `modes`, then answer every state with `program`. Comes before the `Move` goes out on TCP.
    Arm {
        /// The motion that this begins.
        motion: MotionId,
        /// The modes in which the robot runs it.
        modes: Modes,
        /// What answers the states.
        program: Program,
    },
    /// Forget the armed motion: its `Move` was refused. Has no effect once the motion runs.
    Disarm {
        /// The motion to forget.
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
    /// Whether `state` shows both modes. `robot_mode` is no part of it: it may still be on its way at the start.
    pub fn shown_by(&self, state: &RobotState) -> bool {
        state.motion_generator_mode == self.generator && state.controller_mode == self.controller
    }
}

/// What answers the states of a running motion. Built outside the thread and freed outside it.
#[derive(Debug)]
pub enum Program {
    /// Goals from a slot, turned into torques.
    Target(Box<TargetSession>),
}

impl Program {
    pub(super) fn step(&mut self, state: &RobotState, record: &mut Record) -> Step {
        match self {
            Self::Target(session) => session.step(state, record),
        }
    }
}

/// What a program answers a state with.
#[derive(Debug)]
pub(crate) struct Step {
    pub(crate) command: Command,
    /// The last command: the motion ends once the robot has taken it.
    pub(crate) finished: bool,
    pub(crate) event: Option<SessionEvent>,
}

/// The command of one cycle, in the terms of what is controlled.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Command {
    /// Joint torques without gravity and friction, `[N m]`.
    Torques([f64; 7]),
}

impl Command {
    /// The datagram that says it. Whichever of the two finishing flags the version has is set.
    pub(super) fn on_wire(self, version: Version, message_id: u64, finished: bool) -> RobotCommand {
        match self {
            Self::Torques(tau) => {
                let beside = version.torque_generator() != MoveGeneratorMode::None;
                RobotCommand {
                    message_id,
                    tau_J_d: tau,
                    torque_command_finished: finished && !beside,
                    // Protocol 5 has a generator of zero velocities run beside the torques, and ends the motion by it.
                    motion_generation_finished: finished && beside,
                    ..RobotCommand::default()
                }
            }
        }
    }
}
