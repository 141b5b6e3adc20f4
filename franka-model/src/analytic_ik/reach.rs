//! Reachability of a pose or a point, and its distance from the boundary of the reachable set.
//!
//! Use these functions for planning, not in a control cycle. They take from about 10 µs (target
//! well inside) to about 10 ms (target far outside).

use nalgebra::{Isometry3, Vector3};

use super::{Solution, flange_of, joint_7, sweep};
use crate::JointVector;
use crate::frame::EndEffector;
use crate::geometry::SHOULDER;
use crate::inverse_kinematics::{self, IkError};
use crate::limits::JointLimits;
use crate::model::Model;

/// Reachability of a target, and its distance from the boundary of the reachable set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Posture within the limits that reaches the target. Among the examined postures, this posture
    /// has the largest distance to the limits. It is `None` if the target is out of reach.
    pub posture: Option<JointVector>,
    /// Distance, `[m]`, by which the target may move outwards or inwards, along the line through
    /// the shoulder, before it becomes unreachable. The distance is at most [`FAR`].
    ///
    /// For an unreachable target, the value is minus the distance along this line to the reachable
    /// set. The value is −∞ if no point of the line is reachable with this orientation. The value
    /// is exact to a micrometre, unless the line has unreachable gaps shorter than 5 mm.
    pub margin: f64,
}

impl Reach {
    /// Returns true if the target is within reach.
    pub fn within(&self) -> bool {
        self.posture.is_some()
    }
}

/// Computes the reachability of the pose `target` for the end effector.
///
/// # Errors
/// Returns [`IkError`] if an argument is not finite or the end-effector frame is not rigid.
pub fn pose(model: &Model, target: &Isometry3<f64>, ee: &EndEffector) -> Result<Reach, IkError> {
    let flange = flange_of(target, ee)?;
    let limits = model.joint_limits();
    let mut search = PoseSearch { model, seed: None };
    let posture = max_margin(model, &flange)
        .map(|solution| solution.q)
        .or_else(|| search.posture(&flange));
    search.seed = posture;
    let margin = margin(posture.is_some(), &target.translation.vector, |shift| {
        let mut moved = flange;
        moved.translation.vector += shift;
        search.reaches(&moved, limits)
    });
    Ok(Reach { posture, margin })
}

/// Computes the reachability of `point` `[m]`, in the base frame, for the end effector's origin
/// with any orientation.
///
/// If the search, which has several starting postures, does not reach the point, the point is
/// almost certainly out of reach.
///
/// # Errors
/// Returns [`IkError`] if an argument is not finite or the end-effector frame is not rigid.
pub fn position(model: &Model, point: &Vector3<f64>, ee: &EndEffector) -> Result<Reach, IkError> {
    let mut seed = crate::READY;
    let mut find =
        |point: &Vector3<f64>| match inverse_kinematics::solve_position(model, point, ee, &seed) {
            Ok(q) => {
                seed = q;
                Ok(Some(q))
            }
            Err(IkError::Unreachable { .. }) => Ok(None),
            Err(other) => Err(other),
        };
    let posture = find(point)?;
    let margin = margin(posture.is_some(), point, |shift| {
        matches!(find(&(point + shift)), Ok(Some(_)))
    });
    Ok(Reach { posture, margin })
}

/// Largest distance examined, `[m]`: no point of the arm is further from the shoulder.
pub const FAR: f64 = 1.2;

/// Search for postures of neighbouring poses.
struct PoseSearch<'a> {
    model: &'a Model,
    /// The last posture found.
    seed: Option<JointVector>,
}

impl PoseSearch<'_> {
    fn reaches(&mut self, flange: &Isometry3<f64>, limits: &JointLimits) -> bool {
        // Tries the last angle of joint 7 before its whole range.
        if let Some(q) = self.seed {
            let found = joint_7::all(self.model.lengths(), flange, q[6])
                .within(&limits.lower, &limits.upper);
            if !found.is_empty() {
                return true;
            }
        }
        let swept = sweep(self.model, flange, STEPS).next().map(|s| s.q);
        match swept.or_else(|| self.posture(flange)) {
            Some(q) => {
                self.seed = Some(q);
                true
            }
            None => false,
        }
    }

    /// Iterates from the last posture. At the boundary of the reachable set, joint 7 has only one
    /// possible angle. The iteration finds it, but a sweep misses it.
    fn posture(&self, flange: &Isometry3<f64>) -> Option<JointVector> {
        let seed = self.seed.unwrap_or(crate::READY);
        inverse_kinematics::from_seed(self.model, flange, &seed).ok()
    }
}

fn max_margin(model: &Model, flange: &Isometry3<f64>) -> Option<Solution> {
    let limits = model.joint_limits();
    sweep(model, flange, STEPS)
        .max_by(|a, b| a.limit_margin(limits).total_cmp(&b.limit_margin(limits)))
}

/// Returns the signed distance along the line through the shoulder at which `reaches(shift)`
/// changes its value.
fn margin(
    inside: bool,
    point: &Vector3<f64>,
    mut reaches: impl FnMut(&Vector3<f64>) -> bool,
) -> f64 {
    let from_shoulder = point - Vector3::new(0.0, 0.0, SHOULDER);
    let distance = from_shoulder.norm();
    let outward = if distance > 0.0 {
        from_shoulder / distance
    } else {
        Vector3::z()
    };
    let steps = (FAR.max(distance) / STRIDE) as u32 + 1;
    for step in 1..=steps {
        let far = f64::from(step) * STRIDE;
        for direction in [1.0, -1.0] {
            if reaches(&(outward * (direction * far))) == inside {
                continue;
            }
            // The answer of `reaches` changes between the last point with the same answer as the
            // target and this point.
            let (mut same, mut other) = (far - STRIDE, far);
            while other - same > PRECISION {
                let middle = 0.5 * (same + other);
                if reaches(&(outward * (direction * middle))) == inside {
                    same = middle;
                } else {
                    other = middle;
                }
            }
            return if inside { same } else { -other };
        }
    }
    if inside { FAR } else { f64::NEG_INFINITY }
}

const STEPS: u32 = 32;
/// Distance between two examined points of the line, `[m]`.
const STRIDE: f64 = 5e-3;
/// Resolution of the distance, `[m]`.
const PRECISION: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::super::tests::{flange, miss};
    use super::*;
    use crate::random::Random;
    use crate::{Frame, READY};

    #[test]
    fn reach_contains_every_pose_of_the_arm_with_a_posture() {
        let mut random = Random::new(91);
        let model = Model::fr3();
        for _ in 0..40 {
            let target = flange(&random.posture(model));
            let reach = pose(model, &target, &EndEffector::default()).expect("finite");
            let posture = reach.posture.expect("the posture it is of");
            assert!(model.joint_limits().contains(&posture));
            assert!(miss(&posture, &target) < 2e-9);
            assert!(reach.margin >= 0.0);
        }
    }

    #[test]
    fn the_margin_of_a_pose_ends_at_the_stretched_arm() {
        // The hand points forward, with axis 7 on the line from the shoulder through a wrist at the
        // same height. The wrist's distance from the shoulder and the wrist's offset are then two
        // sides of a right triangle.
        let forward = nalgebra::UnitQuaternion::from_axis_angle(
            &Vector3::y_axis(),
            core::f64::consts::FRAC_PI_2,
        );
        let (wrist, flange) = (crate::geometry::WRIST, crate::geometry::FLANGE);
        let side = |a: f64, b: f64| a * a + b * b;
        let (upper, fore) = (
            side(crate::geometry::UPPER_ARM, crate::geometry::ELBOW).sqrt(),
            side(crate::geometry::FOREARM, crate::geometry::ELBOW).sqrt(),
        );
        let far = ((upper + fore).powi(2) - wrist * wrist).sqrt() + flange;
        let target = |x: f64| Isometry3::from_parts(Vector3::new(x, 0.0, SHOULDER).into(), forward);
        for off in [-0.1, -0.02, -0.001, 0.001, 0.02, 0.1] {
            let reach = pose(Model::fr3(), &target(far + off), &EndEffector::default());
            let reach = reach.expect("finite");
            assert_eq!(reach.within(), off < 0.0);
            assert!((reach.margin + off).abs() < 2e-6, "{off}: {}", reach.margin);
        }
    }

    #[test]
    fn margin_beyond_reach_is_the_distance_or_infinite() {
        // Joints within 0.1 rad of the ready posture keep the hand pointing down.
        let limits = JointLimits {
            lower: READY.add_scalar(-0.1),
            upper: READY.add_scalar(0.1),
            ..*Model::fr3().joint_limits()
        };
        let model = Model::fr3().clone().with_joint_limits(limits);
        let reach = |target: &Isometry3<f64>| {
            pose(&model, target, &EndEffector::default()).expect("finite")
        };
        let ready = flange(&READY);
        let inside = reach(&ready);
        assert!(inside.within() && (0.0..0.1).contains(&inside.margin));

        let outward = ready.translation.vector - Vector3::new(0.0, 0.0, SHOULDER);
        let mut target = ready;
        target.translation.vector += outward.normalize() * 0.3;
        let outside = reach(&target);
        assert_eq!(outside.posture, None);
        let apart = inside.margin - outside.margin;
        assert!((apart - 0.3).abs() < 2e-6, "{apart}");

        target.rotation *=
            nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), core::f64::consts::PI);
        let nowhere = reach(&target);
        assert_eq!((nowhere.posture, nowhere.margin), (None, f64::NEG_INFINITY));
    }

    #[test]
    fn point_is_within_reach_up_to_the_stretched_arm() {
        let mut random = Random::new(92);
        let (model, ee) = (Model::fr3(), EndEffector::default());
        for _ in 0..10 {
            let point = flange(&random.posture(model)).translation.vector;
            let reach = position(model, &point, &ee).expect("finite");
            let q = reach.posture.expect("the posture it is of");
            let found = model.pose(Frame::Flange, &q, &ee);
            assert!((found.fixed_view::<3, 1>(0, 3) - point).norm() < 2e-9);
            assert!(reach.margin >= 0.0);
        }
        // For points out of reach at two distances, the negative margin leads to the same boundary.
        let near = position(model, &Vector3::new(1.1, 0.0, 0.4), &ee).expect("finite");
        let far = position(model, &Vector3::new(1.3, 0.0, 0.4), &ee).expect("finite");
        assert!(!near.within() && !far.within());
        let apart = near.margin - far.margin;
        let line = |x: f64| (x * x + 0.067f64 * 0.067).sqrt();
        assert!((apart - (line(1.3) - line(1.1))).abs() < 5e-4, "{apart}");
    }

    #[test]
    fn input_that_means_nothing_is_refused() {
        let (model, ee) = (Model::fr3(), EndEffector::default());
        let nowhere = Vector3::new(f64::NAN, 0.0, 0.0);
        assert_eq!(position(model, &nowhere, &ee), Err(IkError::NotFinite));
        let mut target = flange(&READY);
        target.translation.vector = nowhere;
        assert_eq!(pose(model, &target, &ee), Err(IkError::NotFinite));
    }
}
