//! The nearest points of two segments.

use nalgebra::Vector3;

use super::Capsule;
use crate::geometry::SHOULDER;
use crate::inertia::{cross, dot};
use crate::scalar::sqrt;

/// A capsule at a posture, in base axes, relative to the shoulder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub(super) start: Vector3<f64>,
    pub(super) along: Vector3<f64>,
    square: f64,
    pub(super) radius: f64,
}

/// The nearest points of two bodies, relative to the shoulder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    /// Distance between the surfaces.
    pub(super) distance: f64,
    /// Direction from the first body to the second.
    pub(super) normal: Vector3<f64>,
    /// Points on the first and on the second body.
    pub(super) points: [Vector3<f64>; 2],
}

impl Segment {
    pub(super) const EMPTY: Self = Self {
        start: Vector3::new(0.0, 0.0, 0.0),
        along: Vector3::new(0.0, 0.0, 0.0),
        square: 0.0,
        radius: 0.0,
    };

    /// Returns the capsule with its ends transformed by `place`.
    #[inline(always)]
    pub(super) fn of(capsule: &Capsule, place: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Self {
        let start = place(capsule.start);
        let along = place(capsule.end) - start;
        Self {
            start,
            along,
            square: dot(&along, &along),
            radius: capsule.radius,
        }
    }

    /// Returns the capsule with this radius whose axis extends by `half` in both directions from
    /// its middle.
    #[inline(always)]
    pub(super) fn around(middle: &Vector3<f64>, half: &Vector3<f64>, radius: f64) -> Self {
        Self {
            start: middle - half,
            along: half * 2.0,
            square: 4.0 * dot(half, half),
            radius,
        }
    }

    pub(super) fn capsule(&self) -> Capsule {
        let start = self.start + Vector3::new(0.0, 0.0, SHOULDER);
        Capsule {
            start,
            end: start + self.along,
            radius: self.radius,
        }
    }

    #[inline(always)]
    pub(super) fn at(&self, t: f64) -> Vector3<f64> {
        self.start + self.along * t
    }

    /// Returns the nearest points of two axes, and the distance between the surfaces.
    ///
    /// The two parameters minimise a convex quadratic function in a square. The function solves for
    /// the first parameter and clamps it, solves for the second parameter and clamps it, and then
    /// solves for the first parameter again (Ericson, Real-Time Collision Detection, 2004, section
    /// 5.1.9).
    #[inline(always)]
    pub(super) fn nearest(&self, other: &Self) -> Nearest {
        let between = self.start - other.start;
        let (a, e) = (self.square, other.square);
        let b = dot(&self.along, &other.along);
        let c = dot(&self.along, &between);
        let f = dot(&other.along, &between);
        let determinant = a * e - b * b;

        let guess = if determinant > PARALLEL * a * e {
            clamp((b * f - c * e) / determinant)
        } else {
            self.beside(other, [ratio(-c, a), ratio(b - c, a)])
        };
        let t = clamp(ratio(b * guess + f, e));
        let s = clamp(ratio(b * t - c, a));

        let points = [self.at(s), other.at(t)];
        let gap = points[1] - points[0];
        let length = sqrt(dot(&gap, &gap));
        let normal = if length > CROSSING {
            gap / length
        } else {
            common_normal(&self.along, &other.along)
        };
        Nearest {
            distance: length - self.radius - other.radius,
            normal,
            points,
        }
    }

    /// Returns the parameter on this segment that is nearest to a parallel segment. `ends` are the
    /// parameters of the other segment's ends.
    ///
    /// Along the overlap, the distance is constant except for rounding. The function returns the
    /// middle of the overlap, unless an end of the overlap is nearer by more than rounding.
    #[cold]
    fn beside(&self, other: &Self, ends: [f64; 2]) -> f64 {
        let [from, to] = ends.map(clamp);
        let square = |s: f64| {
            let point = self.at(s);
            let t = clamp(ratio(
                dot(&other.along, &(point - other.start)),
                other.square,
            ));
            (other.at(t) - point).norm_squared()
        };
        let middle = 0.5 * (from + to);
        let mut best = (middle, square(middle));
        for end in [from, to] {
            let candidate = square(end);
            // Ignores a difference in the last digits.
            if candidate < best.1 * (1.0 - 1e-14) {
                best = (end, candidate);
            }
        }
        best.0
    }
}

/// Returns a direction perpendicular to both segments. The segments touch, so their gap has no
/// direction.
#[cold]
fn common_normal(first: &Vector3<f64>, second: &Vector3<f64>) -> Vector3<f64> {
    let unit = |v: Vector3<f64>| v.try_normalize(f64::MIN_POSITIVE);
    let axis = |i: usize| Vector3::from_fn(|row, _| if row == i { 1.0 } else { 0.0 });
    let either = if first.norm_squared() > 0.0 {
        first
    } else {
        second
    };
    unit(cross(first, second))
        .or_else(|| unit(cross(either, &axis(either.iamin()))))
        .unwrap_or_else(|| axis(2))
}

#[inline(always)]
fn clamp(t: f64) -> f64 {
    t.clamp(0.0, 1.0)
}

/// Returns the quotient, or 0 for a segment without length, on which all parameters are the same
/// point.
#[inline(always)]
fn ratio(numerator: f64, square: f64) -> f64 {
    if square > 0.0 {
        numerator / square
    } else {
        0.0
    }
}

/// Square of the sine of the angle below which segments count as parallel. Below this angle, the
/// two parameters would be rounding errors.
const PARALLEL: f64 = 1e-12;

/// Length, `[m]`, below which the direction of a gap is rounding error.
const CROSSING: f64 = 1e-12;
