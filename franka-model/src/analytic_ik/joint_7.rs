//! Solutions for a given angle of joint 7, in closed form.

use nalgebra::{Isometry3, Vector3};

use super::solutions::{Branch, Solution, Solutions};
use crate::geometry::{ELBOW, FLANGE, Lengths, SHOULDER, WRIST};
use crate::inertia::{cross, dot};
use crate::scalar::{atan2, sin_cos, sqrt};

/// Returns all solutions with joint 7 at `q7`: none, four or eight.
pub(super) fn all(lengths: &Lengths, flange: &Isometry3<f64>, q7: f64) -> Solutions {
    let mut found = Solutions::NONE;
    let hand = Hand::of(&Flange::of(flange), q7);
    let squared = hand.to_shoulder.norm_squared();
    for elbow in Elbow::both(lengths, squared).into_iter().flatten() {
        push_all(&mut found, &hand, &elbow, elbow.q4());
    }
    found
}

/// Adds the solutions for known joints 4 and 7.
pub(super) fn push_all(found: &mut Solutions, hand: &Hand, elbow: &Elbow, q4: f64) {
    for forearm in Forearm::both(hand, elbow).into_iter().flatten() {
        push_both(found, hand, elbow, q4, &forearm);
    }
}

/// Adds the solutions for known joints 4 to 7.
pub(super) fn push_both(
    found: &mut Solutions,
    hand: &Hand,
    elbow: &Elbow,
    q4: f64,
    forearm: &Forearm,
) {
    let turn = Turn::of(&forearm.upper_arm(elbow));
    for (shoulder, [q1, q2, q3]) in turn.both() {
        found.push(Solution {
            q: crate::joint_vector([q1, q2, q3, q4, forearm.q5, forearm.q6, hand.q7]),
            branch: Branch {
                elbow: elbow.above,
                wrist: forearm.straight,
                shoulder,
            },
            slide: turn.shared.then_some([f64::NEG_INFINITY, f64::INFINITY]),
        });
    }
}

/// The flange's axes, and the vector from the shoulder to the origin of frame 7.
pub(super) struct Flange {
    pub(super) x: Vector3<f64>,
    pub(super) y: Vector3<f64>,
    pub(super) z: Vector3<f64>,
    pub(super) from_shoulder: Vector3<f64>,
}

impl Flange {
    pub(super) fn of(pose: &Isometry3<f64>) -> Self {
        let axes = pose.rotation.to_rotation_matrix();
        let axis = |i: usize| axes.matrix().column(i).into_owned();
        let z = axis(2);
        let shoulder = Vector3::new(0.0, 0.0, SHOULDER);
        Self {
            x: axis(0),
            y: axis(1),
            z,
            from_shoulder: pose.translation.vector - z * FLANGE - shoulder,
        }
    }
}

/// Axes of frame 6 in base axes, and the vector from the wrist to the shoulder.
pub(super) struct Hand {
    pub(super) q7: f64,
    pub(super) x6: Vector3<f64>,
    pub(super) y6: Vector3<f64>,
    pub(super) z6: Vector3<f64>,
    pub(super) to_shoulder: Vector3<f64>,
}

impl Hand {
    pub(super) fn of(flange: &Flange, q7: f64) -> Self {
        let (sin, cos) = sin_cos(q7);
        let x6 = flange.x * cos - flange.y * sin;
        Self {
            q7,
            x6,
            y6: -flange.z,
            z6: flange.x * sin + flange.y * cos,
            to_shoulder: x6 * WRIST - flange.from_shoulder,
        }
    }
}

/// One solution for joint 4.
#[derive(Clone, Copy)]
pub(super) struct Elbow {
    pub(super) above: bool,
    sin: f64,
    cos: f64,
    /// Vector from wrist to shoulder in frame 4: components along x and y.
    pub(super) f: f64,
    pub(super) h: f64,
}

/// Squares of the distances from the shoulder to axis 4 and from axis 4 to the wrist, `[m²]`.
fn squared_sides(lengths: &Lengths) -> [f64; 2] {
    [lengths.upper_arm, lengths.forearm].map(|length| length * length + ELBOW * ELBOW)
}

impl Elbow {
    /// Returns both solutions for the squared distance between shoulder and wrist, or none.
    fn both(lengths: &Lengths, squared_distance: f64) -> [Option<Self>; 2] {
        match cosine(Self::from_flip(lengths, squared_distance)) {
            // `f` is zero if the shoulder is on the axis of joint 5. Such postures are far outside
            // the limits.
            Some(cos) => [false, true].map(|above| {
                let elbow = Self::turned(lengths, above, cos);
                (elbow.f != 0.0).then_some(elbow)
            }),
            None => [None, None],
        }
    }

    /// Returns the solution on one side of the flip angle. The arm must be able to produce the
    /// distance, except for rounding.
    pub(super) fn on_side(lengths: &Lengths, above: bool, squared_distance: f64) -> Self {
        let cos = Self::from_flip(lengths, squared_distance).clamp(-1.0, 1.0);
        Self::turned(lengths, above, cos)
    }

    /// Returns the solution with joint 4 at `q4`.
    pub(super) fn at(lengths: &Lengths, q4: f64) -> Option<Self> {
        let above = sin_cos(q4 - lengths.flip_angle()).0 > 0.0;
        let elbow = Self::of(lengths, above, sin_cos(q4));
        (elbow.f != 0.0).then_some(elbow)
    }

    /// Returns the cosine of the angle between joint 4 and the flip angle.
    fn from_flip(lengths: &Lengths, squared_distance: f64) -> f64 {
        let [upper, fore] = squared_sides(lengths);
        (squared_distance - upper - fore) / (2.0 * sqrt(upper * fore))
    }

    fn turned(lengths: &Lengths, above: bool, cos: f64) -> Self {
        let [squared_upper, squared_fore] = squared_sides(lengths);
        let product = sqrt(squared_upper * squared_fore);
        let (upper, fore) = (lengths.upper_arm, lengths.forearm);
        let flip_cos = (upper * fore - ELBOW * ELBOW) / product;
        let flip_sin = -ELBOW * (upper + fore) / product;
        let sin = sqrt(1.0 - cos * cos);
        let sin = if above { sin } else { -sin };
        let angle = (
            flip_sin * cos + flip_cos * sin,
            flip_cos * cos - flip_sin * sin,
        );
        Self::of(lengths, above, angle)
    }

    fn of(lengths: &Lengths, above: bool, (sin, cos): (f64, f64)) -> Self {
        Self {
            above,
            sin,
            cos,
            f: ELBOW * (1.0 - cos) - lengths.upper_arm * sin,
            h: ELBOW * sin - lengths.upper_arm * cos - lengths.forearm,
        }
    }

    pub(super) fn q4(&self) -> f64 {
        atan2(self.sin, self.cos)
    }

    /// Returns the squared distance between shoulder and wrist, `[m²]`.
    pub(super) fn squared_distance(&self) -> f64 {
        self.f * self.f + self.h * self.h
    }
}

/// One solution for joints 5 and 6.
pub(super) struct Forearm {
    pub(super) straight: bool,
    q5: f64,
    q6: f64,
    x4: Vector3<f64>,
    y4: Vector3<f64>,
}

impl Forearm {
    /// Computes both solutions from the axis of joint 5. The axis is in the plane of x6 and y6. The
    /// elbow determines the component of the vector to the shoulder along this axis.
    pub(super) fn both(hand: &Hand, elbow: &Elbow) -> [Option<Self>; 2] {
        let v = &hand.to_shoulder;
        let (along, across) = (dot(&hand.x6, v), dot(&hand.y6, v));
        let length = sqrt(along * along + across * across);
        let Some(cos) = cosine(elbow.h / length) else {
            return [None, None];
        };
        let sin = sqrt(1.0 - cos * cos);
        [false, true].map(|straight| {
            let sin = if straight { -sin } else { sin };
            let s6 = (along * cos + across * sin) / length;
            let c6 = (across * cos - along * sin) / length;
            Self::of(hand, elbow, (s6, c6), Some(straight))
        })
    }

    /// Computes the solution for known sine and cosine of joint 6. The sum of their squares must be
    /// one. If `straight` is `None`, it is derived from joint 5.
    pub(super) fn of(
        hand: &Hand,
        elbow: &Elbow,
        (s6, c6): (f64, f64),
        straight: Option<bool>,
    ) -> Option<Self> {
        let (x6, y6, v) = (&hand.x6, &hand.y6, &hand.to_shoulder);
        let x5 = x6 * c6 - y6 * s6;
        let z5 = x6 * s6 + y6 * c6;
        // `beside` is the part of the vector to the shoulder that is perpendicular to the axis of
        // joint 5. In frame 5, whose y axis is −z6, its angle from x is −q5.
        let beside = v - z5 * elbow.h;
        let (s5, c5) = (
            dot(&hand.z6, &beside) / elbow.f,
            dot(&x5, &beside) / elbow.f,
        );
        let norm = sqrt(s5 * s5 + c5 * c5);
        let (s5, c5) = (s5 / norm, c5 / norm);
        // The direction is undefined only if the solution itself is undefined.
        norm.is_normal().then(|| Self {
            straight: straight.unwrap_or(c5 * elbow.f > 0.0),
            q5: atan2(s5, c5),
            q6: atan2(s6, c6),
            x4: x5 * c5 + hand.z6 * s5,
            y4: z5,
        })
    }

    /// Returns the axes of frame 3 in base axes.
    fn upper_arm(&self, elbow: &Elbow) -> [Vector3<f64>; 3] {
        let (sin, cos) = (elbow.sin, elbow.cos);
        [
            self.x4 * cos - self.y4 * sin,
            cross(&self.y4, &self.x4),
            self.x4 * sin + self.y4 * cos,
        ]
    }
}

/// Rotation of joints 1, 2 and 3: sines and cosines of one solution.
struct Turn {
    one: (f64, f64),
    two: (f64, f64),
    three: (f64, f64),
    /// True if axes 1 and 3 are in line.
    shared: bool,
}

impl Turn {
    /// Computes the rotation from the axes of frame 3.
    fn of([x3, y3, z3]: &[Vector3<f64>; 3]) -> Self {
        let radius = sqrt(z3.x * z3.x + z3.y * z3.y);
        let in_line = radius <= SHOULDER_SINGULAR;
        let (s1, c1) = if in_line {
            // Each joint gets half of the sum of both angles. With joint 2 at π, only the
            // difference of the angles matters.
            sin_cos(0.5 * atan2(x3.y - y3.x, x3.x + y3.y))
        } else {
            (z3.y / radius, z3.x / radius)
        };
        // The rotation of frame 3 in the plane of joint 2's motion is exact for any radius.
        Self {
            one: (s1, c1),
            two: (z3.x * c1 + z3.y * s1, z3.z),
            three: (x3.y * c1 - x3.x * s1, y3.y * c1 - y3.x * s1),
            shared: in_line && z3.z > 0.0,
        }
    }

    /// Returns the angles of joints 1, 2 and 3 for both signs of joint 2. The flag is true if joint
    /// 2 is negative.
    fn both(&self) -> [(bool, [f64; 3]); 2] {
        let ((s1, c1), (s2, c2), (s3, c3)) = (self.one, self.two, self.three);
        [
            (false, [atan2(s1, c1), atan2(s2, c2), atan2(s3, c3)]),
            (true, [atan2(-s1, -c1), atan2(-s2, c2), atan2(-s3, -c3)]),
        ]
    }
}

/// Returns `x` as a cosine, clamped if rounding moved it out of range, or `None` if `x` is further
/// out of range.
pub(super) fn cosine(x: f64) -> Option<f64> {
    (x.abs() <= 1.0 + FOLD).then(|| x.clamp(-1.0, 1.0))
}

/// Largest distance beyond a double root at which a pose still counts as on the root: a few
/// thousand rounding errors.
const FOLD: f64 = 1e-12;
/// Sine of joint 2 below which axes 1 and 3 count as one axis. The resulting error of the pose has
/// the same size, in radians.
const SHOULDER_SINGULAR: f64 = 1e-13;
