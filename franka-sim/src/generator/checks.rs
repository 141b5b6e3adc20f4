//! Bounds on commanded motion.

use franka_model::JointVector;
use franka_model::Twist;
use franka_model::limits::MotionLimits;
use franka_proto::{Errors, RobotError};

use super::ArmModel;
use crate::signal::{CartesianSignal, ElbowSignal, JointSignal, halves};

/// Flags for the derivatives of a command that are too large.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Broken {
    pub(super) velocity: bool,
    pub(super) acceleration: bool,
    pub(super) jerk: bool,
}

impl Broken {
    /// True if any derivative is too large.
    pub(super) fn any(self) -> bool {
        self.velocity || self.acceleration || self.jerk
    }

    /// Flags that are set in both `self` and `other`.
    fn and(self, other: Self) -> Self {
        Self {
            velocity: self.velocity && other.velocity,
            acceleration: self.acceleration && other.acceleration,
            jerk: self.jerk && other.jerk,
        }
    }

    fn or(self, other: Self) -> Self {
        Self {
            velocity: self.velocity || other.velocity,
            acceleration: self.acceleration || other.acceleration,
            jerk: self.jerk || other.jerk,
        }
    }

    /// The errors that correspond to the derivatives.
    pub(super) fn named(
        self,
        velocity: RobotError,
        acceleration: RobotError,
        jerk: RobotError,
    ) -> Errors {
        [
            (self.velocity, velocity),
            (self.acceleration, acceleration),
            (self.jerk, jerk),
        ]
        .into_iter()
        .filter_map(|(broken, error)| broken.then_some(error))
        .collect()
    }
}

/// Checks a step against the exact history and, if that check fails, against the published history.
///
/// Some kinds of robot publish the history in single precision. A client may limit its commands
/// relative to the published state. At 3 rad, this rounding changes the jerk by up to 240 rad/s³.
/// Another client may compute its commands without the state, relative to the exact history. Robots
/// refuse neither client. A bound therefore counts as violated only if the step violates it
/// relative to both histories.
fn judge<S: Copy>(
    exact: &S,
    published: impl Fn(S) -> S,
    step: impl Fn(&S) -> (S, Broken),
) -> (S, Broken) {
    let (next, broken) = step(exact);
    if !broken.any() {
        return (next, broken);
    }
    let (_, from_published) = step(&published(*exact));
    (next, broken.and(from_published))
}

/// Returns the joint signal after `step`, and the bounds that `step` violates.
pub(super) fn joints(
    from: &JointSignal,
    arm: &ArmModel<'_>,
    step: impl Fn(JointSignal) -> (JointSignal, JointVector),
) -> (JointSignal, Broken) {
    judge(
        from,
        |from| from.published(arm.kind.precision),
        |from| {
            let (next, jerk) = step(*from);
            (next, joint_bounds(from, &next, &jerk, arm))
        },
    )
}

/// Returns the bounds that a step of the joints violates.
///
/// The velocity envelope is computed for the position before the step, because a client knows only
/// this position.
pub(super) fn joint_bounds(
    from: &JointSignal,
    next: &JointSignal,
    jerk: &JointVector,
    arm: &ArmModel<'_>,
) -> Broken {
    let limits = arm.model.joint_limits();
    let scale = arm.config.joint_discontinuity_scale;
    let (lower, upper) = limits.velocity_envelope(&from.q, 0.0);
    let mut broken = Broken::default();
    for i in 0..7 {
        broken.velocity |= next.dq[i] > upper[i] + ROUNDING || next.dq[i] < lower[i] - ROUNDING;
        broken.acceleration |= next.ddq[i].abs() > limits.acceleration[i] * scale;
        broken.jerk |= jerk[i].abs() > limits.jerk[i] * scale;
    }
    broken
}

/// Returns the Cartesian signal after `step`, and the bounds that `step` violates.
pub(super) fn cartesian(
    from: &CartesianSignal,
    arm: &ArmModel<'_>,
    step: impl Fn(CartesianSignal) -> (CartesianSignal, Twist),
) -> (CartesianSignal, Broken) {
    let limits = arm.model.cartesian_limits();
    judge(
        from,
        |from| from.published(arm.kind.precision),
        |from| {
            let (next, jerk) = step(*from);
            let (v, w) = halves(&next.twist);
            let (a, alpha) = halves(&next.acceleration);
            let (j, zeta) = halves(&jerk);
            let translation = bounds(&limits.translation, v.norm(), a.norm(), j.norm());
            let rotation = bounds(&limits.rotation, w.norm(), alpha.norm(), zeta.norm());
            (next, translation.or(rotation))
        },
    )
}

/// Returns the elbow after `step`, and the bounds that `step` violates.
pub(super) fn elbow(
    from: &ElbowSignal,
    arm: &ArmModel<'_>,
    step: impl Fn(ElbowSignal) -> (ElbowSignal, f64),
) -> (ElbowSignal, Broken) {
    let limits = &arm.model.cartesian_limits().elbow;
    judge(
        from,
        |from| from.published(arm.kind.precision),
        |from| {
            let (next, jerk) = step(*from);
            let broken = bounds(
                limits,
                next.velocity.abs(),
                next.acceleration.abs(),
                jerk.abs(),
            );
            (next, broken)
        },
    )
}

/// True if the elbow angle is in the range of joint 3.
pub(super) fn elbow_in_range(elbow: &ElbowSignal, arm: &ArmModel<'_>) -> bool {
    let limits = arm.model.joint_limits();
    (limits.hard_lower[2]..=limits.hard_upper[2]).contains(&elbow.angle)
}

/// Returns `error` if desired joint positions are outside their range.
pub(super) fn range(
    joints: &JointSignal,
    arm: &ArmModel<'_>,
    error: RobotError,
) -> Option<RobotError> {
    let limits = arm.model.joint_limits();
    let outside =
        (0..7).any(|i| joints.q[i] < limits.hard_lower[i] || joints.q[i] > limits.hard_upper[i]);
    outside.then_some(error)
}

fn bounds(limits: &MotionLimits, velocity: f64, acceleration: f64, jerk: f64) -> Broken {
    Broken {
        velocity: velocity > limits.velocity,
        acceleration: acceleration > limits.acceleration,
        jerk: jerk > limits.jerk,
    }
}

/// Velocity up to which a joint counts as still, `[rad/s]`. The envelope is zero at a position
/// limit, and rounding errors must not violate it.
const ROUNDING: f64 = 1e-9;
