//! Joint 7 from joint 4, in closed form.

use nalgebra::Isometry3;

use super::joint_7::{Elbow, Flange, Hand, cosine, push_all};
use super::solutions::Solutions;
use super::wrapped;
use crate::geometry::{Lengths, WRIST};
use crate::inertia::dot;
use crate::scalar::{acos, atan2, sqrt};

/// Returns all solutions with joint 4 at `q4`: at most eight.
///
/// The wrist is on a circle about axis 7. Joint 4 determines the distance of the wrist from the
/// shoulder. At most two points of a circle have a given distance from the shoulder.
pub(super) fn all(lengths: &Lengths, flange: &Isometry3<f64>, q4: f64) -> Solutions {
    let mut found = Solutions::NONE;
    let flange = Flange::of(flange);
    if let Some(elbow) = Elbow::at(lengths, q4) {
        for q7 in circle(&flange, elbow.squared_distance())
            .into_iter()
            .flatten()
        {
            push_all(&mut found, &Hand::of(&flange, q7), &elbow, q4);
        }
    }
    found
}

/// Returns the angles of joint 7 at which the wrist has this distance from the shoulder.
fn circle(flange: &Flange, squared_distance: f64) -> [Option<f64>; 2] {
    let d = &flange.from_shoulder;
    let (p, q) = (dot(d, &flange.x), dot(d, &flange.y));
    let radius = sqrt(p * p + q * q);
    let along = (dot(d, d) + WRIST * WRIST - squared_distance) / (2.0 * WRIST);
    if radius < AXIS {
        // If the shoulder is on axis 7, either every angle is a solution, or none is.
        return [(along.abs() < AXIS).then_some(0.0), None];
    }
    let Some(cos) = cosine(along / radius) else {
        return [None, None];
    };
    let (nearest, off) = (atan2(-q, p), acos(cos));
    [Some(wrapped(nearest + off)), Some(wrapped(nearest - off))]
}

/// Distance from axis 7, `[m]`, below which the shoulder counts as on the axis.
const AXIS: f64 = 1e-12;
