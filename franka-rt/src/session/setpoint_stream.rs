//! The stream of setpoints to the robot's own controller, and how it continues after lost commands.

mod distance;
#[cfg(test)]
mod tests;

use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, JointVector, Model, Twist, rotation, transform};
use franka_proto::{RobotState, Version};
use nalgebra::Isometry3;

use crate::control::{
    CartesianPose, CartesianVelocities, JointPositions, JointVelocities, MotionCommand, Shaper,
};
use crate::session::backend::{Controller, Setpoints, elbow};
use crate::session::guard::backstop;
use crate::session::reference::Reference;
use crate::session::rigid;
use crate::shaping::{CYCLE, MAX_CUTOFF_FREQUENCY};
use distance::{apart, differs, is_off, joint_drift, pose_drift, unchanged};

/// Share of the limiter's result that is used when joints are held back, because the limiter works
/// along a straight line.
const EASE: f64 = 0.95;

/// Maximum number of times that joints are held back further in one cycle.
const EASINGS: usize = 3;

/// Rate at which velocities remove a drift, `[1/s]`.
const RETURN: f64 = 10.0;

#[derive(Debug)]
pub(super) struct SetpointStream {
    controller: Controller,
    setpoints: Setpoints,
    shaper: Shaper,
    /// Setpoint of the last reference; `None` before the first setpoint.
    last: Option<MotionCommand>,
    /// Joint positions from which velocities start: the last reference's, or the robot's own.
    from: JointVector,
    /// Drift that the velocities must remove.
    drift: Drift,
}

/// Distance between the position that the robot has integrated and the reference, in the
/// coordinates of the setpoints.
#[derive(Clone, Copy, Debug)]
enum Drift {
    /// Drift of the joints, `[rad]`.
    Joints(JointVector),
    /// Drift of the pose, in base axes, `[m, rad]`.
    Pose(Twist),
    /// No drift: the robot is at the reference, or the setpoints are not velocities.
    None,
}

impl SetpointStream {
    pub(super) fn new(
        controller: Controller,
        setpoints: Setpoints,
        version: Version,
        limits: &JointLimits,
    ) -> Self {
        Self {
            controller,
            setpoints,
            shaper: Shaper::new(version, true, MAX_CUTOFF_FREQUENCY)
                .with_bounds(backstop::bounds(version))
                .with_limits_of(limits),
            last: None,
            from: JointVector::zeros(),
            drift: Drift::None,
        }
    }

    pub(super) fn controller(&self) -> Controller {
        self.controller
    }

    pub(super) fn is_cartesian(&self) -> bool {
        matches!(
            self.setpoints,
            Setpoints::CartesianPoses | Setpoints::CartesianVelocities
        )
    }

    /// Returns the robot's own commanded pose relative to the pose of `hand` at the joint positions
    /// `q`, which came from the robot. Poses and twists continue from the commanded pose, because
    /// the end effector is moved by this correction. Returns `None` for joint setpoints, and if the
    /// pose is not a rigid transformation.
    ///
    /// The correction does not change until the reference is taken from the robot again. If it
    /// followed the robot, it would hide a drift.
    pub(super) fn correction(
        &self,
        model: &Model,
        hand: &EndEffector,
        q: &JointVector,
        state: &RobotState,
    ) -> Option<Isometry3<f64>> {
        let commanded = self.is_cartesian().then(|| commanded_pose(state)).flatten();
        commanded.map(|commanded| pose_of(model, hand, q).inverse() * commanded)
    }

    /// Returns the robot's setpoint if it differs from the last setpoint sent, which is the
    /// setpoint of `reference`. Cartesian setpoints are compared as poses or twists, and the result
    /// contains the robot's own joints.
    ///
    /// The position that the robot has integrated may differ slightly; the next velocities remove
    /// this difference.
    pub(super) fn echo(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        state: &RobotState,
    ) -> Option<Reference> {
        (self.from, self.drift) = (reference.q, Drift::None);
        let mut differs = self.last.is_none_or(|last| differs(&last, state));
        match self.setpoints {
            Setpoints::JointVelocities if !differs => {
                let drift = reference.q - JointVector::from(state.q_d);
                differs = drift.amax() > is_off::JOINTS;
                self.drift = Drift::Joints(joint_drift(&drift));
            }
            Setpoints::CartesianVelocities if !differs => {
                let pose = pose_of(model, ee, &reference.q);
                let robots = commanded_pose(state);
                let drift = robots.map_or(Twist::zeros(), |robots| twist(&pose, &robots));
                differs = drift.amax() > is_off::POSE;
                self.drift = Drift::Pose(pose_drift(&drift));
            }
            _ => {}
        }
        let [q, dq, ddq] = [state.q_d, state.dq_d, state.ddq_d].map(JointVector::from);
        if differs {
            (self.from, self.drift) = (q, Drift::None);
        }
        // The robot's velocity is the mean over its last cycle. The reference's velocity is the
        // velocity at the end of the cycle.
        differs.then(|| Reference {
            q,
            dq: dq + ddq * (0.5 * CYCLE),
            ddq,
        })
    }

    /// Returns the command for `reference`, and true if the backstop changed it. If no command can
    /// be computed, for example because the reference is not finite, returns the command that holds
    /// the arm. For the `last` command of a motion, velocities are zero, because that command is
    /// repeated until the robot has ended the motion.
    pub(super) fn command(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        last: bool,
        state: &RobotState,
    ) -> (MotionCommand, bool) {
        if last {
            (self.from, self.drift) = (reference.q, Drift::None);
        }
        let from = match self.setpoints {
            Setpoints::CartesianVelocities => pose_of(model, ee, &self.from),
            _ => Isometry3::identity(),
        };
        let wish = |q: &JointVector| self.setpoint(model, ee, &from, q);
        let wished = wish(&reference.q);
        let shape = |asked: &MotionCommand| {
            let first = self.last.is_none();
            let shaped = asked.shaped(&self.shaper, state, first);
            shaped.unwrap_or_else(|_| self.setpoints.holding(state))
        };
        let (command, changed) = match (self.setpoints, &wished) {
            (Setpoints::CartesianPoses, MotionCommand::CartesianPose(pose))
                if self.last.is_none() =>
            {
                let start = CartesianPose {
                    O_T_EE: *state.commanded_pose(),
                    ..*pose
                };
                (shape(&start.into()), false)
            }
            (Setpoints::JointPositions | Setpoints::JointVelocities, _) => {
                let shaped = shape(&wished);
                (shaped, !unchanged(&shaped, &wished))
            }
            (Setpoints::CartesianPoses | Setpoints::CartesianVelocities, _) => {
                eased(wish, shape, reference, &self.from, state)
            }
        };
        self.last = Some(wished);
        (command, changed)
    }

    /// Returns the setpoint for the joint positions `q`. Velocities lead from the pose `from`.
    fn setpoint(
        &self,
        model: &Model,
        ee: &EndEffector,
        from: &Isometry3<f64>,
        q: &JointVector,
    ) -> MotionCommand {
        match self.setpoints {
            Setpoints::JointPositions => JointPositions((*q).into()).into(),
            Setpoints::JointVelocities => {
                let back = match self.drift {
                    Drift::Joints(drift) => drift * RETURN,
                    Drift::Pose(_) | Drift::None => JointVector::zeros(),
                };
                JointVelocities(((q - self.from) / CYCLE + back).into()).into()
            }
            Setpoints::CartesianPoses => CartesianPose {
                O_T_EE: transform::array(&pose_of(model, ee, q)),
                elbow: Some(elbow(q)),
            }
            .into(),
            Setpoints::CartesianVelocities => {
                let back = match self.drift {
                    Drift::Pose(drift) => drift * RETURN,
                    Drift::Joints(_) | Drift::None => Twist::zeros(),
                };
                let velocity = twist(&pose_of(model, ee, q), from) / CYCLE + back;
                CartesianVelocities {
                    O_dP_EE: velocity.into(),
                    elbow: Some(elbow(q)),
                }
                .into()
            }
        }
    }
}

/// Returns the setpoint of `reference`, reduced to the limits of pose and elbow. Also returns true
/// if it was reduced.
///
/// If the limiter changed a pose, the robot would find other joint positions for it, to which no
/// limits were applied. Therefore the joints are held back instead. From the place that they reach
/// without jerk from the last reference `from`, they move by the same share of the way that the
/// limiter allowed to their pose.
fn eased(
    wish: impl Fn(&JointVector) -> MotionCommand,
    shape: impl Fn(&MotionCommand) -> MotionCommand,
    reference: &Reference,
    from: &JointVector,
    state: &RobotState,
) -> (MotionCommand, bool) {
    let mut asked = wish(&reference.q);
    let mut shaped = shape(&asked);
    if unchanged(&shaped, &asked) {
        return (shaped, false);
    }
    let [dq, ddq] = [state.dq_d, state.ddq_d].map(JointVector::from);
    let coasting = from + (dq + ddq * CYCLE) * CYCLE;
    let base = wish(&coasting);
    let mut share = 1.0;
    for _ in 0..EASINGS {
        let (left, all) = (apart(&shaped, &base), apart(&asked, &base));
        share *= EASE * left.zip_map(&all, |left, all| (left / all).min(1.0)).min();
        asked = wish(&(coasting + (reference.q - coasting) * share));
        shaped = shape(&asked);
        if unchanged(&shaped, &asked) {
            break;
        }
    }
    (shaped, true)
}

fn pose_of(model: &Model, ee: &EndEffector, q: &JointVector) -> Isometry3<f64> {
    rigid(&model.pose(Frame::EndEffector, q, ee))
}

/// Returns the robot's own commanded pose, or `None` if it is not a rigid transformation.
fn commanded_pose(state: &RobotState) -> Option<Isometry3<f64>> {
    transform::isometry_from_array(state.commanded_pose())
}

/// Returns displacement and rotation vector from one pose to another, in base axes, `[m, rad]`.
fn twist(to: &Isometry3<f64>, from: &Isometry3<f64>) -> Twist {
    let way = to.translation.vector - from.translation.vector;
    let turn = rotation::error(&to.rotation, &from.rotation);
    Twist::new(way.x, way.y, way.z, turn.x, turn.y, turn.z)
}
