//! Estimates the place and the force of a contact on the arm from the external joint torques.
//!
//! ```text
//! tau_ext ──> Tare (what the torques read while nothing touches) ──> external torque
//! q ──> collision::Shape::at ──> surface in patches                        │
//!                                   └──────────> locate ──> Contact | Unknown
//! ```
//!
//! A point force `f` on link `k` loads joints 1 to `k`, each with the torque `axis · ((p − origin)
//! × f)`. It does not load the joints further out. [`locate`] divides the surface of the arm into
//! patches (1.5 to 4 centimetres wide, on the capsules that were fitted to the links). For each
//! patch, it computes the force that explains the torques best, and how well this force explains
//! them. A contact pushes: the force points into the surface, and its likelihood decreases with its
//! angle from the normal. A body's probability is the sum over its patches. The contact point is
//! the mean of the patches around the best patch.
//!
//! # What can be known
//!
//! Each joint between the base and the contact contributes one equation. A point on a surface and a
//! force are five unknowns. Therefore the contact must be far enough from the base:
//!
//! - On links 1 and 2, one or two torques determine neither the point nor the force:
//!   [`Unknown::Base`].
//! - On link 3, three torques determine the force along the normal and an approximate point. On
//!   link 4, the point depends on the angle of the force. [`Contact::spread`] is the uncertainty.
//! - If a force causes smaller torques than the errors of the estimate, the force cannot be
//!   detected: [`Unknown::Weak`].
//! - A force along a line that crosses the axes of the outer joints looks the same on several
//!   links: [`Unknown::Tie`].
//! - Shifting a force along its own line does not change the torques. The function returns the
//!   point where that line enters the arm.
//!
//! Two simultaneous contacts are treated as one contact, and a torque without a force (a firm grip)
//! is not modelled. Both leave a residual, or result in [`Unknown::Unexplained`].
//!
//! # Errors of external torques
//!
//! External torques that are measured without a contact are errors. They come from the arm's model,
//! the sensors' zero offset, and the friction between sensor and link. [`Tare`] removes the
//! constant part. Friction also hides part of a contact's torque; [`TorqueError`] states the
//! expected amount.

mod patches;
mod tare;
#[cfg(test)]
mod tests;

pub use tare::Tare;

use nalgebra::{Matrix3, Vector3};

use crate::JointVector;
use crate::collision::{Body, Capsule, Placed};
use crate::geometry::SHOULDER;
use crate::inertia::{cross, dot};
use crate::scalar::{exp, ln, sqrt};
use patches::Patch;

/// Error of the external torques, joint by joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueError {
    /// Part of the standard deviation that does not depend on the torque, `[N·m]`.
    pub floor: JointVector,
    /// Part of the standard deviation that grows with the torque, as a share of the torque, 0 to 1.
    pub share: f64,
    /// Friction between the sensor and the link, `[N·m]`. At rest, friction hides part of a
    /// contact's torque. The measured torque is then too small by at most this value.
    pub friction: JointVector,
}

impl TorqueError {
    /// Errors of an arm at rest after [`Tare`].
    ///
    /// The floor contains the noise of the sensors and the drift of a few seconds. It contains no
    /// friction, because the friction of a resting joint is constant. The friction values were
    /// fitted on the link's side of the sensors by Gaz et al. 2019 (Dynamic Identification of the
    /// Franka Emika Panda Robot With Retrieval of Feasible Parameters).
    pub const AT_REST: Self = Self {
        floor: crate::joint_vector([0.08, 0.08, 0.08, 0.08, 0.05, 0.05, 0.05]),
        share: 0.03,
        friction: crate::joint_vector([0.27, 0.44, 0.32, 0.64, 0.42, 0.15, 0.28]),
    };

    /// Errors of a moving arm after [`Tare`]. Sliding friction does not depend on contacts, but it
    /// changes with velocity and posture.
    ///
    /// The floor is close to the residual torques of simulated arms with stiction and elasticity,
    /// whose joints swung at up to 0.25 rad/s. The root mean square of the residuals ranged from
    /// 0.13 N·m (joint 7) to 0.55 N·m (joint 2). With a floor one third lower, one reported body in
    /// thirteen was wrong.
    pub const IN_MOTION: Self = Self {
        floor: crate::joint_vector([0.35, 0.4, 0.3, 0.4, 0.3, 0.15, 0.14]),
        share: 0.05,
        friction: crate::joint_vector([0.0; 7]),
    };

    /// Returns the probable torque for the measured torque `read`, and the reciprocal of its
    /// variance. The function assumes that friction hides a torque between zero and its full value.
    fn correct(&self, i: usize, read: f64) -> (f64, f64) {
        let friction = self.friction[i];
        let taken = if friction > 0.0 {
            0.5 * friction * (1.0 - exp(-read.abs() / friction))
        } else {
            0.0
        };
        let part = self.share * read;
        let variance = self.floor[i] * self.floor[i] + part * part + taken * taken;
        (read + taken.copysign(read), 1.0 / variance)
    }
}

/// A contact at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The touched body: a link or the tool on the flange.
    pub body: Body,
    /// Point on the surface where the force acts, `[m]`, in the base frame.
    pub point: Vector3<f64>,
    /// Outward unit normal of the surface at that point, in base axes.
    pub normal: Vector3<f64>,
    /// Force on the arm, `[N]`, in base axes.
    pub force: Vector3<f64>,
    /// External torques that the force does not explain, `[N·m]`.
    pub residual: JointVector,
    /// Probability that the contact is on this body, 0 to 1.
    pub probability: f64,
    /// Uncertainty of the point, `[m]`. It is the root mean square distance between
    /// [`point`](Self::point) and the other points on this body that explain the torques equally
    /// well.
    pub spread: f64,
    /// The second most probable body and its probability.
    pub next: Option<(Body, f64)>,
}

/// Reason why the place of a contact is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Unknown {
    /// The torques are not finite.
    NotFinite,
    /// The arm has no contact, or the torques of the contact are within the errors of the estimate.
    Weak {
        /// Root mean square of the torques divided by their standard deviations.
        ratio: f64,
    },
    /// The contact is probably on link 1 or 2. Too few joints provide information about these
    /// links.
    Base {
        /// The more probable of links 1 and 2.
        body: Body,
        /// Probability that the contact is on either of these links, 0 to 1.
        probability: f64,
    },
    /// Several bodies explain the torques about equally well.
    Tie {
        /// The contact on the most probable body.
        likeliest: Contact,
    },
    /// No force at one point explains the torques. The arm has several contacts, or a grip
    /// twists it, for example.
    Unexplained {
        /// Root mean square of the residual torques of the best force, divided by their standard
        /// deviations.
        ratio: f64,
        /// The contact whose force explains the torques best.
        nearest: Contact,
    },
}

/// Returns the contact on `arm` that explains the external torques, `[N·m]`. External torques are
/// the torques that the environment exerts on the joints, minus their values without contact. A
/// state's `tau_ext_hat_filtered` has the opposite sign.
///
/// The function takes at most about 0.4 ms and does not allocate. It is too slow for the control
/// thread.
///
/// # Errors
/// [`Unknown`] if the torques do not determine the contact.
// The crate has no heap, so it cannot box the contact.
#[allow(clippy::result_large_err)]
pub fn locate(
    arm: &Placed<'_>,
    torque: &JointVector,
    error: &TorqueError,
) -> Result<Contact, Unknown> {
    if !torque.iter().all(|x| x.is_finite()) {
        return Err(Unknown::NotFinite);
    }
    let search = Search::new(arm, torque, error);
    let ratio = sqrt(search.square(&search.torque) / 7.0);
    if ratio < WEAK {
        return Err(Unknown::Weak { ratio });
    }
    let bodies = search.bodies();
    let evidence = bodies.map(|(evidence, _)| evidence);
    let total: f64 = evidence.iter().sum();
    let probability = |number: usize| evidence[number] / total;
    let best = largest(&evidence, None);
    let next = largest(&evidence, Some(best));
    let inner = probability(1) + probability(2);
    if best <= 2 {
        return Err(Unknown::Base {
            body: body(best),
            probability: inner,
        });
    }
    let mut contact = search.contact(body(best), &bodies[best].1);
    contact.probability = probability(best);
    contact.next = (evidence[next] > 0.0).then(|| (body(next), probability(next)));
    let left = sqrt(search.square(&contact.residual) / 7.0);
    if left > UNEXPLAINED {
        return Err(Unknown::Unexplained {
            ratio: left,
            nearest: contact,
        });
    }
    if contact.probability < SURE {
        return Err(Unknown::Tie { likeliest: contact });
    }
    Ok(contact)
}

/// The torques, and the bodies on which the contact may be.
struct Search<'a> {
    arm: &'a Placed<'a>,
    surfaces: [Option<(Body, Capsule)>; SURFACES],
    /// Torques after the correction for friction.
    torque: JointVector,
    weights: [f64; 7],
    /// Weighted square of the torques of joint `i` and of the joints further out.
    beyond: [f64; 8],
}

/// The force on a patch that explains the torques best.
struct Fit {
    force: Vector3<f64>,
    /// Logarithm of the probability of the torques if the force acts on this patch, up to a
    /// constant. The value grows with the area of the patch.
    evidence: f64,
}

impl<'a> Search<'a> {
    fn new(arm: &'a Placed<'a>, read: &JointVector, error: &TorqueError) -> Self {
        let mut surfaces = [None; SURFACES];
        for (slot, surface) in surfaces.iter_mut().zip(arm.surfaces()) {
            *slot = Some(surface);
        }
        let corrected: [_; 7] = core::array::from_fn(|i| error.correct(i, read[i]));
        let torque = JointVector::from(corrected.map(|(torque, _)| torque));
        let weights = corrected.map(|(_, weight)| weight);
        let mut beyond = [0.0; 8];
        for i in (0..7).rev() {
            beyond[i] = beyond[i + 1] + weights[i] * torque[i] * torque[i];
        }
        Self {
            arm,
            surfaces,
            torque,
            weights,
            beyond,
        }
    }

    fn square(&self, torque: &JointVector) -> f64 {
        (0..7)
            .map(|i| self.weights[i] * torque[i] * torque[i])
            .sum()
    }

    fn surfaces(&self) -> impl Iterator<Item = &(Body, Capsule)> {
        self.surfaces.iter().flatten()
    }

    /// Calls `each` with every patch of a moving body that no other capsule covers.
    fn visit(&self, of: Body, spacing: f64, mut each: impl FnMut(&Patch)) {
        for (index, (body, capsule)) in self.surfaces().enumerate() {
            if *body != of {
                continue;
            }
            patches::visit(capsule, spacing, |patch| {
                let covered = self.surfaces().enumerate().any(|(other, (by, capsule))| {
                    other != index
                        && by.number().abs_diff(of.number()) <= 1
                        && patches::contains(capsule, SKIN, &patch.point)
                });
                if !covered {
                    each(&patch);
                }
            });
        }
    }

    /// Returns two values for each body number: the probability of a contact, relative to the most
    /// probable body, and the point of the body's best patch. A priori, all bodies and all points
    /// on a body are equally probable.
    fn bodies(&self) -> [(f64, Vector3<f64>); BODIES] {
        let mut logarithms = [f64::NEG_INFINITY; BODIES];
        let mut places = [Vector3::zeros(); BODIES];
        for number in 1..BODIES {
            let (mut most, mut sum, mut area) = (f64::NEG_INFINITY, 0.0, 0.0);
            self.visit(body(number), COARSE[number], |patch| {
                area += patch.area;
                let Some(fit) = self.fit(body(number), patch) else {
                    return;
                };
                if fit.evidence > most {
                    sum = sum * exp(most - fit.evidence) + 1.0;
                    most = fit.evidence;
                    places[number] = patch.point;
                } else {
                    sum += exp(fit.evidence - most);
                }
            });
            if sum > 0.0 {
                logarithms[number] = most + ln(sum / area);
            }
        }
        let most = logarithms.into_iter().fold(f64::NEG_INFINITY, f64::max);
        core::array::from_fn(|i| (exp(logarithms[i] - most), places[i]))
    }

    /// Returns the contact on this body, with the mean of the points around the body's best patch.
    fn contact(&self, of: Body, around: &Vector3<f64>) -> Contact {
        let (mut most, mut sum) = (f64::NEG_INFINITY, 0.0);
        let (mut point, mut normal) = (Vector3::zeros(), Vector3::zeros());
        let (mut force, mut all, mut square) = (Vector3::zeros(), 0.0, 0.0);
        self.visit(of, FINE, |patch| {
            let Some(fit) = self.fit(of, patch) else {
                return;
            };
            if fit.evidence > most {
                let scale = exp(most - fit.evidence);
                most = fit.evidence;
                sum *= scale;
                all *= scale;
                square *= scale;
                point *= scale;
                normal *= scale;
                force *= scale;
            }
            let weight = exp(fit.evidence - most);
            let way = patch.point - around;
            let distance = dot(&way, &way);
            all += weight;
            square += weight * distance;
            if distance < NEAR * NEAR {
                sum += weight;
                point += patch.point * weight;
                normal += patch.normal * weight;
                force += fit.force * weight;
            }
        });
        let scale = 1.0 / sum;
        let (point, force) = (point * scale, force * scale);
        let mut residual = self.torque;
        for i in 0..of.joints() {
            residual[i] -= dot(&self.row(i, &point), &force);
        }
        Contact {
            body: of,
            point: point + Vector3::new(0.0, 0.0, SHOULDER),
            normal: normal / sqrt(dot(&normal, &normal)),
            force,
            residual,
            probability: 1.0,
            spread: sqrt(square / all),
            next: None,
        }
    }

    /// Returns the torque of joint `i` per force at a point, `[m]`.
    fn row(&self, i: usize, point: &Vector3<f64>) -> Vector3<f64> {
        let chain = self.arm.chain();
        cross(&chain.axis[i], point) + chain.moment[i]
    }

    /// Returns the force on a patch that explains the torques best, or `None` if this force pulls.
    ///
    /// The function minimises the weighted square of the residual torques. The force across the
    /// normal counts as a measurement of zero. Its standard deviation is proportional to the force
    /// along the normal, so the search needs several passes.
    fn fit(&self, of: Body, patch: &Patch) -> Option<Fit> {
        let joints = of.joints();
        let (mut normal_matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for i in 0..joints {
            let row = self.row(i, &patch.point);
            let weighted = row * self.weights[i];
            normal_matrix.ger(1.0, &weighted, &row, 1.0);
            right += weighted * self.torque[i];
        }
        let inwards = -patch.normal;
        let along = dot(&inwards, &right) / dot(&inwards, &(normal_matrix * inwards)).max(1e-9);
        let mut push = along.clamp(PUSH_LEAST, PUSH_MOST);
        let mut force = Vector3::zeros();
        let (mut determinant, mut lean) = (0.0, 0.0);
        for _ in 0..PASSES {
            lean = LEAN * push;
            let across = 1.0 / (lean * lean);
            let mut matrix = normal_matrix;
            matrix.ger(-across, &inwards, &inwards, 1.0);
            for i in 0..3 {
                matrix[(i, i)] += across + 1.0 / (PUSH_MOST * PUSH_MOST);
            }
            let (inverse, of_it) = inverse(&matrix)?;
            determinant = of_it;
            force = inverse * right;
            push = dot(&inwards, &force).clamp(PUSH_LEAST, PUSH_MOST);
        }
        if dot(&inwards, &force) <= 0.0 {
            return None;
        }
        let square = self.beyond[0] - dot(&right, &force);
        let volume = patch.area / (sqrt(determinant) * lean * lean);
        Some(Fit {
            force,
            evidence: ln(volume) - 0.5 * square,
        })
    }
}

/// Returns the inverse of a symmetric positive definite matrix, and its determinant.
fn inverse(m: &Matrix3<f64>) -> Option<(Matrix3<f64>, f64)> {
    let (c0, c1, c2) = (m.column(0), m.column(1), m.column(2));
    let (a, b, c) = (c1.cross(&c2), c2.cross(&c0), c0.cross(&c1));
    let determinant = c0.dot(&a);
    // The adjugate of a symmetric matrix is symmetric.
    (determinant > 0.0).then(|| (Matrix3::from_columns(&[a, b, c]) / determinant, determinant))
}

fn body(number: usize) -> Body {
    match number {
        0..=7 => Body::Link(number as u8),
        _ => Body::Tool,
    }
}

/// Returns the largest value, ignoring the body `except`.
fn largest(values: &[f64; BODIES], except: Option<usize>) -> usize {
    (1..BODIES)
        .filter(|&i| Some(i) != except)
        .fold(0, |best, i| if values[i] > values[best] { i } else { best })
}

/// Number of bodies: the base, seven links and a tool.
const BODIES: usize = 9;

const SURFACES: usize = crate::collision::CAPACITY;

/// Width of the patches for the choice of the body, by body number, `[m]`. If a force moves to the
/// next patch, the torques change by less than their errors, which are larger near the base. With
/// patches of 25 mm on all bodies, one body in 40 was wrong that is right with these widths.
const COARSE: [f64; BODIES] = [1.0, 0.04, 0.04, 0.03, 0.03, 0.025, 0.018, 0.015, 0.015];

/// Width of the patches for the contact point, `[m]`. The patches are finer than the precision of
/// the point.
const FINE: f64 = 0.012;

/// Depth inside another capsule at which a patch counts as covered, `[m]`.
const SKIN: f64 = 0.003;

/// Distance from the best patch, `[m]`, within which patches count as the same contact.
const NEAR: f64 = 0.06;

/// Standard deviation of the force across the normal, divided by the force along the normal. Hands
/// and edges push within about 30 degrees of the normal.
const LEAN: f64 = 0.35;

/// Smallest force of the search, `[N]`.
const PUSH_LEAST: f64 = 1.0;
const PUSH_MOST: f64 = 200.0;

/// Number of passes for the force along the normal.
const PASSES: usize = 3;

/// Root mean square of the torques, in standard deviations, below which the function assumes that
/// there is no contact.
const WEAK: f64 = 1.5;

/// Root mean square of the residual, in standard deviations, above which errors of the torques
/// cannot explain the residual.
const UNEXPLAINED: f64 = 3.0;

/// Probability above which the function reports a contact instead of a tie.
const SURE: f64 = 0.75;
