//! What turns the setpoints of a session into torques: its own law, or the robot's controller.

use franka_model::elbow::FLIP_ANGLE;
use franka_model::{JointVector, Model};
use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, RobotState, Version};

use crate::control::{CartesianPose, JointPositions, Torques};
use crate::session::guard::backstop::BACKSTOP;
use crate::session::{ForceCap, Goal, GoalError, Guard, SessionCommand, Target};

/// What turns setpoints into torques.
///
/// | guard | [`Torques`](Self::Torques) | [`RobotController`](Self::RobotController) |
/// |---|---|---|
/// | clearance, lead, watchdog, deadman, reaction | yes | yes |
/// | joints' bounds on the way to a pose | yes | yes |
/// | leash, deviation, velocity barrier | yes | no: an arm that is held back or pushed away springs back to its setpoint |
/// | force cap | yes | no: a goal that asks for one is refused |
/// | torque clamp and rate | yes | no: the torques are the robot's |
/// | limiter of setpoints (backstop) | no | yes |
///
/// [`Self::has`] returns the same for each [`Guard`]. Beside them the robot has its own limits,
/// reflexes and collision thresholds, whatever the backend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Backend {
    /// The law of the session, on this host.
    #[default]
    Torques,
    /// The robot's own controller, which gets the setpoints. Its stiffness is the robot's: see
    /// `set_joint_impedance` and `set_cartesian_impedance`; the gains of goals are without effect,
    /// and a goal with a force cap is refused.
    ///
    /// Setpoints go on from where the robot itself takes them to be: when commands were lost, and
    /// the robot went on by itself, the reference is put where it went. Its limiter is the
    /// backstop.
    RobotController(Setpoints),
}

/// What the robot's controller gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Setpoints {
    /// Joint positions, for its joint impedance controller. Every goal but hand guiding.
    Joints,
    /// Poses of the end effector, for its Cartesian impedance controller. Poses only.
    ///
    /// Each goes with its elbow, the angle of joint 3, which leaves the robot's own inverse
    /// kinematics nothing to choose: its joints are those of the reference, and keep their limits.
    /// A stretched arm is refused, and joint 4 stays on its side of [`FLIP_ANGLE`]: the robot takes
    /// the elbow's side for that of the beginning. Where joint 3 rests while the arm moves about
    /// its pose, which takes wide turns of the joints 3 and 5, an elbow says little about the
    /// others: there only the robot's own check applies, and [`Self::Joints`] is the better choice.
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

    /// Whether commands of a session with this backend pass through `guard`.
    ///
    /// The guards of the reference hold under every backend. Those of the torques, and the two that
    /// move the reference with an arm that is pushed away, are the session's own law's: the robot's
    /// controller has springs, bounds and reflexes of its own.
    pub fn has(self, guard: Guard) -> bool {
        let own_law = self == Self::Torques;
        match guard {
            Guard::InverseKinematics
            | Guard::JointVelocity
            | Guard::PositionEnvelope
            | Guard::Clearance
            | Guard::Lead
            | Guard::Watchdog
            | Guard::Deadman
            | Guard::Reaction
            | Guard::Team
            | Guard::PlanFailure => true,
            Guard::Leash
            | Guard::Deviation
            | Guard::TorqueClamp
            | Guard::ForceCap
            | Guard::VelocityBarrier
            | Guard::TorqueRate => own_law,
            Guard::Backstop => !own_law,
        }
    }

    /// Checks that this backend can pursue `goal`.
    ///
    /// # Errors
    /// [`GoalError::Backend`].
    pub(crate) fn check(self, goal: &Goal) -> Result<(), GoalError> {
        let joints = |target| matches!(target, Target::Joints(_));
        let to_joints = joints(goal.target.place())
            || goal.reaction.is_some_and(|reaction| joints(reaction.then));
        let why = match (self, goal.target.place()) {
            (Self::Torques, _) => return Ok(()),
            (_, Target::Guide(_)) => "takes no guiding hand",
            (Self::RobotController(Setpoints::Poses), _) if to_joints => "takes poses only",
            _ if goal.grasp.is_some() => "carries no object: its springs act at the end effector",
            _ if matches!(goal.force_cap, ForceCap::Newtons(_)) => {
                "keeps no force cap: its stiffness is set on the robot"
            }
            _ => return Ok(()),
        };
        Err(GoalError::Backend { why })
    }

    /// Checks that this backend can take over an arm at these joint positions.
    ///
    /// # Errors
    /// [`GoalError::Backend`].
    pub(crate) fn check_start(self, q: &JointVector) -> Result<(), GoalError> {
        if self == Self::RobotController(Setpoints::Poses) && side(q) > 0.0 {
            let why = "takes no stretched arm";
            return Err(GoalError::Backend { why });
        }
        Ok(())
    }

    /// The limits of the joints of `model` under this backend: the elbow that goes with poses has
    /// limits of its own, and no backstop stands between these joints and the robot.
    pub(super) fn limited(self, model: &Model) -> Option<Model> {
        if self != Self::RobotController(Setpoints::Poses) {
            return None;
        }
        let elbow = &model.cartesian_limits().elbow;
        let mut limits = *model.joint_limits();
        limits.velocity[2] = limits.velocity[2].min(ELBOW * elbow.velocity);
        limits.acceleration[2] = limits.acceleration[2].min(elbow.acceleration);
        limits.jerk[2] = limits.jerk[2].min(elbow.jerk);
        limits.acceleration *= BACKSTOP;
        limits.jerk *= BACKSTOP;
        limits.upper[3] = limits.upper[3].min(FLIP_ANGLE);
        Some(model.clone().with_joint_limits(limits))
    }

    /// Whether the desired state of the robot, which setpoints go on from, is finite where it is
    /// read.
    pub(super) fn can_read(self, state: &RobotState) -> bool {
        let Self::RobotController(setpoints) = self else {
            return true;
        };
        let finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        let joints = [&state.q_d, &state.dq_d, &state.ddq_d].map(|joints| finite(joints));
        let pose = || {
            finite(&state.O_T_EE_c)
                && finite(&state.O_dP_EE_c)
                && finite(&state.O_ddP_EE_c)
                && [&state.elbow_c, &state.delbow_c, &state.ddelbow_c]
                    .into_iter()
                    .all(|elbow| finite(elbow))
        };
        joints == [true; 3] && (setpoints == Setpoints::Joints || pose())
    }

    /// The answer that holds the arm: what the robot desires already, or no torques beside its
    /// gravity compensation.
    pub(super) fn holding(self, state: &RobotState) -> SessionCommand {
        match self {
            Self::Torques => SessionCommand::Torques(Torques([0.0; 7])),
            Self::RobotController(Setpoints::Joints) => {
                SessionCommand::Setpoint(JointPositions(state.q_d).into())
            }
            Self::RobotController(Setpoints::Poses) => SessionCommand::Setpoint(
                CartesianPose {
                    O_T_EE: state.O_T_EE_c,
                    elbow: Some(elbow(&state.q_d.into())),
                }
                .into(),
            ),
        }
    }
}

/// The elbow at these joint positions, as a command has it.
pub(super) fn elbow(q: &JointVector) -> [f64; 2] {
    [q[2], side(q)]
}

/// On which side of the stretched arm joint 4 is: as [`franka_model::elbow::elbow`], but -1 or +1
/// also at the flip angle itself.
fn side(q: &JointVector) -> f64 {
    if q[3] < FLIP_ANGLE { -1.0 } else { 1.0 }
}

/// Share of the elbow's velocity that joint 3 may take, where that is less than its own.
const ELBOW: f64 = 0.95;
