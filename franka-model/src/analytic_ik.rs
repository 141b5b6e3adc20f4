//! Every joint position for a pose of the flange and an angle of joint 7.
//!
//! With joint 7 given, the flange's pose fixes the wrist, where axes 5 and 6 meet. Shoulder, elbow
//! and wrist make a triangle, whose sides give joint 4; the direction of the forearm in the hand's
//! axes gives joints 6 and 5; what is left for joints 1, 2 and 3 is a rotation. Every step is an
//! equivalence with two answers at most, three of them two: at most eight solutions, none lost.
//! The idea of fixing joint 7 is that of He and Liu (2021), the enumeration that of López-Custodio,
//! Gong and Figueredo (GeoFIK, 2025).
//!
//! ```text
//! pose, q7 ─> wrist ─> elbow: q4 (2) ─> wrist: q6, q5 (2) ─> shoulder: q1, q2, q3 (2)
//! ```
//!
//! # Singularities
//!
//! Two solutions meet where the arm is stretched (joint 4 at
//! [`FLIP_ANGLE`](crate::elbow::FLIP_ANGLE)) or where joint 5 is a quarter turn off; both are
//! listed there, the same twice, and a pose beyond by less than 1e-12 in the cosine counts as on
//! it. Where joint 2 is zero, axes 1 and 3 coincide: the pose fixes the sum of their angles only,
//! and each takes half of it. Around that place the two angles of a solution may differ much from
//! those of a neighbouring pose, though they reproduce their own pose; a controller that follows a
//! path through it is better off with [`differential_ik`](crate::differential_ik).

use core::f64::consts::TAU;
use core::ops::Deref;

use nalgebra::{Isometry3, Vector3};

use crate::frame::EndEffector;
use crate::geometry::{ELBOW, FLANGE, FOREARM, SHOULDER, UPPER_ARM, WRIST};
use crate::inertia::{cross, dot};
use crate::inverse_kinematics::IkError;
use crate::model::Model;
use crate::scalar::{atan2, sin_cos, sqrt};
use crate::{JointVector, transform};

/// Which of the two answers of each step a solution takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Branch {
    /// Joint 4 above the [flip angle](crate::elbow::FLIP_ANGLE).
    pub elbow: bool,
    /// Joint 5 within a quarter turn of zero, for positions of joint 4 within its limits.
    pub wrist: bool,
    /// Joint 2 negative.
    pub shoulder: bool,
}

/// One solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Joint positions, `[rad]`.
    pub q: JointVector,
    /// Which one it is: the same along a path that crosses no singularity.
    pub branch: Branch,
}

/// Up to eight solutions, as a slice.
#[derive(Debug, Clone, Copy)]
pub struct Solutions {
    list: [Solution; 8],
    count: usize,
}

impl Solutions {
    const NONE: Self = Self {
        list: [Solution {
            q: crate::joint_vector([0.0; 7]),
            branch: Branch {
                elbow: false,
                wrist: false,
                shoulder: false,
            },
        }; 8],
        count: 0,
    };

    fn push(&mut self, solution: Solution) {
        self.list[self.count] = solution;
        self.count += 1;
    }

    /// Those within `lower` and `upper` `[rad]`, angles taken a turn on where that brings them in.
    ///
    /// No joint of these robots has a range of a turn, so the place within it is unique.
    pub fn within(&self, lower: &JointVector, upper: &JointVector) -> Self {
        let mut kept = Self::NONE;
        for solution in self.iter() {
            let q = JointVector::from_fn(|i, _| {
                let q = solution.q[i];
                if q < lower[i] {
                    q + TAU
                } else if q > upper[i] {
                    q - TAU
                } else {
                    q
                }
            });
            if (0..7).all(|i| lower[i] <= q[i] && q[i] <= upper[i]) {
                kept.push(Solution { q, ..*solution });
            }
        }
        kept
    }

    /// The solution whose largest joint displacement from `q` is least.
    pub fn nearest(&self, q: &JointVector) -> Option<&Solution> {
        let distance = |solution: &&Solution| (solution.q - q).amax();
        self.iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

impl Deref for Solutions {
    type Target = [Solution];

    fn deref(&self) -> &[Solution] {
        &self.list[..self.count]
    }
}

/// The solutions within the joint limits that bring the end effector to `target` with joint 7 at
/// `q7` `[rad]`. There may be none.
///
/// An end-effector frame that is not quite rigid counts as its nearest rigid one. Took 0.6 µs on a
/// virtual machine of 2026, 0.5 µs of it in [`all`].
///
/// # Errors
/// [`IkError::NotFinite`] and [`IkError::EndEffectorNotRigid`].
pub fn solve(
    model: &Model,
    target: &Isometry3<f64>,
    ee: &EndEffector,
    q7: f64,
) -> Result<Solutions, IkError> {
    let tool = transform::isometry(&ee.f_t_ee).ok_or(IkError::EndEffectorNotRigid)?;
    let flange = target * tool.inverse();
    let finite = |x: &f64| x.is_finite();
    if !(q7.is_finite() && transform::matrix(&flange).iter().all(finite)) {
        return Err(IkError::NotFinite);
    }
    let limits = model.joint_limits();
    Ok(all(&flange, q7).within(&limits.lower, &limits.upper))
}

/// All solutions for a pose of the flange in the base frame with joint 7 at `q7` `[rad]`, whatever
/// the limits: none, four or eight. Angles are in `(−π, π]`, that of joint 7 as given.
///
/// The same for both kinds of robot. None for numbers that are not finite.
pub fn all(flange: &Isometry3<f64>, q7: f64) -> Solutions {
    let mut found = Solutions::NONE;
    let hand = Hand::of(flange, q7);
    for elbow in Elbow::both(&hand.to_shoulder).into_iter().flatten() {
        for forearm in Forearm::both(&hand, &elbow).into_iter().flatten() {
            for (shoulder, [q1, q2, q3]) in shoulder_angles(&forearm.upper_arm(&elbow)) {
                found.push(Solution {
                    q: crate::joint_vector([q1, q2, q3, elbow.q4, forearm.q5, forearm.q6, q7]),
                    branch: Branch {
                        elbow: elbow.above,
                        wrist: forearm.straight,
                        shoulder,
                    },
                });
            }
        }
    }
    found
}

/// Axes of frame 6 in base axes, and the way from the wrist to the shoulder.
struct Hand {
    x6: Vector3<f64>,
    y6: Vector3<f64>,
    z6: Vector3<f64>,
    to_shoulder: Vector3<f64>,
}

impl Hand {
    fn of(flange: &Isometry3<f64>, q7: f64) -> Self {
        let axes = flange.rotation.to_rotation_matrix();
        let axis = |i: usize| axes.matrix().column(i).into_owned();
        let (x, y, z) = (axis(0), axis(1), axis(2));
        let (sin, cos) = sin_cos(q7);
        let x6 = x * cos - y * sin;
        let wrist = flange.translation.vector - z * FLANGE - x6 * WRIST;
        Self {
            x6,
            y6: -z,
            z6: cross(&z, &x6),
            to_shoulder: Vector3::new(0.0, 0.0, SHOULDER) - wrist,
        }
    }
}

/// One answer for joint 4.
struct Elbow {
    above: bool,
    q4: f64,
    sin: f64,
    cos: f64,
    /// Wrist to shoulder in frame 4: along x, along y.
    f: f64,
    h: f64,
}

impl Elbow {
    /// From the triangle of shoulder, elbow and wrist.
    fn both(to_shoulder: &Vector3<f64>) -> [Option<Self>; 2] {
        // Squared sides: upper arm and forearm with their offsets.
        let side3 = UPPER_ARM * UPPER_ARM + ELBOW * ELBOW;
        let side5 = FOREARM * FOREARM + ELBOW * ELBOW;
        let product = sqrt(side3 * side5);
        let from_flip = (to_shoulder.norm_squared() - side3 - side5) / (2.0 * product);
        let Some(cos) = cosine(from_flip) else {
            return [None, None];
        };
        let sin = sqrt(1.0 - cos * cos);
        let flip_cos = (UPPER_ARM * FOREARM - ELBOW * ELBOW) / product;
        let flip_sin = -ELBOW * (UPPER_ARM + FOREARM) / product;
        [false, true].map(|above| {
            let sin = if above { sin } else { -sin };
            let (sin, cos) = (
                flip_sin * cos + flip_cos * sin,
                flip_cos * cos - flip_sin * sin,
            );
            let f = ELBOW * (1.0 - cos) - UPPER_ARM * sin;
            // Shoulder on the axis of joint 5: far outside the limits.
            (f != 0.0).then(|| Self {
                above,
                q4: atan2(sin, cos),
                sin,
                cos,
                f,
                h: ELBOW * sin - UPPER_ARM * cos - FOREARM,
            })
        })
    }
}

/// One answer for joints 5 and 6.
struct Forearm {
    straight: bool,
    q5: f64,
    q6: f64,
    x4: Vector3<f64>,
    y4: Vector3<f64>,
}

impl Forearm {
    /// From the axis of joint 5, which is in the plane of x6 and y6 and whose part of the way to
    /// the shoulder the elbow says.
    fn both(hand: &Hand, elbow: &Elbow) -> [Option<Self>; 2] {
        let (x6, y6, v) = (&hand.x6, &hand.y6, &hand.to_shoulder);
        let (along, across) = (dot(x6, v), dot(y6, v));
        let length = sqrt(along * along + across * across);
        let Some(cos) = cosine(elbow.h / length) else {
            return [None, None];
        };
        let sin = sqrt(1.0 - cos * cos);
        [false, true].map(|straight| {
            let sin = if straight { -sin } else { sin };
            let s6 = (along * cos + across * sin) / length;
            let c6 = (across * cos - along * sin) / length;
            let x5 = x6 * c6 - y6 * s6;
            let z5 = x6 * s6 + y6 * c6;
            // Shoulder beside the axis of joint 5, in frame 5 (whose y axis is −z6), where it is
            // at −q5 from x.
            let beside = v - z5 * elbow.h;
            let (s5, c5) = (
                dot(&hand.z6, &beside) / elbow.f,
                dot(&x5, &beside) / elbow.f,
            );
            let norm = sqrt(s5 * s5 + c5 * c5);
            let (s5, c5) = (s5 / norm, c5 / norm);
            // A direction is lost only with the solution itself.
            norm.is_normal().then(|| Self {
                straight,
                q5: atan2(s5, c5),
                q6: atan2(s6, c6),
                x4: x5 * c5 + hand.z6 * s5,
                y4: z5,
            })
        })
    }

    /// Axes of frame 3 in base axes.
    fn upper_arm(&self, elbow: &Elbow) -> [Vector3<f64>; 3] {
        let (sin, cos) = (elbow.sin, elbow.cos);
        [
            self.x4 * cos - self.y4 * sin,
            cross(&self.y4, &self.x4),
            self.x4 * sin + self.y4 * cos,
        ]
    }
}

/// Angles of joints 1, 2 and 3 for the axes of frame 3, with whether joint 2 is negative.
fn shoulder_angles([x3, y3, z3]: &[Vector3<f64>; 3]) -> [(bool, [f64; 3]); 2] {
    let radius = sqrt(z3.x * z3.x + z3.y * z3.y);
    let (s1, c1) = if radius > SHOULDER_SINGULAR {
        (z3.y / radius, z3.x / radius)
    } else {
        // Half of the sum of both angles; only their difference matters with joint 2 at π.
        sin_cos(0.5 * atan2(x3.y - y3.x, x3.x + y3.y))
    };
    // The turn of frame 3 in the plane that joint 2 moves: exact however small the radius.
    let (s3, c3) = (x3.y * c1 - x3.x * s1, y3.y * c1 - y3.x * s1);
    let s2 = z3.x * c1 + z3.y * s1;
    [
        (false, [atan2(s1, c1), atan2(s2, z3.z), atan2(s3, c3)]),
        (true, [atan2(-s1, -c1), atan2(-s2, z3.z), atan2(-s3, -c3)]),
    ]
}

/// A cosine that rounding may have moved out of its range; `None` for what is none.
fn cosine(x: f64) -> Option<f64> {
    (x.abs() <= 1.0 + FOLD).then(|| x.clamp(-1.0, 1.0))
}

/// How far beyond a double root a pose still counts as on it: some thousand roundings.
const FOLD: f64 = 1e-12;
/// Sine of joint 2 below which axes 1 and 3 count as one. What this neglects in the pose is of the
/// same size, in radians.
const SHOULDER_SINGULAR: f64 = 1e-13;

#[cfg(test)]
mod tests;
