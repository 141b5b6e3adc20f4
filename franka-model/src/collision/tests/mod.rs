//! Compares distances with independent minimisers that share only the capsules' numbers, and
//! compares gradients with finite differences.

mod awkward;
mod obstacles;
mod pairs;

use nalgebra::{Isometry3, Vector3};

use super::{Body, Capsule, Placed, Proximity, Shape};
use crate::geometry::FLANGE;
use crate::random::Random;
use crate::{EndEffector, Frame, JointVector, Model, RobotKind, transform};

/// Number of postures, or of obstacle placements, in the comparison of a distance.
const CASES: usize = 10_000;

/// Error of the minimisers, which bracket the parameter to 1e-9.
const DISTANCE: f64 = 1e-9;

const STEPS: usize = 50;

/// Returns the least value of a convex function on [0, 1], by ternary search.
fn least_of(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if f(a) < f(b) {
            high = b;
        } else {
            low = a;
        }
    }
    f(0.5 * (low + high)).min(f(0.0)).min(f(1.0))
}

fn point_on(capsule: &Capsule, t: f64) -> Vector3<f64> {
    capsule.start.lerp(&capsule.end, t)
}

fn from_axis(capsule: &Capsule, point: &Vector3<f64>) -> f64 {
    let along = capsule.end - capsule.start;
    let t = (point - capsule.start).dot(&along) / along.norm_squared();
    (point_on(capsule, t.clamp(0.0, 1.0)) - point).norm()
}

fn oracle(a: &Capsule, b: &Capsule) -> f64 {
    least_of(|s| from_axis(b, &point_on(a, s))) - a.radius - b.radius
}

/// Returns the capsules of a shape in the base frame, from the poses of the model.
fn placed_by_poses(shape: &Shape<'_>, q: &JointVector) -> Vec<(Body, Capsule)> {
    let model = Model::fr3();
    let pose = |frame| {
        let matrix = model.pose(frame, q, &EndEffector::default());
        transform::isometry(&matrix).expect("a pose")
    };
    let moved = |pose: Isometry3<f64>, capsule: &Capsule| Capsule {
        start: (pose * nalgebra::Point3::from(capsule.start)).coords,
        end: (pose * nalgebra::Point3::from(capsule.end)).coords,
        radius: capsule.radius,
    };
    let links = shape.arm.iter().map(|c| {
        let pose = match c.link {
            0 => Isometry3::identity(),
            link => pose(Frame::ALL[usize::from(link) - 1]),
        };
        (Body::Link(c.link), moved(pose, &c.capsule))
    });
    let tool = shape.tool.iter();
    let tool = tool.map(|c| (Body::Tool, moved(pose(Frame::Flange), c)));
    links.chain(tool).collect()
}

use std::vec::Vec;

/// Compares the gradients of all distances at `q` with finite differences. Returns the number of
/// comparisons and the number of distances within a step of a kink.
fn compare_gradients<P: PartialEq + core::fmt::Debug>(
    shape: &Shape<'_>,
    q: &JointVector,
    distances: impl Fn(&Placed<'_>) -> Vec<Proximity<P>>,
) -> (usize, usize) {
    const STEP: f64 = 1e-6;
    let here = distances(&shape.at(q));
    let (mut compared, mut kinks) = (0, 0);
    for i in 0..7 {
        let beside = |step: f64| {
            let mut q = *q;
            q[i] += step;
            distances(&shape.at(&q))
        };
        for ((at, before), after) in here.iter().zip(beside(-STEP)).zip(beside(STEP)) {
            assert_eq!(at.bodies, before.bodies);
            let left = (at.distance - before.distance) / STEP;
            let right = (after.distance - at.distance) / STEP;
            // The second derivative is the square of a lever, up to 1 m, over the gap of the axes.
            if (right - left).abs() > 1e-3 {
                kinks += 1;
                // The gradient at a kink is one of the gradients around it.
                let (low, high) = (left.min(right), left.max(right));
                assert!((low - 1e-3..=high + 1e-3).contains(&at.gradient[i]));
                continue;
            }
            compared += 1;
            let numeric = 0.5 * (left + right);
            assert!(
                (at.gradient[i] - numeric).abs() < 1e-6,
                "joint {}: {:?} differs from {numeric}, q = {q}",
                i + 1,
                at
            );
        }
    }
    (compared, kinks)
}

fn shapes() -> [Shape<'static>; 3] {
    [
        Shape::vendor().with_hand(),
        Shape::covering(RobotKind::Fr3).with_hand(),
        Shape::covering(RobotKind::Fer).with_hand(),
    ]
}

#[test]
fn capsules_stand_where_the_frames_of_the_model_do() {
    let mut random = Random::new(91);
    for shape in shapes() {
        for _ in 0..200 {
            let q = random.posture(Model::fr3());
            let want = placed_by_poses(&shape, &q);
            let got: Vec<_> = shape.at(&q).capsules().collect();
            assert_eq!(got.len(), want.len());
            for ((body, got), (owner, want)) in got.iter().zip(&want) {
                assert_eq!((body, got.radius), (owner, want.radius));
                assert!((got.start - want.start).amax() < 1e-14);
                assert!((got.end - want.end).amax() < 1e-14);
            }
        }
    }
    let q = JointVector::zeros();
    let hand = Shape::vendor().with_hand().at(&q).capsules().last();
    let (_, finger) = hand.expect("a tool");
    let tip = 0.926 + FLANGE - 0.2070; // the flange points down at zero
    assert!((finger.start.z - tip).abs() < 1e-14, "{finger:?}");
}
