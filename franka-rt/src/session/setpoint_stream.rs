//! The stream of setpoints to the robot's own controller, and where it goes on after lost commands.

mod distance;
#[cfg(test)]
mod tests;

use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, JointVector, Model, Twist, rotation, transform};
use franka_proto::{RobotState, Version};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::control::{
    CartesianPose, CartesianVelocities, JointPositions, JointVelocities, MotionCommand, Shaper,
};
use crate::session::backend::{Controller, Setpoints, elbow};
use crate::session::guard::backstop;
use crate::session::reference::Reference;
use crate::session::rigid;
use crate::shaping::{CYCLE, MAX_CUTOFF_FREQUENCY};
use distance::{apart, differs, is_off, joint_drift, pose_drift, unchanged};

/// Share that is kept of what the limiter lets pass when joints are held back: it is found along a
/// straight line.
const EASE: f64 = 0.95;

/// Times that joints are held back anew in a cycle.
const EASINGS: usize = 3;

/// Part of a drift that velocities make up for in a second, `[1/s]`.
const RETURN: f64 = 10.0;

/// Streams setpoints to the robot's controller.
#[derive(Debug)]
pub(super) struct SetpointStream {
    controller: Controller,
    setpoints: Setpoints,
    shaper: Shaper,
    /// The setpoint of the last reference; `None` before the first.
    last: Option<MotionCommand>,
    /// The joint positions that velocities set out from: those of the last reference, or the
    /// robot's own.
    from: JointVector,
    /// What velocities make up for.
    drift: Drift,
    /// Offset of the robot's poses from the model's.
    offset: PoseOffset,
}

/// Offset of the robot's commanded pose from the pose of the model at the same joint positions.
///
/// The robot computes its poses with lengths of its own. Cartesian setpoints are poses of the model
/// with this offset, so that they continue what the robot commands. It is fixed until the reference
/// is taken from the robot again: an offset that followed the robot would hide a drift.
#[derive(Clone, Copy, Debug)]
struct PoseOffset {
    /// Base axes, `[m]`.
    translation: Vector3<f64>,
    /// In the axes of the end effector: base axes would turn motions, too.
    rotation: UnitQuaternion<f64>,
}

impl PoseOffset {
    /// The offset of `robots` from `models`.
    fn between(models: &Isometry3<f64>, robots: &Isometry3<f64>) -> Self {
        Self {
            translation: robots.translation.vector - models.translation.vector,
            rotation: models.rotation.inverse() * robots.rotation,
        }
    }

    /// Returns the robot's pose where the model has `pose`.
    fn apply(&self, pose: &Isometry3<f64>) -> Isometry3<f64> {
        Isometry3::from_parts(
            (pose.translation.vector + self.translation).into(),
            pose.rotation * self.rotation,
        )
    }
}

/// How far the robot's integrated position is from the reference, as far as that matters.
#[derive(Clone, Copy, Debug)]
enum Drift {
    /// `[rad]`
    Joints(JointVector),
    /// Base axes, `[m, rad]`.
    Pose(Twist),
    /// It is at the reference, or is no matter of velocities.
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
            offset: PoseOffset {
                translation: Vector3::zeros(),
                rotation: UnitQuaternion::identity(),
            },
        }
    }

    pub(super) fn controller(&self) -> Controller {
        self.controller
    }

    /// Returns the setpoint as the robot has it, if it differs from that of `reference`, the last
    /// one that was sent. Cartesian setpoints are compared as commanded, and the robot's own joints
    /// are taken over.
    ///
    /// What the robot has integrated may differ a little, which the next velocities make up for.
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
                let pose = self.pose_at(model, ee, &reference.q);
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
            if let Some(robots) = commanded_pose(state) {
                self.offset = PoseOffset::between(&pose_of(model, ee, &q), &robots);
            }
        }
        // The robot's velocity is the mean of its last cycle, the reference's that at the end of
        // it.
        differs.then(|| Reference {
            q,
            dq: dq + ddq * (0.5 * CYCLE),
            ddq,
        })
    }

    /// The command for `reference`, and whether the backstop changed it. A command that cannot be
    /// shaped, as from a non-finite reference, is the one that holds the arm. The `last` velocity
    /// of a motion is zero: it is repeated until the robot has ended the motion.
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
            Setpoints::CartesianVelocities => self.pose_at(model, ee, &self.from),
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

    /// The setpoint that leads to the joint positions `q`; velocities set out from the pose `from`.
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
                O_T_EE: transform::array(&self.pose_at(model, ee, q)),
                elbow: Some(elbow(q)),
            }
            .into(),
            Setpoints::CartesianVelocities => {
                let back = match self.drift {
                    Drift::Pose(drift) => drift * RETURN,
                    Drift::Joints(_) | Drift::None => Twist::zeros(),
                };
                let velocity = twist(&self.pose_at(model, ee, q), from) / CYCLE + back;
                CartesianVelocities {
                    O_dP_EE: velocity.into(),
                    elbow: Some(elbow(q)),
                }
                .into()
            }
        }
    }

    /// The robot's pose at these joint positions of the reference.
    fn pose_at(&self, model: &Model, ee: &EndEffector, q: &JointVector) -> Isometry3<f64> {
        self.offset.apply(&pose_of(model, ee, q))
    }
}

/// The setpoint of `reference` within the limits of pose and elbow, and whether that took a change.
///
/// A pose changed by the limiter would make the robot find other joints, with no limits applied. So
/// the joints are held back instead, towards where they get from the last reference `from` without
/// a jerk, by as much as the limiter held back their pose.
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

/// The model's pose at these joint positions.
fn pose_of(model: &Model, ee: &EndEffector, q: &JointVector) -> Isometry3<f64> {
    rigid(&model.pose(Frame::EndEffector, q, ee))
}

/// Returns the robot's own commanded pose; `None` if it is no rigid transform.
fn commanded_pose(state: &RobotState) -> Option<Isometry3<f64>> {
    transform::isometry_from_array(state.commanded_pose())
}

/// Displacement and rotation vector from one pose to another, base axes, `[m, rad]`.
fn twist(to: &Isometry3<f64>, from: &Isometry3<f64>) -> Twist {
    let way = to.translation.vector - from.translation.vector;
    let turn = rotation::error(&to.rotation, &from.rotation);
    Twist::new(way.x, way.y, way.z, turn.x, turn.y, turn.z)
}
