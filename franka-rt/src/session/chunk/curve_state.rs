//! States along a chunk, of joints or of a pose. This file interpolates between two states, and
//! fades out the difference between two motions.

use franka_model::{JointVector, Twist, rotation};
use nalgebra::{Isometry3, SVector, Translation3, Vector3};

use super::curve::Curve;
use super::quintic::{self, PointState};
use super::value::Points;
use crate::session::pose::PoseState;
use crate::session::reference::Reference;

/// Greatest distance of the reference behind a path, `[m]`. At that distance the path waits.
const LAG_TRANSLATION: f64 = 0.005;

/// Greatest lag behind a path, `[rad]`, of the end effector's rotation and of each joint.
const LAG_ROTATION: f64 = 0.01;

/// A point of a chunk: a state with its first two derivatives.
pub(super) trait CurveState: Copy {
    /// Difference between two states, with its derivatives.
    type Gap: Copy + core::fmt::Debug;

    type Extent: Clone + core::fmt::Debug + PartialEq;

    /// Returns the state at the time `t` on the way from `from` at 0 to `to` at `duration`, in
    /// seconds.
    fn between(from: &Self, to: &Self, duration: f64, t: f64) -> Self;

    /// Returns the difference of this state from `base`.
    fn gap_from(&self, base: &Self) -> Self::Gap;

    /// Returns this state plus the part of `gap` that is left at the time `t`, if the gap closes
    /// within `duration`.
    fn displaced(&self, gap: &Self::Gap, duration: f64, t: f64) -> Self;

    /// Returns the same place, with the motion slowed by the factor `rate`, which changes by
    /// `change`, `[1/s]`.
    fn paced(&self, rate: f64, change: f64) -> Self;

    /// Returns the distance behind `target`, or away from its path, divided by the distance that is
    /// permitted on a path.
    fn lag(&self, target: &Self) -> f64;

    /// Returns the distance from `other`, in the same unit.
    fn distance(&self, other: &Self) -> f64;

    /// Returns the same place, with the motion of `other`.
    fn moving_as(&self, other: &Self) -> Self;

    /// Returns the same place, at rest.
    fn resting(&self) -> Self;

    fn extent(states: &[Self]) -> Self::Extent;

    /// Returns a curve of these states as the points of a chunk.
    fn points(curve: Curve<Self>) -> Points;
}

/// Returns the length of `gap` to a point that moves at `velocity`, ignoring any part by which the
/// reference is ahead of that point. If a path waited for a reference that is ahead, it would drive
/// the reference further ahead.
fn behind<const D: usize>(gap: &SVector<f64, D>, velocity: &SVector<f64, D>) -> f64 {
    let along = gap.dot(velocity);
    let ahead = if along < 0.0 {
        along / velocity.norm_squared()
    } else {
        0.0
    };
    (gap - velocity * ahead).norm()
}

/// The lowest and the highest position of each joint, `[rad]`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JointExtent {
    pub(super) lower: JointVector,
    pub(super) upper: JointVector,
}

impl CurveState for Reference {
    type Gap = PointState<7>;
    type Extent = JointExtent;

    fn between(from: &Self, to: &Self, duration: f64, t: f64) -> Self {
        quintic::between(&from.phase(), &to.phase(), duration, t).into()
    }

    fn gap_from(&self, base: &Self) -> PointState<7> {
        PointState {
            p: self.q - base.q,
            v: self.dq - base.dq,
            a: self.ddq - base.ddq,
        }
    }

    fn displaced(&self, gap: &PointState<7>, duration: f64, t: f64) -> Self {
        let gap = quintic::between(gap, &PointState::zero(), duration, t);
        Self {
            q: self.q + gap.p,
            dq: self.dq + gap.v,
            ddq: self.ddq + gap.a,
        }
    }

    fn paced(&self, rate: f64, change: f64) -> Self {
        Self {
            q: self.q,
            dq: self.dq * rate,
            ddq: self.ddq * (rate * rate) + self.dq * change,
        }
    }

    fn lag(&self, target: &Self) -> f64 {
        behind(&(target.q - self.q), &target.dq) / LAG_ROTATION
    }

    fn distance(&self, other: &Self) -> f64 {
        (self.q - other.q).norm() / LAG_ROTATION
    }

    fn moving_as(&self, other: &Self) -> Self {
        Self {
            q: self.q,
            ..*other
        }
    }

    fn resting(&self) -> Self {
        Self::at_rest(self.q)
    }

    fn extent(states: &[Self]) -> JointExtent {
        let positions = || states.iter().map(|state| state.q);
        let infinite = JointVector::repeat(f64::INFINITY);
        JointExtent {
            lower: positions().fold(infinite, |lower, q| lower.inf(&q)),
            upper: positions().fold(-infinite, |upper, q| upper.sup(&q)),
        }
    }

    fn points(curve: Curve<Self>) -> Points {
        Points::Joints(curve)
    }
}

impl Reference {
    fn phase(&self) -> PointState<7> {
        PointState {
            p: self.q,
            v: self.dq,
            a: self.ddq,
        }
    }
}

impl From<PointState<7>> for Reference {
    fn from(phase: PointState<7>) -> Self {
        Self {
            q: phase.p,
            dq: phase.v,
            ddq: phase.a,
        }
    }
}

/// Translation and rotation of one pose relative to another pose. The rotation vector turns the
/// other pose into this one.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseGap {
    translation: PointState<3>,
    rotation: PointState<3>,
}

impl CurveState for PoseState {
    type Gap = PoseGap;
    type Extent = ();

    /// The rotation is in the chart around the orientation of `from`. The orientation of `to` must
    /// be less than half a turn away.
    fn between(from: &Self, to: &Self, duration: f64, t: f64) -> Self {
        let start = PointState {
            p: Vector3::zeros(),
            ..from.rotation()
        };
        let end = in_chart(to, from);
        let turn = quintic::between(&start, &end, duration, t);
        let way = quintic::between(&from.translation(), &to.translation(), duration, t);
        from.turned(&turn, &way)
    }

    fn gap_from(&self, base: &Self) -> PoseGap {
        let (ours, theirs) = (self.translation(), base.translation());
        let phi = rotation::error(&self.pose.rotation, &base.pose.rotation);
        let (omega, alpha) = carried(base, &phi);
        let turning = self.rotation();
        let more = turning.v - omega;
        let (rate, second) =
            rotation::derivatives(&phi, &more, &(turning.a - alpha - more.cross(&omega)));
        PoseGap {
            translation: PointState {
                p: ours.p - theirs.p,
                v: ours.v - theirs.v,
                a: ours.a - theirs.a,
            },
            rotation: PointState {
                p: phi,
                v: rate,
                a: second,
            },
        }
    }

    fn displaced(&self, gap: &PoseGap, duration: f64, t: f64) -> Self {
        let none = PointState::zero();
        let off = quintic::between(&gap.translation, &none, duration, t);
        let turn = quintic::between(&gap.rotation, &none, duration, t);
        let here = self.translation();
        let (omega, alpha) = carried(self, &turn.p);
        let more = rotation::angular_velocity(&turn.p, &turn.v);
        let (w, dw) = (
            omega + more,
            alpha + rotation::angular_acceleration(&turn.p, &turn.v, &turn.a) + more.cross(&omega),
        );
        Self {
            pose: Isometry3::from_parts(
                Translation3::from(here.p + off.p),
                rotation::exp(&turn.p) * self.pose.rotation,
            ),
            twist: stacked(&(here.v + off.v), &w),
            acceleration: stacked(&(here.a + off.a), &dw),
        }
    }

    fn paced(&self, rate: f64, change: f64) -> Self {
        Self {
            pose: self.pose,
            twist: self.twist * rate,
            acceleration: self.acceleration * (rate * rate) + self.twist * change,
        }
    }

    fn lag(&self, target: &Self) -> f64 {
        let (ours, theirs) = (self.translation(), target.translation());
        let way = behind(&(theirs.p - ours.p), &theirs.v);
        let turn = rotation::error(&target.pose.rotation, &self.pose.rotation);
        let turn = behind(&turn, &target.rotation().v);
        (way / LAG_TRANSLATION).max(turn / LAG_ROTATION)
    }

    fn distance(&self, other: &Self) -> f64 {
        let way = self.translation().p - other.translation().p;
        let turn = rotation::error(&self.pose.rotation, &other.pose.rotation);
        (way.norm() / LAG_TRANSLATION).max(turn.norm() / LAG_ROTATION)
    }

    fn moving_as(&self, other: &Self) -> Self {
        Self {
            pose: self.pose,
            ..*other
        }
    }

    fn resting(&self) -> Self {
        Self {
            pose: self.pose,
            twist: Twist::zeros(),
            acceleration: Twist::zeros(),
        }
    }

    fn extent(_: &[Self]) {}

    fn points(curve: Curve<Self>) -> Points {
        Points::Poses(curve)
    }
}

impl PoseState {
    pub(super) fn translation(&self) -> PointState<3> {
        PointState {
            p: self.pose.translation.vector,
            v: self.twist.fixed_rows::<3>(0).into_owned(),
            a: self.acceleration.fixed_rows::<3>(0).into_owned(),
        }
    }

    /// Returns angular velocity and angular acceleration. They equal the derivatives of the
    /// rotation vector in the chart around this orientation.
    pub(super) fn rotation(&self) -> PointState<3> {
        PointState {
            p: Vector3::zeros(),
            v: self.twist.fixed_rows::<3>(3).into_owned(),
            a: self.acceleration.fixed_rows::<3>(3).into_owned(),
        }
    }

    /// Returns the state with the rotation `turn`, in the chart around this orientation, and with
    /// the translation `way`.
    fn turned(&self, turn: &PointState<3>, way: &PointState<3>) -> Self {
        let omega = rotation::angular_velocity(&turn.p, &turn.v);
        let alpha = rotation::angular_acceleration(&turn.p, &turn.v, &turn.a);
        Self {
            pose: Isometry3::from_parts(
                Translation3::from(way.p),
                rotation::exp(&turn.p) * self.pose.rotation,
            ),
            twist: stacked(&way.v, &omega),
            acceleration: stacked(&way.a, &alpha),
        }
    }
}

/// Returns the rotation of `state` in the chart around the orientation of `anchor`.
fn in_chart(state: &PoseState, anchor: &PoseState) -> PointState<3> {
    let phi = rotation::error(&state.pose.rotation, &anchor.pose.rotation);
    let turning = state.rotation();
    let (rate, second) = rotation::derivatives(&phi, &turning.v, &turning.a);
    PointState {
        p: phi,
        v: rate,
        a: second,
    }
}

/// Returns the angular velocity and acceleration of `base`, rotated by `phi`.
fn carried(base: &PoseState, phi: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let (turn, turning) = (rotation::exp(phi), base.rotation());
    (turn * turning.v, turn * turning.a)
}

pub(super) fn stacked(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Twist {
    Twist::new(
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    fn state(turn: [f64; 3], spin: f64) -> PoseState {
        PoseState {
            pose: Isometry3::from_parts(
                Translation3::new(0.4, 0.1 * spin, 0.5),
                UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]),
            ),
            twist: Twist::new(0.1, -0.2, 0.3, spin, -0.5 * spin, 0.7),
            acceleration: Twist::new(1.0, 0.2, -0.3, 2.0, spin, -1.0),
        }
    }

    fn close(a: &PoseState, b: &PoseState, tolerance: f64) -> bool {
        let turn = rotation::error(&a.pose.rotation, &b.pose.rotation).norm();
        let way = (a.pose.translation.vector - b.pose.translation.vector).norm();
        turn.max(way) < tolerance
            && (a.twist - b.twist).norm() < tolerance
            && (a.acceleration - b.acceleration).norm() < tolerance
    }

    /// Compares velocity and acceleration with the differences of poses and velocities.
    fn check_derivatives(at: impl Fn(f64) -> PoseState, t: f64) {
        let h = 1e-5;
        let (before, now, after) = (at(t - h), at(t), at(t + h));
        let turn = rotation::error(&after.pose.rotation, &before.pose.rotation) / (2.0 * h);
        assert!((now.rotation().v - turn).norm() < 1e-6, "{turn}");
        let growth = (after.twist - before.twist) / (2.0 * h);
        assert!((now.acceleration - growth).norm() < 1e-4, "{growth}");
    }

    #[test]
    fn a_pose_goes_from_one_state_to_another_with_true_derivatives() {
        let (from, to) = (state([3.0, 0.1, 0.2], 0.4), state([2.6, -0.3, 0.6], -0.8));
        let at = |t| PoseState::between(&from, &to, 0.2, t);
        assert!(close(&at(0.0), &from, 1e-12));
        assert!(close(&at(0.2), &to, 1e-9));
        check_derivatives(at, 0.07);
    }

    #[test]
    fn gap_fades_from_whole_to_nothing_with_true_derivatives() {
        let (from, base) = (state([3.0, 0.1, 0.2], 0.4), state([2.6, -0.3, 0.6], -0.8));
        let gap = from.gap_from(&base);
        assert!(close(&base.displaced(&gap, 0.1, 0.0), &from, 1e-12));
        assert!(close(&base.displaced(&gap, 0.1, 0.1), &base, 1e-9));
        let goal = state([2.7, -0.2, 0.5], -0.6);
        let moving = |t| {
            let base = PoseState::between(&base, &goal, 0.3, t);
            base.displaced(&gap, 0.1, t)
        };
        check_derivatives(moving, 0.04);
    }
}
