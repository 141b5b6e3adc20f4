//! Who turns the setpoints of a session into torques: its own law, or the robot's controller.

use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, JointVector, Model, transform};
use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, RobotState, Version};

use crate::control::{CartesianPose, JointPositions, MotionCommand, Torques};
use crate::law::hybrid::Reference;
use crate::session::{Answer, GoalError, Target, rigid};
use crate::shaping::{Bounds, MAX_CUTOFF_FREQUENCY, Shaper};

/// Who turns setpoints into torques.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// The law of the session, on this host.
    #[default]
    Torques,
    /// The robot's own controller, which gets the setpoints. Its stiffness is the robot's: see `set_joint_impedance` and
    /// `set_cartesian_impedance`; the gains of goals are without effect.
    ///
    /// Setpoints go on from where the robot itself takes them to be: when commands were lost, and the robot went on by
    /// itself, the reference is put where it went. Its limiter is the backstop.
    RobotController(Setpoints),
}

/// What the robot's controller gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setpoints {
    /// Joint positions, for its joint impedance controller. Every goal but hand guiding.
    Joints,
    /// Poses of the end effector, for its Cartesian impedance controller. Poses only.
    ///
    /// The robot moves its joints by an inverse kinematics of its own. Where that accelerates a joint by more than the
    /// reference does here, in particular after lost commands, it may stop itself with a joint discontinuity; slower limits
    /// make that rarer, [`Self::Joints`] does not have it.
    Poses,
}

impl Backend {
    /// The motion that it takes.
    pub(crate) fn request(self, version: Version) -> MoveRequest {
        let (controller, generator) = match self {
            Self::Torques => (
                MoveControllerMode::ExternalController,
                version.torque_generator(),
            ),
            Self::RobotController(Setpoints::Joints) => (
                MoveControllerMode::JointImpedance,
                MoveGeneratorMode::JointPosition,
            ),
            Self::RobotController(Setpoints::Poses) => (
                MoveControllerMode::CartesianImpedance,
                MoveGeneratorMode::CartesianPosition,
            ),
        };
        MoveRequest::new(controller, generator)
    }

    /// Whether it can take the arm there.
    ///
    /// # Errors
    /// [`GoalError::Backend`].
    pub(crate) fn check(self, target: &Target) -> Result<(), GoalError> {
        let why = match (self, target) {
            (Self::RobotController(_), Target::Guide(_)) => "takes no guiding hand",
            (Self::RobotController(Setpoints::Poses), Target::Joints(_)) => "takes poses only",
            _ => return Ok(()),
        };
        Err(GoalError::Backend { why })
    }

    /// The answer that holds the arm: what the robot desires already, or no torques beside its gravity compensation.
    pub(super) fn holding(self, state: &RobotState) -> Answer {
        match self {
            Self::Torques => Answer::Torques(Torques([0.0; 7])),
            Self::RobotController(Setpoints::Joints) => {
                Answer::Setpoint(JointPositions(state.q_d).into())
            }
            Self::RobotController(Setpoints::Poses) => Answer::Setpoint(
                CartesianPose {
                    O_T_EE: state.O_T_EE_c,
                    elbow: None,
                }
                .into(),
            ),
        }
    }
}

/// How far the robot's setpoint may be from the one that it was sent, `[rad]`, for the two to count as the same: more than
/// its echo is rounded by, and less than any cycle of a motion that matters.
const ECHO: f64 = 2e-6;

/// Share of the robot's acceleration and jerk that the backstop lets pass: the echo that it limits against is rounded to
/// `f32` by a Franka Research 3, by up to 0.25 rad/s^2 of what it makes of two positions.
const BACKSTOP: f64 = 0.95;

/// The bounds of the limiter behind the stream.
fn backstop(version: Version) -> Bounds {
    let bounds = match version {
        Version::V5 => Bounds::fer(),
        Version::V10 => Bounds::fr3(),
    };
    Bounds {
        joint_acceleration: bounds.joint_acceleration.map(|most| most * BACKSTOP),
        joint_jerk: bounds.joint_jerk.map(|most| most * BACKSTOP),
        ..bounds
    }
}

/// Streams setpoints to the robot's controller.
#[derive(Debug)]
pub(super) struct Stream {
    setpoints: Setpoints,
    shaper: Shaper,
    /// Whether no setpoint has been sent.
    first: bool,
}

impl Stream {
    pub(super) fn new(setpoints: Setpoints, version: Version, limits: &JointLimits) -> Self {
        Self {
            setpoints,
            shaper: Shaper::new(version, true, MAX_CUTOFF_FREQUENCY)
                .with_bounds(backstop(version))
                .with_limits_of(limits),
            first: true,
        }
    }

    /// Where the robot takes its setpoint to be, if that is not where `reference` is.
    ///
    /// Under Cartesian setpoints the robot moves its joints by an inverse kinematics of its own, so only what they mean
    /// for the end effector is compared.
    pub(super) fn echo(
        &self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        state: &RobotState,
    ) -> Option<Reference> {
        let differs = match self.setpoints {
            _ if self.first => true,
            Setpoints::Joints => (JointVector::from(state.q_d) - reference.q).amax() > ECHO,
            Setpoints::Poses => {
                let pose =
                    transform::array(&rigid(&model.pose(Frame::EndEffector, &reference.q, ee)));
                let both = pose.iter().zip(&state.O_T_EE_c);
                both.map(|(sent, echo)| (sent - echo).abs())
                    .fold(0.0, f64::max)
                    > ECHO
            }
        };
        differs.then(|| Reference {
            q: state.q_d.into(),
            dq: state.dq_d.into(),
            ddq: state.ddq_d.into(),
        })
    }

    /// The command for `reference`, and whether the backstop changed it. A command that cannot be shaped, which takes a
    /// state with numbers that are none, is the robot's own setpoint.
    pub(super) fn command(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        state: &RobotState,
    ) -> (MotionCommand, bool) {
        let first = core::mem::take(&mut self.first);
        match self.setpoints {
            Setpoints::Joints => {
                let wish = JointPositions(reference.q.into());
                let shaped = self.shaper.joint_positions(&wish, state, first);
                let shaped = shaped.unwrap_or(JointPositions(state.q_d));
                let changed = (JointVector::from(shaped.0) - reference.q).amax() > ECHO;
                (shaped.into(), changed)
            }
            Setpoints::Poses => {
                let pose = if first {
                    state.O_T_EE_c
                } else {
                    let pose = model.pose(Frame::EndEffector, &reference.q, ee);
                    transform::array(&rigid(&pose))
                };
                let wish = CartesianPose {
                    O_T_EE: pose,
                    elbow: None,
                };
                let shaped = self.shaper.cartesian_pose(&wish, state, first);
                let shaped = shaped.unwrap_or(CartesianPose {
                    O_T_EE: state.O_T_EE_c,
                    elbow: None,
                });
                let both = shaped.O_T_EE.iter().zip(&pose);
                let changed = both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > ECHO;
                (shaped.into(), changed)
            }
        }
    }
}
