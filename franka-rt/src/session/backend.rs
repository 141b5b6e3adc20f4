//! What turns the setpoints of a session into torques: its own law, or the robot's controller.

use franka_model::elbow::FLIP_ANGLE;
use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, JointVector, Model, transform};
use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, RobotState, Version};
use nalgebra::Vector3;

use crate::control::{CartesianPose, JointPositions, MotionCommand, Torques};
use crate::law::hybrid::Reference;
use crate::session::{Answer, ForceCap, Goal, GoalError, Guard, Target, rigid};
use crate::shaping::{Bounds, MAX_CUTOFF_FREQUENCY, Shaper};

/// What turns setpoints into torques.
///
/// | guard | [`Torques`](Self::Torques) | [`RobotController`](Self::RobotController) |
/// |---|---|---|
/// | clearance, lead, watchdog, deadman | yes | yes |
/// | joints' bounds on the way to a pose | yes | yes |
/// | leash, deviation, velocity barrier | yes | no: an arm that is held back or pushed away springs back to its setpoint |
/// | force cap | yes | no: a goal that asks for one is refused |
/// | torque clamp and rate | yes | no: the torques are the robot's |
/// | limiter of setpoints (backstop) | no | yes |
///
/// [`Self::has`] tells the same of each [`Guard`]. Beside them the robot has its own limits,
/// reflexes and collision thresholds, whatever the backend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
pub enum Setpoints {
    /// Joint positions, for its joint impedance controller. Every goal but hand guiding.
    Joints,
    /// Poses of the end effector, for its Cartesian impedance controller. Poses only.
    ///
    /// Each goes with its elbow, the angle of joint 3, which leaves the robot's own inverse
    /// kinematics nothing to choose: its joints are those of the reference, and keep their limits.
    /// A stretched arm is refused, and joint 4 stays on its side of
    /// [`FLIP_ANGLE`]: the robot takes the elbow's side for that of the beginning. Where joint 3 rests while the arm moves about
    /// its pose, which takes wide turns of the joints 3 and 5, an elbow tells little about the
    /// others: there the robot is the judge, and [`Self::Joints`] the better choice.
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

    /// Whether it can do what `goal` asks for.
    ///
    /// # Errors
    /// [`GoalError::Backend`].
    pub(crate) fn check(self, goal: &Goal) -> Result<(), GoalError> {
        let why = match (self, goal.target) {
            (Self::Torques, _) => return Ok(()),
            (_, Target::Guide(_)) => "takes no guiding hand",
            (Self::RobotController(Setpoints::Poses), Target::Joints(_)) => "takes poses only",
            _ if matches!(goal.force_cap, ForceCap::Newtons(_)) => {
                "keeps no force cap: its stiffness is set on the robot"
            }
            _ => return Ok(()),
        };
        Err(GoalError::Backend { why })
    }

    /// Whether it can take over an arm at these joint positions.
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

    /// What it allows the joints of `model`: the elbow that goes with poses has limits of its own,
    /// and no backstop stands between these joints and the robot.
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
    pub(super) fn holding(self, state: &RobotState) -> Answer {
        match self {
            Self::Torques => Answer::Torques(Torques([0.0; 7])),
            Self::RobotController(Setpoints::Joints) => {
                Answer::Setpoint(JointPositions(state.q_d).into())
            }
            Self::RobotController(Setpoints::Poses) => Answer::Setpoint(
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
fn elbow(q: &JointVector) -> [f64; 2] {
    [q[2], side(q)]
}

/// On which side of the stretched arm joint 4 is: as [`franka_model::elbow::elbow`], but never
/// neither.
fn side(q: &JointVector) -> f64 {
    if q[3] < FLIP_ANGLE { -1.0 } else { 1.0 }
}

/// Share of the elbow's velocity that joint 3 may take, where that is less than its own.
const ELBOW: f64 = 0.95;

/// How far the robot's setpoint may be from the one that it was sent, `[rad]`, for the two to count
/// as the same: more than its echo is rounded by, and less than any cycle of a motion that matters.
const ECHO: f64 = 2e-6;

/// The same of a pose and an elbow, `[m, rad]`. No backstop limits the joints behind a pose: what
/// is overlooked here comes back in them as a jerk, at most a fifth of what the gentlest joint may
/// have.
const POSE_ECHO: f64 = 3e-7;

/// How little the limiter may change a pose and an elbow, `[m, rad]`, for them to count as
/// unchanged: the joints behind them feel some ten times as much, a jerk of 100 rad/s^3.
const SAME: f64 = 1e-8;

/// Share that is kept of what the limiter lets pass when joints are held back: it is found along a
/// straight line.
const EASE: f64 = 0.95;

/// Times that joints are held back anew in a cycle.
const EASINGS: usize = 3;

/// Nominal length of a cycle, `[s]`.
const CYCLE: f64 = 1e-3;

/// Share of the robot's acceleration and jerk that the backstop lets pass: the echo that it limits
/// against is rounded to `f32` by a Franka Research 3, by up to 0.25 rad/s^2 of what it makes of
/// two positions.
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

    /// Where the robot takes its setpoint to be, if that is not where `reference` is. Of Cartesian
    /// setpoints it is what was commanded that is compared, and the robot's own joints that are
    /// taken over.
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
                let echo = CartesianPose {
                    O_T_EE: state.O_T_EE_c,
                    elbow: Some(state.elbow_c),
                };
                apart(&pose_at(model, ee, &reference.q), &echo).amax() > POSE_ECHO
            }
        };
        let [q, dq, ddq] = [state.q_d, state.dq_d, state.ddq_d].map(JointVector::from);
        // The robot's velocity is the mean of its last cycle, the reference's that at the end of
        // it.
        differs.then(|| Reference {
            q,
            dq: dq + ddq * (0.5 * CYCLE),
            ddq,
        })
    }

    /// The command for `reference`, and whether the backstop changed it. A command that cannot be
    /// shaped, as from a reference that is not finite, is the robot's own setpoint.
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
            Setpoints::Poses if first => {
                let start = CartesianPose {
                    O_T_EE: state.O_T_EE_c,
                    elbow: Some(elbow(&reference.q)),
                };
                let shaped = self.shaper.cartesian_pose(&start, state, true);
                (shaped.unwrap_or(start).into(), false)
            }
            Setpoints::Poses => {
                let pose = |q: &JointVector| pose_at(model, ee, q);
                let (command, changed) = self.eased(pose, reference, state);
                (command.into(), changed)
            }
        }
    }

    /// The pose and elbow of `reference` within the limits of both, and whether that took a change.
    ///
    /// What the limiter makes of a pose is another one, for which the robot finds other joints,
    /// within no limits. So it is the joints that are held back, towards where they get without a
    /// jerk, by as much as the limiter held back their pose.
    fn eased(
        &self,
        pose: impl Fn(&JointVector) -> CartesianPose,
        reference: &Reference,
        state: &RobotState,
    ) -> (CartesianPose, bool) {
        let shape = |asked: &CartesianPose| {
            let shaped = self.shaper.cartesian_pose(asked, state, false);
            shaped.unwrap_or(CartesianPose {
                O_T_EE: state.O_T_EE_c,
                ..*asked
            })
        };
        let mut asked = pose(&reference.q);
        let mut shaped = shape(&asked);
        if apart(&shaped, &asked).amax() <= SAME {
            return (shaped, false);
        }
        let [q, dq, ddq] = [state.q_d, state.dq_d, state.ddq_d].map(JointVector::from);
        let coasting = q + (dq + ddq * CYCLE) * CYCLE;
        let base = pose(&coasting);
        let mut share = 1.0;
        for _ in 0..EASINGS {
            let (left, all) = (apart(&shaped, &base), apart(&asked, &base));
            share *= EASE * left.zip_map(&all, |left, all| (left / all).min(1.0)).min();
            asked = pose(&(coasting + (reference.q - coasting) * share));
            shaped = shape(&asked);
            if apart(&shaped, &asked).amax() <= SAME {
                break;
            }
        }
        (shaped, true)
    }
}

/// The pose and the elbow at these joint positions.
fn pose_at(model: &Model, ee: &EndEffector, q: &JointVector) -> CartesianPose {
    CartesianPose {
        O_T_EE: transform::array(&rigid(&model.pose(Frame::EndEffector, q, ee))),
        elbow: Some(elbow(q)),
    }
}

/// How far two poses are apart: in translation, in the elements of their rotation, in the elbow.
fn apart(a: &CartesianPose, b: &CartesianPose) -> Vector3<f64> {
    let squares = |elements: core::ops::Range<usize>| -> f64 {
        elements.map(|i| (a.O_T_EE[i] - b.O_T_EE[i]).powi(2)).sum()
    };
    let [ours, theirs] = [a, b].map(|pose| pose.elbow.map_or(0.0, |[angle, _]| angle));
    Vector3::new(
        squares(12..15).sqrt(),
        squares(0..11).sqrt(),
        (ours - theirs).abs(),
    )
}
