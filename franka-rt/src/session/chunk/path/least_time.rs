//! The fastest motion along a path: the same curve, traversed as fast as the limits of velocity,
//! acceleration and jerk allow.
//!
//! A motion `q(t)` that is within the limits is traversed at another rate. `T` is the new time and
//! `x = (dt/dT)^2`. A dash is the derivative with respect to `t`, and `v, a, j` are the derivatives
//! of the given motion:
//!
//! ```text
//! new velocity     = sqrt(x) v
//! new acceleration = x a + x' v / 2
//! new jerk         = sqrt(x) (x j + 3/2 x' a + x'' v / 2)
//! new duration     = integral of 1 / sqrt(x)
//! ```
//!
//! `x` is a quadratic spline: `x''` is constant between two nodes. If the motion begins or ends at
//! rest, it does so with a jerk, so `x` is also finite there. All limits except the limit of the
//! jerk are convex in `x`. That limit is `|x j + ..| <= J / sqrt(x)`, with a convex right side. The
//! tangent of the right side at the present `x` lies below the right side. Therefore a motion that
//! stays below the tangent is within the limit (the convex-concave procedure).
//!
//! Newton's method with logarithmic barriers finds the minimum (S. Boyd and L. Vandenberghe, Convex
//! Optimization, chapter 11), with new tangents in every step. Each step leads from a motion within
//! the limits to a faster motion within them. The result is the fastest motion near the given
//! motion. There is no proof that no faster motion exists far from it.

use franka_otg::AxisLimits;
use nalgebra::{Matrix3, SMatrix, Vector3};

use super::banded::Banded;
use super::spline::Spline;

/// The first three derivatives of a motion at one place. Each column is a group of axes whose norm
/// is limited.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates<const W: usize, const G: usize> {
    pub(super) v: SMatrix<f64, W, G>,
    pub(super) a: SMatrix<f64, W, G>,
    pub(super) j: SMatrix<f64, W, G>,
}

/// A part of the motion between two nodes, given at its [`PLACES`].
pub(super) type Part<const W: usize, const G: usize> = [Rates<W, G>; PLACES.len()];

/// Places in a part at which the limits apply, as shares of the part.
pub(super) const PLACES: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];

/// Values at one place, where three coefficients of the spline contribute.
#[derive(Clone, Debug)]
struct Place<const W: usize> {
    /// Contribution of each coefficient to `x`.
    value: Vector3<f64>,
    /// Inverse of the greatest `x` that the velocity limit allows.
    velocity: f64,
    /// Contributions of the coefficients to the acceleration, and to the jerk without the factor
    /// `sqrt(x)`.
    accelerations: Vec<SMatrix<f64, W, 3>>,
    jerks: Vec<SMatrix<f64, W, 3>>,
}

/// The problem for one set of nodes.
struct Problem<const W: usize> {
    durations: Vec<f64>,
    places: Vec<[Place<W>; PLACES.len()]>,
    /// Contribution of each coefficient to `x` at the points with which the time is integrated.
    gauss: Vec<[Vector3<f64>; 2]>,
}

/// Places of the two points of Gauss's rule in a part.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Adds a row, unless an existing row is at least as strict in every case. Removes rows that the
/// new row makes superfluous.
fn keep<const W: usize>(rows: &mut Vec<SMatrix<f64, W, 3>>, row: SMatrix<f64, W, 3>) {
    let gram = row.tr_mul(&row);
    let size = gram.trace();
    if size < 1e-24 {
        return;
    }
    for other in rows.iter_mut() {
        let theirs = other.tr_mul(other);
        let share = size / theirs.trace();
        if (gram - theirs * share).norm() <= 1e-9 * size {
            if share > 1.0 {
                *other = row;
            }
            return;
        }
    }
    rows.push(row);
}

impl<const W: usize> Problem<W> {
    fn new<const G: usize>(
        parts: &[Part<W, G>],
        limits: &[AxisLimits; G],
        spline: &Spline,
    ) -> Self {
        let (mut places, mut gauss) = (Vec::new(), Vec::new());
        for (k, part) in parts.iter().enumerate() {
            gauss.push(GAUSS.map(|u| spline.basis(k, u)[0]));
            places.push(core::array::from_fn(|place| {
                let [b, db, ddb] = spline.basis(k, PLACES[place]);
                let Rates { v, a, j } = part[place];
                let (mut accelerations, mut jerks) = (Vec::new(), Vec::new());
                let mut velocity = 0.0_f64;
                for (g, limits) in limits.iter().enumerate() {
                    let (v, a, j) = (v.column(g), a.column(g), j.column(g));
                    velocity = velocity.max(v.norm_squared() / limits.velocity.powi(2));
                    // At its start, a part has the acceleration that the previous part has at its
                    // end.
                    if place > 0 {
                        let row = a * b.transpose() + v * (db * 0.5).transpose();
                        keep(&mut accelerations, row / limits.acceleration);
                    }
                    let row = j * b.transpose()
                        + a * (db * 1.5).transpose()
                        + v * (ddb * 0.5).transpose();
                    keep(&mut jerks, row / limits.jerk);
                }
                Place {
                    value: b,
                    velocity,
                    accelerations,
                    jerks,
                }
            }));
        }
        Self {
            durations: spline.durations.clone(),
            places,
            gauss,
        }
    }

    /// Returns the sum of the barriers' parameters. For a weight of 1, this is an upper bound: at
    /// the minimum of the barrier function, the duration exceeds the least duration by no more.
    fn parameter(&self) -> f64 {
        let places = self.places.iter().flatten();
        places
            .map(|place| 1 + 2 * (place.accelerations.len() + place.jerks.len()))
            .sum::<usize>() as f64
    }

    fn duration(&self, c: &[f64]) -> f64 {
        let parts = self.gauss.iter().zip(&self.durations).enumerate();
        parts
            .map(|(k, (gauss, h))| {
                let local = Spline::of_part(c, k);
                let roots = gauss.iter().map(|value| 1.0 / value.dot(&local).sqrt());
                0.5 * h * roots.sum::<f64>()
            })
            .sum()
    }

    /// Returns the greatest use of any limit, 1 at the limit. It is proportional to the squared
    /// rate.
    fn use_of_limits(&self, c: &[f64]) -> f64 {
        let mut most = 0.0_f64;
        for (k, places) in self.places.iter().enumerate() {
            let local = Spline::of_part(c, k);
            for place in places {
                let x = place.value.dot(&local);
                if x.is_nan() || x <= 0.0 {
                    return f64::INFINITY;
                }
                most = most.max(x * place.velocity);
                for row in &place.accelerations {
                    most = most.max((row * local).norm());
                }
                for row in &place.jerks {
                    most = most.max(((row * local).norm() * x.sqrt()).powf(2.0 / 3.0));
                }
            }
        }
        most
    }

    /// Finds the coefficients of the least duration, up to a relative error of `gap`, starting from
    /// `c`.
    fn minimise(&self, c: &mut Vec<f64>, gap: f64) {
        let used = self.use_of_limits(c);
        if used > BEGIN {
            c.iter_mut().for_each(|c| *c *= BEGIN / used);
        }
        let mut system = Banded::new(c.len());
        let parameter = self.parameter();
        let mut weight = parameter / (0.1 * self.duration(c));
        loop {
            for _ in 0..STEPS_MAX {
                let Some(before) = self.value(c, weight) else {
                    return;
                };
                self.derivatives(c, weight, &mut system);
                let (step, length) = system.step();
                if length.is_nan() || length < 0.3 {
                    break;
                }
                let mut share = 1.0;
                let taken = (0..20).find_map(|_| {
                    let next: Vec<f64> = c.iter().zip(&step).map(|(c, s)| c + share * s).collect();
                    let better = self
                        .value(&next, weight)
                        .is_some_and(|value| value <= before - 0.1 * share * length);
                    share *= 0.5;
                    better.then_some(next)
                });
                match taken {
                    Some(next) => *c = next,
                    None => break,
                }
            }
            if parameter / weight < gap * self.duration(c) {
                return;
            }
            weight *= GROWTH;
        }
    }

    /// Returns the barrier function, or `None` outside the limits.
    fn value(&self, c: &[f64], weight: f64) -> Option<f64> {
        let mut product = Logs::default();
        for (k, places) in self.places.iter().enumerate() {
            let local = Spline::of_part(c, k);
            for place in places {
                let x = place.value.dot(&local);
                if x.is_nan() || x <= 0.0 {
                    return None;
                }
                product.add(1.0 - x * place.velocity)?;
                for row in &place.accelerations {
                    product.add(1.0 - (row * local).norm_squared())?;
                }
                for row in &place.jerks {
                    product.add(1.0 / x - (row * local).norm_squared())?;
                }
            }
        }
        Some(weight * self.duration(c) - product.sum())
    }

    /// Computes the gradient and the Hessian of the barrier function, with the tangents at `c`.
    fn derivatives(&self, c: &[f64], weight: f64, system: &mut Banded) {
        system.clear();
        for (k, (places, gauss)) in self.places.iter().zip(&self.gauss).enumerate() {
            let local = Spline::of_part(c, k);
            let (mut slope, mut curve) = (Vector3::zeros(), Matrix3::zeros());
            for value in gauss {
                let x = value.dot(&local);
                let share = 0.5 * weight * self.durations[k] / (x * x.sqrt());
                slope -= value * (0.5 * share);
                curve += value * value.transpose() * (0.75 * share / x);
            }
            for place in places {
                let b = &place.value;
                let x = b.dot(&local);
                let by = place.velocity / (1.0 - x * place.velocity);
                slope += b * by;
                curve += b * b.transpose() * (by * by);
                for row in &place.accelerations {
                    let used = row * local;
                    let left = 1.0 / (1.0 - used.norm_squared());
                    let pull = row.tr_mul(&used) * (2.0 * left);
                    slope += pull;
                    curve += row.tr_mul(row) * (2.0 * left) + pull * pull.transpose();
                }
                // Tangent of 1 / sqrt(x).
                let most = 1.0 / x.sqrt();
                let falls = b * (-0.5 * most / x);
                for row in &place.jerks {
                    let used = row * local;
                    let left = 1.0 / (most * most - used.norm_squared());
                    let pull = (row.tr_mul(&used) - falls * most) * (2.0 * left);
                    slope += pull;
                    curve += (row.tr_mul(row) - falls * falls.transpose()) * (2.0 * left)
                        + pull * pull.transpose();
                }
            }
            system.add(k, &slope, &curve);
        }
    }
}

/// Sum of logarithms that multiplies many numbers before it computes a logarithm.
#[derive(Debug)]
struct Logs {
    sum: f64,
    product: f64,
}

impl Default for Logs {
    fn default() -> Self {
        Self {
            sum: 0.0,
            product: 1.0,
        }
    }
}

impl Logs {
    /// Adds the logarithm of `x`. Returns `None` unless `x` is positive.
    fn add(&mut self, x: f64) -> Option<()> {
        if x.is_nan() || x <= 0.0 {
            return None;
        }
        self.product *= x;
        if !(1e-100..1e100).contains(&self.product) {
            self.sum += self.product.ln();
            self.product = 1.0;
        }
        Some(())
    }

    fn sum(&self) -> f64 {
        self.sum + self.product.ln()
    }
}

/// Sets `spline` to the fastest rate for the `parts` of a motion within the `limits` of its groups,
/// up to a relative error of `gap` in the duration. Returns the parts in which the acceleration
/// changes too much for their length.
pub(super) fn minimise<const W: usize, const G: usize>(
    spline: &mut Spline,
    parts: &[Part<W, G>],
    limits: &[AxisLimits; G],
    gap: f64,
) -> Vec<bool> {
    let problem = Problem::new(parts, limits, spline);
    problem.minimise(&mut spline.c, gap);
    let is_long = |(k, part): (usize, &Part<W, G>)| {
        let change = 0.5 * (spline.at(k, 1.0)[1] - spline.at(k, 0.0)[1]);
        let mut groups = part[1].v.column_iter().zip(limits);
        groups.any(|(v, limits)| (v * change).norm() > SWITCH * limits.acceleration)
    };
    parts.iter().enumerate().map(is_long).collect()
}

/// Share of an acceleration limit by which the acceleration may change within one part.
const SWITCH: f64 = 0.3;

/// Factor by which the weight of the duration grows from one minimisation to the next.
const GROWTH: f64 = 10.0;

/// Maximum number of Newton steps for one weight.
const STEPS_MAX: usize = 12;

/// Share of the limits that the initial motion may use.
const BEGIN: f64 = 0.95;
