//! The motion generators. They turn the command of one cycle into the desired motion.
//!
//! ```text
//! command | lost | finish ──> commanded signal ──> checks ──> [inverse kinematics ──> checks]
//!                                                                   └──> Desired, Errors
//! ```
//!
//! Like real robots, the generators report all violated bounds of a cycle together. The thresholds
//! are the nominal limits. The error for a bound depends on the order of the derivative, relative
//! to the commanded quantity (FCI documentation, control parameters and error list).

mod checks;
mod ik;
mod point_to_point;

pub(crate) use point_to_point::PointToPoint;

use franka_model::{EndEffector, Frame, JointVector, Model, Twist, elbow, rotation, transform};
use franka_proto::{Errors, MoveGeneratorMode, RobotCommand, RobotError};

use crate::config::Config;
use crate::kind::{Description, Precision};
use crate::signal::{CartesianSignal, ElbowSignal, JointSignal};

/// Desired and commanded values. The controllers follow them, and the state contains them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Desired {
    /// `q_d`, `dq_d`, `ddq_d`.
    pub(crate) joints: JointSignal,
    /// `O_T_EE_c`, `O_dP_EE_c`, `O_ddP_EE_c`.
    pub(crate) cartesian: CartesianSignal,
    /// `elbow_c[0]`, `delbow_c[0]`, `ddelbow_c[0]`.
    pub(crate) elbow: ElbowSignal,
}

impl Desired {
    pub(crate) fn resting(arm: &ArmModel<'_>, q: JointVector) -> Self {
        let mut desired = Self {
            joints: JointSignal::resting(q),
            cartesian: CartesianSignal::resting(nalgebra::Isometry3::identity()),
            elbow: ElbowSignal::default(),
        };
        desired.follow_joints(arm);
        desired
    }

    /// Returns desired values at rest, at exactly the position that the last state shows.
    ///
    /// A motion begins with these values, because a client begins with the values that it has read.
    /// Otherwise the rounding of the state would count as an acceleration (0.1 rad/s²).
    /// Extrapolation over some lost commands would turn this acceleration into a jump.
    pub(crate) fn as_published(&self, precision: Precision) -> Self {
        let pose = CartesianSignal::resting(self.cartesian.pose)
            .published(precision)
            .pose;
        Self {
            joints: JointSignal::resting(self.joints.published(precision).q),
            cartesian: CartesianSignal::resting(pose),
            elbow: ElbowSignal::resting(self.elbow.published(precision).angle),
        }
    }

    /// Computes pose and elbow, and their derivatives, from the joints.
    pub(crate) fn follow_joints(&mut self, arm: &ArmModel<'_>) {
        self.cartesian = CartesianSignal::resting(arm.pose(&self.joints.q));
        self.elbow = ElbowSignal::resting(self.joints.q[2]);
    }
}

/// Kinematics and limits of the arm with the frames that the client has set.
#[derive(Clone, Copy)]
pub(crate) struct ArmModel<'a> {
    pub(crate) kind: &'static Description,
    pub(crate) model: &'a Model,
    pub(crate) frames: &'a EndEffector,
    pub(crate) config: &'a Config,
}

impl<'a> ArmModel<'a> {
    pub(crate) fn new(
        kind: &'static Description,
        model: &'a Model,
        frames: &'a EndEffector,
        config: &'a Config,
    ) -> Self {
        Self {
            kind,
            model,
            frames,
            config,
        }
    }

    pub(crate) fn pose(&self, q: &JointVector) -> nalgebra::Isometry3<f64> {
        let matrix = self.model.pose(Frame::EndEffector, q, self.frames);
        // Frames are rigid transforms, because setters refuse all others.
        transform::isometry(&matrix).unwrap_or_else(nalgebra::Isometry3::identity)
    }
}

#[derive(Clone, Copy)]
pub(crate) enum Input<'a> {
    /// The client's first command of the motion.
    First(&'a RobotCommand),
    Next(&'a RobotCommand),
    /// No command has arrived in time.
    Lost,
    /// No command will follow, and the last command continues to apply. This input checks if a
    /// motion may finish.
    Rest,
}

impl<'a> Input<'a> {
    fn command(&self) -> Option<&'a RobotCommand> {
        match *self {
            Self::First(command) | Self::Next(command) => Some(command),
            Self::Lost | Self::Rest => None,
        }
    }

    fn is_first(&self) -> bool {
        matches!(self, Self::First(_))
    }
}

/// An invalid command: a non-finite number, or an impossible combination of flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct InvalidInput;

/// Advances `before` by one cycle of `generator`. Returns the new desired values and the bounds
/// that they violate.
pub(crate) fn advance(
    generator: MoveGeneratorMode,
    input: Input<'_>,
    before: &Desired,
    arm: &ArmModel<'_>,
) -> Result<(Desired, Errors), InvalidInput> {
    match generator {
        MoveGeneratorMode::JointPosition => joint_position(input, before, arm),
        MoveGeneratorMode::JointVelocity => joint_velocity(input, before, arm),
        MoveGeneratorMode::CartesianPosition => cartesian_position(input, before, arm),
        MoveGeneratorMode::CartesianVelocity => cartesian_velocity(input, before, arm),
        MoveGeneratorMode::None => Ok((*before, Errors::NONE)),
    }
}

fn joint_position(
    input: Input<'_>,
    before: &Desired,
    arm: &ArmModel<'_>,
) -> Result<(Desired, Errors), InvalidInput> {
    use RobotError as E;
    let target = input.command().map(|c| finite(&c.q_c)).transpose()?;
    if let (true, Some(q_c)) = (input.is_first(), &target)
        && (JointVector::from(*q_c) - before.joints.q).amax() > arm.config.unpublished.start.joint
    {
        return Ok((
            *before,
            E::JointPositionMotionGeneratorStartPoseInvalid.into(),
        ));
    }
    let (joints, broken) = checks::joints(&before.joints, arm, |from| match (&target, input) {
        (Some(q_c), _) => from.to_position(&JointVector::from(*q_c)),
        (None, Input::Rest) => from.to_position(&before.joints.q),
        (None, _) => (from.extrapolated(), JointVector::zeros()),
    });
    let mut errors = broken.named(
        E::JointMotionGeneratorVelocityLimitsViolation,
        E::JointMotionGeneratorVelocityDiscontinuity,
        E::JointMotionGeneratorAccelerationDiscontinuity,
    );
    errors.extend(checks::range(&joints, arm, arm.kind.range.joint_position));
    Ok((following(joints, arm), errors))
}

fn joint_velocity(
    input: Input<'_>,
    before: &Desired,
    arm: &ArmModel<'_>,
) -> Result<(Desired, Errors), InvalidInput> {
    use RobotError as E;
    let target = input.command().map(|c| finite(&c.dq_c)).transpose()?;
    let (joints, broken) = checks::joints(&before.joints, arm, |from| match (&target, input) {
        (Some(dq_c), _) => from.to_velocity(&JointVector::from(*dq_c)),
        (None, Input::Rest) => from.to_velocity(&JointVector::zeros()),
        (None, _) => (from.extrapolated(), JointVector::zeros()),
    });
    let mut errors = broken.named(
        E::JointMotionGeneratorVelocityLimitsViolation,
        E::JointMotionGeneratorAccelerationDiscontinuity,
        E::JointMotionGeneratorAccelerationDiscontinuity,
    );
    errors.extend(checks::range(&joints, arm, arm.kind.range.joint_velocity));
    Ok((following(joints, arm), errors))
}

fn cartesian_position(
    input: Input<'_>,
    before: &Desired,
    arm: &ArmModel<'_>,
) -> Result<(Desired, Errors), InvalidInput> {
    use RobotError as E;
    let target = match input.command() {
        Some(command) => match transform::isometry_from_array(&finite(&command.O_T_EE_c)?) {
            Some(pose) => Some(pose),
            None => {
                let error = E::CartesianPositionMotionGeneratorInvalidFrameFlag;
                return Ok((*before, error.into()));
            }
        },
        None => None,
    };
    let start_error = target.filter(|_| input.is_first()).filter(|pose| {
        let (now, tolerance) = (&before.cartesian.pose, &arm.config.unpublished.start);
        (pose.translation.vector - now.translation.vector).norm() > tolerance.translation
            || rotation::error(&pose.rotation, &now.rotation).norm() > tolerance.rotation
    });
    if start_error.is_some() {
        return Ok((
            *before,
            E::CartesianPositionMotionGeneratorStartPoseInvalid.into(),
        ));
    }
    let extrapolation = arm.config.unpublished.extrapolation;
    let (cartesian, broken) =
        checks::cartesian(&before.cartesian, arm, |from| match (&target, input) {
            (Some(pose), _) => from.to_pose(pose),
            (None, Input::Rest) => from.to_pose(&before.cartesian.pose),
            (None, _) => (from.extrapolated(extrapolation), Twist::zeros()),
        });
    let errors = broken.named(
        E::CartesianMotionGeneratorVelocityLimitsViolation,
        E::CartesianMotionGeneratorVelocityDiscontinuity,
        E::CartesianMotionGeneratorAccelerationDiscontinuity,
    );
    complete(
        input,
        before,
        cartesian,
        errors,
        E::CartesianMotionGeneratorJointVelocityDiscontinuity,
        arm,
    )
}

fn cartesian_velocity(
    input: Input<'_>,
    before: &Desired,
    arm: &ArmModel<'_>,
) -> Result<(Desired, Errors), InvalidInput> {
    use RobotError as E;
    let target = input.command().map(|c| finite(&c.O_dP_EE_c)).transpose()?;
    let extrapolation = arm.config.unpublished.extrapolation;
    let (cartesian, broken) =
        checks::cartesian(&before.cartesian, arm, |from| match (&target, input) {
            (Some(twist), _) => from.to_twist(&Twist::from(*twist)),
            (None, Input::Rest) => from.to_twist(&Twist::zeros()),
            (None, _) => (from.extrapolated(extrapolation), Twist::zeros()),
        });
    let errors = broken.named(
        E::CartesianMotionGeneratorVelocityLimitsViolation,
        E::CartesianMotionGeneratorAccelerationDiscontinuity,
        E::CartesianMotionGeneratorAccelerationDiscontinuity,
    );
    complete(
        input,
        before,
        cartesian,
        errors,
        E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
        arm,
    )
}

/// Computes and checks the elbow and the joints that belong to a Cartesian command.
fn complete(
    input: Input<'_>,
    before: &Desired,
    cartesian: CartesianSignal,
    mut errors: Errors,
    joint_acceleration: RobotError,
    arm: &ArmModel<'_>,
) -> Result<(Desired, Errors), InvalidInput> {
    use RobotError as E;
    let commanded = match input.command().and_then(|c| c.elbow_c) {
        Some(elbow_c) => Some(finite(&elbow_c)?),
        None => None,
    };
    let side = elbow::elbow(&before.joints.q)[1];
    let elbow = match commanded {
        Some([angle, sign]) => {
            if sign != side {
                errors.insert(if input.is_first() {
                    E::CartesianMotionGeneratorStartElbowInvalid
                } else {
                    E::CartesianMotionGeneratorElbowSignInconsistent
                });
            }
            let off = (angle - before.elbow.angle).abs();
            if input.is_first() && off > arm.config.unpublished.start.elbow {
                errors.insert(E::CartesianMotionGeneratorStartElbowInvalid);
                return Ok((*before, errors));
            }
            let (elbow, broken) = checks::elbow(&before.elbow, arm, |from| from.to_angle(angle));
            if broken.any() || !checks::elbow_in_range(&elbow, arm) {
                errors.insert(E::CartesianMotionGeneratorElbowLimitViolation);
            }
            Some(elbow)
        }
        // This includes an elbow at rest, because lost commands do not change a commanded elbow.
        None if matches!(input, Input::Lost) && before.elbow.commanded => {
            Some(before.elbow.extrapolated())
        }
        None => None,
    };
    let q = ik::solve(
        arm,
        &cartesian.pose,
        elbow.map(|elbow| elbow.angle),
        &before.joints.q,
    );
    let (joints, jerk) = before.joints.to_position(&q);
    let broken = checks::joint_bounds(&before.joints, &joints, &jerk, arm);
    errors.extend(
        broken
            .named(
                E::CartesianMotionGeneratorJointVelocityLimitsViolation,
                joint_acceleration,
                E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
            )
            .iter(),
    );
    errors.extend(checks::range(&joints, arm, arm.kind.range.cartesian));
    let desired = Desired {
        joints,
        cartesian,
        elbow: elbow.unwrap_or_else(|| ElbowSignal::resting(joints.q[2])),
    };
    Ok((desired, errors))
}

/// Desired values of a motion that is commanded in joints.
fn following(joints: JointSignal, arm: &ArmModel<'_>) -> Desired {
    let mut desired = Desired {
        joints,
        cartesian: CartesianSignal::resting(nalgebra::Isometry3::identity()),
        elbow: ElbowSignal::default(),
    };
    desired.follow_joints(arm);
    desired
}

fn finite<const N: usize>(values: &[f64; N]) -> Result<[f64; N], InvalidInput> {
    if values.iter().all(|value| value.is_finite()) {
        Ok(*values)
    } else {
        Err(InvalidInput)
    }
}
