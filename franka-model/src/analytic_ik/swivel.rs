//! Joint 7 from the swivel angle: the roots of one equation.
//!
//! A given angle of joint 7 determines the position of the wrist and the angle of joint 4. The
//! swivel angle then determines the position of the elbow, and therefore the forearm's axis y4.
//! This axis is also the axis of joint 5, so it must be at right angles to the axis of joint 6:
//!
//! ```text
//! g(q7) = y4 · z6 = 0        one equation for each side of the elbow
//! ```
//!
//! The solver seeks the roots of `g` on arcs of joint 7. On these arcs, joint 4 can produce the
//! distance between shoulder and wrist within its range. Samples are dense where the half plane of
//! the elbow turns quickly, because the wrist passes near axis 1. The solver brackets every change
//! of sign. Where samples approach zero without a change of sign, the solver computes the extremum
//! to find two close roots. At the ends of an arc, `g` behaves like a square root; the cosine
//! spacing of the samples compensates for this.

use core::f64::consts::PI;

use nalgebra::{Isometry3, Vector3};

use super::bracket;
use super::joint_7::{Elbow, Flange, Forearm, Hand, push_both};
use super::solutions::Solutions;
use crate::geometry::{Lengths, WRIST};
use crate::inertia::dot;
use crate::scalar::{acos, atan2, sin_cos, sqrt};

/// Returns all solutions with the swivel angle `angle` and with joint 4 within `q4_range`.
pub(super) fn all(
    lengths: &Lengths,
    flange: &Isometry3<f64>,
    angle: f64,
    q4_range: [f64; 2],
) -> Solutions {
    let mut found = Solutions::NONE;
    let flange = Flange::of(flange);
    let (sin, cos) = sin_cos(angle);
    let [lower, upper] = q4_range;
    for (above, far) in [(false, lower), (true, upper)] {
        if above == (far < lengths.flip_angle()) {
            continue; // no part of the range on this side
        }
        let side = Side {
            lengths,
            flange: &flange,
            above,
            sin,
            cos,
        };
        for arc in side.arcs(far).into_iter().flatten() {
            arc.roots(&side, |q7| side.push(&mut found, q7));
        }
    }
    found
}

/// The equation for one side of the elbow.
struct Side<'a> {
    lengths: &'a Lengths,
    flange: &'a Flange,
    above: bool,
    /// Sine of the swivel angle.
    sin: f64,
    cos: f64,
}

/// Terms of the equation at one angle of joint 7.
struct Forming {
    hand: Hand,
    elbow: Elbow,
    y4: Vector3<f64>,
    g: f64,
    /// Horizontal vector from the shoulder to the wrist, `[m]`.
    horizontal: [f64; 2],
}

impl Side<'_> {
    fn at(&self, q7: f64) -> Forming {
        let hand = Hand::of(self.flange, q7);
        let w = -hand.to_shoulder;
        let squared = dot(&w, &w);
        let elbow = Elbow::on_side(self.lengths, self.above, squared);
        let (length, offset) = (sqrt(squared), sqrt(w.x * w.x + w.y * w.y));
        // The unit vector towards the elbow, at right angles to w, is the sum of an upward part and
        // a part turned about w.
        let (up, turned) = (self.cos / (length * offset), self.sin / offset);
        let towards = Vector3::new(
            -w.x * w.z * up + w.y * turned,
            -w.y * w.z * up - w.x * turned,
            offset * offset * up,
        );
        let f = if self.above { -elbow.f } else { elbow.f };
        let y4 = w * (-elbow.h / squared) - towards * (f / length);
        Forming {
            g: dot(&y4, &hand.z6),
            horizontal: [w.x, w.y],
            hand,
            elbow,
            y4,
        }
    }

    fn push(&self, found: &mut Solutions, q7: f64) {
        let Forming {
            hand, elbow, y4, g, ..
        } = self.at(q7);
        // If the half plane jumps, the sign changes without a root.
        if g.abs() > JUMP || g.is_nan() {
            return;
        }
        let (s6, c6) = (dot(&y4, &hand.x6), dot(&y4, &hand.y6));
        let norm = sqrt(s6 * s6 + c6 * c6);
        let mut forearm = Forearm::of(&hand, &elbow, (s6 / norm, c6 / norm), None);
        if g.abs() > ROUNDING {
            // The equation is so steep here that no floating-point number is closer to the root.
            // The solution has the exact pose, and an approximate swivel angle.
            let same =
                |other: &Forearm| Some(other.straight) == forearm.as_ref().map(|f| f.straight);
            let exact = Forearm::both(&hand, &elbow).into_iter().flatten();
            forearm = exact.into_iter().find(same).or(forearm);
        }
        if let Some(forearm) = forearm {
            push_both(found, &hand, &elbow, elbow.q4(), &forearm);
        }
    }

    /// Returns the arcs on which joint 4 is between the flip angle and `far`.
    fn arcs(&self, far: f64) -> [Option<Arc>; 2] {
        let d = &self.flange.from_shoulder;
        let (p, q) = (dot(d, &self.flange.x), dot(d, &self.flange.y));
        let radius = sqrt(p * p + q * q);
        let squared = dot(d, d) + WRIST * WRIST;
        let reach = |q4| {
            let elbow = Elbow::at(self.lengths, q4);
            elbow.map_or(0.0, |elbow| elbow.squared_distance())
        };
        // The wrist's squared distance is `squared − 2 WRIST radius cos(off)`.
        let off = |squared_distance: f64| {
            let cos = (squared - squared_distance) / (2.0 * WRIST * radius.max(f64::MIN_POSITIVE));
            acos(cos.clamp(-1.0, 1.0))
        };
        let slack = 1e-12;
        let (least, most) = (
            off(reach(far) - slack),
            off(reach(self.lengths.flip_angle()) + slack),
        );
        if least >= most {
            return [None, None]; // true for NaN also
        }
        let nearest = atan2(-q, p);
        [1.0, -1.0].map(|direction| {
            Some(Arc {
                middle: nearest + direction * 0.5 * (least + most),
                half: direction * 0.5 * (most - least),
            })
        })
    }
}

/// An interval of joint 7, parametrised by an angle from 0 to π.
struct Arc {
    middle: f64,
    half: f64,
}

/// The equation at one sample of the interval.
#[derive(Clone, Copy)]
struct Sample {
    place: f64,
    g: f64,
    horizontal: [f64; 2],
}

impl Sample {
    /// Returns true if the interval up to `other` may contain undetected roots.
    fn hides_something_before(&self, other: &Self) -> bool {
        let ([a, b], [c, d]) = (self.horizontal, other.horizontal);
        let (along, across) = (a * c + b * d, a * d - b * c);
        let turns = across.abs() > TURN * along;
        let near_root = (self.g - other.g).abs() > self.g.abs().min(other.g.abs());
        turns || (near_root && other.place - self.place > FINE)
    }

    fn point(&self) -> (f64, f64) {
        (self.place, self.g)
    }

    fn opposes(&self, other: &Self) -> bool {
        (self.g > 0.0) != (other.g > 0.0)
    }
}

impl Arc {
    fn q7(&self, place: f64) -> f64 {
        self.middle - self.half * sin_cos(place).1
    }

    fn sample(&self, side: &Side<'_>, place: f64) -> Sample {
        let Forming { g, horizontal, .. } = side.at(self.q7(place));
        Sample {
            place,
            g,
            horizontal,
        }
    }

    /// Calls `visit` with the joint angle of every root.
    fn roots(&self, side: &Side<'_>, mut visit: impl FnMut(f64)) {
        let sample = |place: f64| self.sample(side, place);
        let g = |place: f64| side.at(self.q7(place)).g;
        let mut visit = |place: f64| visit(self.q7(place));
        let mut before: Option<Sample> = None;
        let mut left = sample(0.0);
        for step in 1..=STEPS {
            // Stack of samples to visit. The last entry is the next sample.
            let mut pending = [sample(PI * f64::from(step) / f64::from(STEPS)); HALVINGS + 1];
            let mut count = 1;
            while count > 0 {
                let right = pending[count - 1];
                if count <= HALVINGS && left.hides_something_before(&right) {
                    pending[count] = sample(0.5 * (left.place + right.place));
                    count += 1;
                    continue;
                }
                count -= 1;
                if left.opposes(&right) {
                    visit(bracket::root(g, left.point(), right.point()));
                } else if left.g.abs() <= right.g.abs() {
                    match before {
                        Some(before) if before.opposes(&left) => {}
                        Some(before) if before.g.abs() < left.g.abs() => {}
                        Some(before) => {
                            let points = [before.point(), left.point(), right.point()];
                            bracket::dip(g, points, &mut visit);
                        }
                        None => bracket::dip_at_end(g, left.point(), right.point(), &mut visit),
                    }
                }
                before = Some(left);
                left = right;
            }
        }
        if let Some(before) = before
            && !before.opposes(&left)
            && left.g.abs() < before.g.abs()
        {
            bracket::dip_at_end(g, left.point(), before.point(), &mut visit);
        }
    }
}

/// Number of samples of an arc, without its first sample.
const STEPS: u32 = 24;
/// Largest number of halvings of an interval between samples.
const HALVINGS: usize = 24;
/// Distance of samples around a root, `[rad]` of the interval's parameter.
const FINE: f64 = 0.13 * PI / STEPS as f64;
/// Tangent of the largest turn of the elbow's half plane between samples.
const TURN: f64 = 0.3;
/// Typical value of `g` at a root. The value is larger at steep roots, where the wrist is within
/// millimetres of axis 1.
const ROUNDING: f64 = 1e-14;
/// Largest value of `g` at any root.
const JUMP: f64 = 1e-9;
