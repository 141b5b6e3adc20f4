//! Backends of a session. The backend turns setpoints into torques: it is the session's own law or
//! one of the robot's controllers.

use core::fmt;

use franka_model::elbow::FLIP_ANGLE;
use franka_model::{JointVector, Model};
use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, RobotState, Version};

use crate::control::{
    CartesianPose, CartesianVelocities, GeneratorCommand, JointPositions, JointVelocities,
    MotionCommand, Torques,
};
use crate::session::guard::backstop::BACKSTOP;
use crate::session::{ForceCap, Goal, GoalError, Guard, SessionCommand, Target};

/// The backend that turns setpoints into torques.
///
/// | guard | [`Torques`](Self::Torques) | [`RobotController`](Self::RobotController) |
/// |---|---|---|
/// | clearance, lead, watchdog, deadman, reaction | yes | yes |
/// | joints' bounds on the way to a pose | yes | yes |
/// | leash, deviation, velocity barrier | yes | no: after something held the arm back or pushed it away, it springs back to its setpoint |
/// | force cap | yes | no: the session refuses a goal with a force cap |
/// | torque clamp and rate | yes | no: the robot computes the torques |
/// | limiter of setpoints (backstop) | no | yes |
///
/// [`Self::has`] returns the same information for each [`Guard`]. Under every backend, the robot's
/// own limits, reflexes and collision thresholds also apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Backend {
    /// The session's own law, computed on this host.
    #[default]
    Torques,
    /// One of the robot's own controllers, which receives the setpoints. Every controller accepts
    /// every kind of setpoints. The stiffness is a setting of the robot: see `set_joint_impedance`
    /// and `set_cartesian_impedance`. The gains of goals have no effect, and a goal with a force
    /// cap is refused.
    ///
    /// Setpoints continue from the robot's own setpoint. If commands were lost and the robot
    /// continued alone, the reference moves to the robot's setpoint. The last guard is the
    /// backstop, a limiter of setpoints.
    RobotController {
        /// Controller that follows the setpoints.
        controller: Controller,
        /// Kind of the setpoints.
        setpoints: Setpoints,
    },
}

/// The robot's own controllers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Controller {
    /// A spring and a damper for each joint. This controller moves the arm nearer to its target
    /// than the Cartesian controller does.
    JointImpedance,
    /// Springs and dampers at the end effector. An arm with friction rests further from its target
    /// than under joint impedance, and its posture is held softly. With a joint target, only the
    /// end effector reaches its place.
    CartesianImpedance,
}

/// Kinds of setpoints for the robot's controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Setpoints {
    /// Joint positions. Supports every goal except hand guiding.
    JointPositions,
    /// Joint velocities, which the robot integrates. Supports every goal except hand guiding.
    ///
    /// Each setpoint is the velocity of the reference. The position that the robot has integrated
    /// may differ from the reference. A small difference is corrected slowly, so that the arm ends
    /// exactly at its target. After a large difference, the reference continues from the robot's
    /// position.
    JointVelocities,
    /// Poses of the end effector. Supports only goals with poses.
    ///
    /// Each pose comes with its elbow, the angle of joint 3, so that the robot's inverse kinematics
    /// has only one solution. The joints of that solution match the reference and stay within their
    /// limits. The session refuses a stretched arm. Joint 4 stays on its side of [`FLIP_ANGLE`],
    /// because the robot keeps the side of the elbow that it had at the beginning.
    ///
    /// While joint 3 rests and the arm moves around its pose, the elbow determines the other joints
    /// only poorly. Such motions require wide turns of joints 3 and 5, and only the robot's own
    /// check applies to them. Prefer joint setpoints for them.
    CartesianPoses,
    /// Twists of the end effector, which the robot integrates, each with its elbow. The notes on
    /// [`Self::CartesianPoses`] and [`Self::JointVelocities`] also apply here.
    CartesianVelocities,
}

impl Setpoints {
    /// All kinds of setpoints.
    pub const ALL: [Self; 4] = [
        Self::JointPositions,
        Self::JointVelocities,
        Self::CartesianPoses,
        Self::CartesianVelocities,
    ];

    /// Returns the setpoint that holds the arm: the robot's desired setpoint, or zero velocity.
    pub(super) fn holding(self, state: &RobotState) -> MotionCommand {
        let elbow = Some(elbow(&state.q_d.into()));
        match self {
            Self::JointPositions => JointPositions(state.q_d).into(),
            Self::JointVelocities => JointVelocities::ZERO.into(),
            Self::CartesianPoses => CartesianPose {
                O_T_EE: *state.commanded_pose(),
                elbow,
            }
            .into(),
            Self::CartesianVelocities => CartesianVelocities {
                elbow,
                ..CartesianVelocities::ZERO
            }
            .into(),
        }
    }
}

impl Backend {
    /// Every controller of the robot, combined with every kind of setpoints.
    pub const ROBOT_CONTROLLERS: [Self; 8] = {
        let [q, dq, poses, twists] = Setpoints::ALL;
        [
            Self::joint_impedance(q),
            Self::joint_impedance(dq),
            Self::joint_impedance(poses),
            Self::joint_impedance(twists),
            Self::cartesian_impedance(q),
            Self::cartesian_impedance(dq),
            Self::cartesian_impedance(poses),
            Self::cartesian_impedance(twists),
        ]
    };

    /// Returns the backend that uses the robot's joint impedance controller with these setpoints.
    pub const fn joint_impedance(setpoints: Setpoints) -> Self {
        Self::RobotController {
            controller: Controller::JointImpedance,
            setpoints,
        }
    }

    /// Returns the backend that uses the robot's Cartesian impedance controller with these
    /// setpoints.
    pub const fn cartesian_impedance(setpoints: Setpoints) -> Self {
        Self::RobotController {
            controller: Controller::CartesianImpedance,
            setpoints,
        }
    }

    /// Returns the motion request that starts this backend on a robot with protocol `version`.
    pub fn request(self, version: Version) -> MoveRequest {
        let Self::RobotController {
            controller,
            setpoints,
        } = self
        else {
            let generator = version.torque_generator();
            return MoveRequest::new(MoveControllerMode::ExternalController, generator);
        };
        let controller = match controller {
            Controller::JointImpedance => MoveControllerMode::JointImpedance,
            Controller::CartesianImpedance => MoveControllerMode::CartesianImpedance,
        };
        let generator = match setpoints {
            Setpoints::JointPositions => MoveGeneratorMode::JointPosition,
            Setpoints::JointVelocities => MoveGeneratorMode::JointVelocity,
            Setpoints::CartesianPoses => MoveGeneratorMode::CartesianPosition,
            Setpoints::CartesianVelocities => MoveGeneratorMode::CartesianVelocity,
        };
        MoveRequest::new(controller, generator)
    }

    /// True if the robot's inverse kinematics converts the setpoints into joint positions. A
    /// backend with such setpoints accepts only poses.
    pub fn is_cartesian(self) -> bool {
        use Setpoints::{CartesianPoses, CartesianVelocities};
        matches!(
            self,
            Self::RobotController {
                setpoints: CartesianPoses | CartesianVelocities,
                ..
            }
        )
    }

    /// True if the commands of a session with this backend pass through `guard`.
    ///
    /// The guards of the reference apply under every backend. The guards of the torques apply only
    /// under the session's own law, and so do the two guards that move the reference along with a
    /// pushed arm. The robot's controller has its own springs, bounds and reflexes.
    pub fn has(self, guard: Guard) -> bool {
        let own_law = self == Self::Torques;
        match guard {
            Guard::InverseKinematics
            | Guard::JointVelocity
            | Guard::PositionEnvelope
            | Guard::Clearance
            | Guard::SpeedCap
            | Guard::Unresponsive
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

    /// Checks that this backend supports `goal`.
    ///
    /// # Errors
    /// Returns [`GoalError::Backend`] if it does not.
    pub(crate) fn check(self, goal: &Goal) -> Result<(), GoalError> {
        if self == Self::Torques {
            return Ok(());
        }
        let joints = |target| matches!(target, Target::Joints(_));
        let place = goal.target.place();
        let to_joints =
            joints(place) || goal.reaction.is_some_and(|reaction| joints(reaction.then));
        let (got, expected) = match place {
            Target::Guide(_) => ("hand guiding", OWN_LAW),
            _ if to_joints && self.is_cartesian() => (
                "joint positions as target",
                "a pose, joint setpoints or Backend::Torques",
            ),
            _ if goal.grasp.is_some() => ("carrying an object with a team", OWN_LAW),
            _ if matches!(goal.force_cap, ForceCap::Newtons(_)) => (
                "a force cap",
                "the robot's own impedance settings, or Backend::Torques",
            ),
            _ => return Ok(()),
        };
        Err(self.refuses(got, expected))
    }

    /// Checks that this backend can take control of an arm at these joint positions.
    ///
    /// # Errors
    /// Returns [`GoalError::Backend`] if it cannot.
    pub(crate) fn check_start(self, q: &JointVector) -> Result<(), GoalError> {
        if self.is_cartesian() && side(q) > 0.0 {
            let got = "a start from a stretched arm, with joint 4 above -0.467 rad";
            return Err(self.refuses(got, "joint setpoints or Backend::Torques"));
        }
        Ok(())
    }

    fn refuses(self, got: &'static str, expected: &'static str) -> GoalError {
        GoalError::Backend {
            backend: self,
            got,
            expected,
        }
    }

    /// Returns `model` with the joint limits that apply under this backend, if they differ. The
    /// elbow of a pose has its own limits, because no backstop protects the joints that it moves.
    pub(super) fn limited(self, model: &Model) -> Option<Model> {
        if !self.is_cartesian() {
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

    /// True if the robot's desired state, from which setpoints continue, is finite in all parts
    /// that this backend reads.
    pub(super) fn can_read(self, state: &RobotState) -> bool {
        if self == Self::Torques {
            return true;
        }
        let finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        let joints = [&state.q_d, &state.dq_d, &state.ddq_d].map(|joints| finite(joints));
        let pose = || {
            finite(state.commanded_pose())
                && finite(&state.O_dP_EE_c)
                && finite(&state.O_ddP_EE_c)
                && [&state.commanded_elbow(), &state.delbow_c, &state.ddelbow_c]
                    .into_iter()
                    .all(|elbow| finite(elbow))
        };
        joints == [true; 3] && (!self.is_cartesian() || pose())
    }

    /// Returns the answer that holds the arm. This is the robot's desired setpoint, or zero torque
    /// in addition to the robot's gravity compensation.
    pub(super) fn holding(self, state: &RobotState) -> SessionCommand {
        match self {
            Self::Torques => SessionCommand::Torques(Torques([0.0; 7])),
            Self::RobotController { setpoints, .. } => {
                SessionCommand::Setpoint(setpoints.holding(state))
            }
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Torques => write!(f, "the driver's own control law"),
            Self::RobotController {
                controller,
                setpoints,
            } => write!(f, "the robot's {controller} with {setpoints}"),
        }
    }
}

impl fmt::Display for Controller {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::JointImpedance => "joint impedance controller",
            Self::CartesianImpedance => "Cartesian impedance controller",
        })
    }
}

impl fmt::Display for Setpoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::JointPositions => "joint positions",
            Self::JointVelocities => "joint velocities",
            Self::CartesianPoses => "Cartesian poses",
            Self::CartesianVelocities => "Cartesian velocities",
        })
    }
}

pub(super) fn elbow(q: &JointVector) -> [f64; 2] {
    [q[2], side(q)]
}

/// Returns the side of the stretched arm on which joint 4 is. Same as
/// [`franka_model::elbow::elbow`], but returns -1 or +1 also at the flip angle itself.
fn side(q: &JointVector) -> f64 {
    if q[3] < FLIP_ANGLE { -1.0 } else { 1.0 }
}

/// Name of the backend for goals that no controller of the robot supports.
const OWN_LAW: &str = "Backend::Torques";

/// Share of the elbow's velocity limit that joint 3 may use, if that is below the joint's own
/// limit.
const ELBOW: f64 = 0.95;
