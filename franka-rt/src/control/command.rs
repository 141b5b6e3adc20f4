//! Commands of a program in one cycle, in the robot's own quantities.

use franka_proto::{MoveGeneratorMode, RobotCommand, RobotState};

use crate::control::Shaper;
use crate::shaping::{InvalidCommand, check};

/// Joint torques without the torques for gravity and friction, `[N m]`. The robot adds these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torques(pub [f64; 7]);

/// Joint positions for the robot's own controller, `q_c`, `[rad]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPositions(pub [f64; 7]);

/// Joint velocities for the robot's own controller, `dq_c`, `[rad/s]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointVelocities(pub [f64; 7]);

/// A pose of the end effector for the robot's own inverse kinematics, in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)]
pub struct CartesianPose {
    /// Pose in column-major order, `[m]`.
    pub O_T_EE: [f64; 16],
    /// Position of joint 3, `[rad]`, and the sign of joint 4, plus or minus 1. If `None`, the robot
    /// chooses the elbow.
    pub elbow: Option<[f64; 2]>,
}

/// A twist of the end effector for the robot's own inverse kinematics, in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)]
pub struct CartesianVelocities {
    /// Linear velocity, `[m/s]`, then angular velocity, `[rad/s]`.
    pub O_dP_EE: [f64; 6],
    /// Elbow, as in [`CartesianPose::elbow`].
    pub elbow: Option<[f64; 2]>,
}

/// A command to one of the robot's motion generators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionCommand {
    /// Command to the joint position generator.
    JointPositions(JointPositions),
    /// Command to the joint velocity generator.
    JointVelocities(JointVelocities),
    /// Command to the Cartesian position generator.
    CartesianPose(CartesianPose),
    /// Command to the Cartesian velocity generator.
    CartesianVelocities(CartesianVelocities),
}

impl MotionCommand {
    /// Returns the generator that accepts the command.
    pub fn generator(&self) -> MoveGeneratorMode {
        match self {
            Self::JointPositions(_) => MoveGeneratorMode::JointPosition,
            Self::JointVelocities(_) => MoveGeneratorMode::JointVelocity,
            Self::CartesianPose(_) => MoveGeneratorMode::CartesianPosition,
            Self::CartesianVelocities(_) => MoveGeneratorMode::CartesianVelocity,
        }
    }

    /// Returns a command that keeps the arm in place, for the same generator: the robot's desired
    /// position, or zero velocity. The robot expects such a command at the start of a motion.
    pub(super) fn holding(&self, state: &RobotState) -> Self {
        match self {
            Self::JointPositions(_) => JointPositions(state.q_d).into(),
            Self::JointVelocities(_) => JointVelocities::ZERO.into(),
            Self::CartesianPose(_) => CartesianPose {
                O_T_EE: *state.commanded_pose(),
                elbow: None,
            }
            .into(),
            Self::CartesianVelocities(_) => CartesianVelocities::ZERO.into(),
        }
    }

    /// Checks that the numbers of the command are valid.
    ///
    /// # Errors
    /// Returns the first [`InvalidCommand`] that applies.
    pub fn validate(&self) -> Result<(), InvalidCommand> {
        let elbow = match self {
            Self::JointPositions(JointPositions(values))
            | Self::JointVelocities(JointVelocities(values)) => {
                return check::finite(values);
            }
            Self::CartesianPose(CartesianPose { O_T_EE, elbow }) => {
                check::pose(O_T_EE)?;
                elbow
            }
            Self::CartesianVelocities(CartesianVelocities { O_dP_EE, elbow }) => {
                check::finite(O_dP_EE)?;
                elbow
            }
        };
        elbow.as_ref().map_or(Ok(()), check::elbow)
    }

    /// Returns the command after the shaper; `first` is true for the first command of the motion.
    pub(crate) fn shaped(
        &self,
        shaper: &Shaper,
        state: &RobotState,
        first: bool,
    ) -> Result<Self, InvalidCommand> {
        match self {
            Self::JointPositions(q) => Ok(shaper.joint_positions(q, state, first)?.into()),
            Self::JointVelocities(dq) => Ok(shaper.joint_velocities(dq, state)?.into()),
            Self::CartesianPose(pose) => Ok(shaper.cartesian_pose(pose, state, first)?.into()),
            Self::CartesianVelocities(twist) => {
                Ok(shaper.cartesian_velocities(twist, state)?.into())
            }
        }
    }

    /// Writes the command into the fields of its generator; the other fields do not change.
    pub(crate) fn write_to(&self, command: &mut RobotCommand) {
        match *self {
            Self::JointPositions(JointPositions(q)) => command.q_c = q,
            Self::JointVelocities(JointVelocities(dq)) => command.dq_c = dq,
            Self::CartesianPose(CartesianPose { O_T_EE, elbow }) => {
                command.O_T_EE_c = O_T_EE;
                command.elbow_c = elbow;
            }
            Self::CartesianVelocities(CartesianVelocities { O_dP_EE, elbow }) => {
                command.O_dP_EE_c = O_dP_EE;
                command.elbow_c = elbow;
            }
        }
    }
}

/// A type of command for one motion generator.
pub trait GeneratorCommand: Into<MotionCommand> + Copy + Send + private::Sealed + 'static {
    /// A command of zeros, without an elbow. A program sends it before its function has returned a
    /// command.
    const ZERO: Self;
}

mod private {
    pub trait Sealed {}
}

impl private::Sealed for JointPositions {}
impl private::Sealed for JointVelocities {}
impl private::Sealed for CartesianPose {}
impl private::Sealed for CartesianVelocities {}

impl GeneratorCommand for JointPositions {
    const ZERO: Self = Self([0.0; 7]);
}

impl GeneratorCommand for JointVelocities {
    const ZERO: Self = Self([0.0; 7]);
}

impl GeneratorCommand for CartesianPose {
    const ZERO: Self = Self {
        O_T_EE: [0.0; 16],
        elbow: None,
    };
}

impl GeneratorCommand for CartesianVelocities {
    const ZERO: Self = Self {
        O_dP_EE: [0.0; 6],
        elbow: None,
    };
}

impl From<JointPositions> for MotionCommand {
    fn from(command: JointPositions) -> Self {
        Self::JointPositions(command)
    }
}

impl From<JointVelocities> for MotionCommand {
    fn from(command: JointVelocities) -> Self {
        Self::JointVelocities(command)
    }
}

impl From<CartesianPose> for MotionCommand {
    fn from(command: CartesianPose) -> Self {
        Self::CartesianPose(command)
    }
}

impl From<CartesianVelocities> for MotionCommand {
    fn from(command: CartesianVelocities) -> Self {
        Self::CartesianVelocities(command)
    }
}
