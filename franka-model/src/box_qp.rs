//! Strictly convex quadratic programs in seven variables, each within an interval.
//!
//! ```text
//! minimise  1/2 xᵀ H x − bᵀ x   subject to  lower <= x <= upper
//! ```
//!
//! by a primal active-set method (Nocedal and Wright, Numerical Optimization, 2006, section 16.5):
//!
//! 1. hold the active variables on their bounds, minimise over the others;
//! 2. go there, or as far as the first bound in the way, which becomes active;
//! 3. at the minimum, free the active variable whose gradient points inside most; none: done.
//!
//! Every iterate is inside the box and no worse than the one before. With intervals for
//! constraints the multipliers are entries of the gradient.

use nalgebra::{Cholesky, SMatrix};

use crate::JointVector;

/// Which bound holds a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// None: the variable is inside its interval.
    #[default]
    Free,
    /// The lower one.
    Lower,
    /// The upper one.
    Upper,
}

/// Intervals for seven variables, never empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointBox {
    lower: JointVector,
    upper: JointVector,
}

impl JointBox {
    /// The box between `lower` and `upper`; infinite bounds are no bounds.
    ///
    /// Where they cross, which rounding does to an interval of no width, both become their
    /// midpoint: the variable is then fixed. Whoever may demand the impossible by more than that
    /// must decide before which demand to drop.
    pub fn new(lower: &JointVector, upper: &JointVector) -> Self {
        let mut bounds = Self {
            lower: *lower,
            upper: *upper,
        };
        for i in 0..7 {
            if lower[i] > upper[i] {
                let middle = 0.5 * lower[i] + 0.5 * upper[i];
                bounds.lower[i] = middle;
                bounds.upper[i] = middle;
            }
        }
        bounds
    }

    /// The same interval `[-bound, bound]` for each variable.
    pub fn symmetric(bound: &JointVector) -> Self {
        Self::new(&-bound, bound)
    }

    /// Lower bounds.
    pub fn lower(&self) -> &JointVector {
        &self.lower
    }

    /// Upper bounds.
    pub fn upper(&self) -> &JointVector {
        &self.upper
    }

    /// The point of the box nearest to `x`.
    pub fn clamp(&self, x: &JointVector) -> JointVector {
        JointVector::from_fn(|i, _| x[i].max(self.lower[i]).min(self.upper[i]))
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// At the minimum.
    Optimal,
    /// After [`PASSES_MAX`] passes: inside the box and no worse than the start, but perhaps not at
    /// the minimum.
    PassLimit,
    /// On numbers that are not finite, or a matrix that is not positive definite: inside the box,
    /// no more.
    Degenerate,
}

/// Passes after which a search gives up.
///
/// Each costs one factorisation. Random problems of all kinds take at most half as many.
pub const PASSES_MAX: usize = 40;

/// Where a search ended.
pub(crate) struct Minimum {
    pub(crate) x: JointVector,
    pub(crate) active: [Side; 7],
    pub(crate) outcome: Outcome,
    pub(crate) passes: usize,
}

/// Where a search begins, and how long it may take.
pub(crate) struct Start<'a> {
    /// The first point is the one of the box nearest to this,
    pub(crate) near: &'a JointVector,
    /// with these variables on their bounds.
    pub(crate) active: [Side; 7],
    pub(crate) passes_max: usize,
}

/// Searches for the minimum.
pub(crate) fn minimise(
    hessian: &SMatrix<f64, 7, 7>,
    linear: &JointVector,
    bounds: &JointBox,
    start: &Start<'_>,
) -> Minimum {
    let mut at = Minimum {
        x: bounds.clamp(start.near),
        active: start.active,
        outcome: Outcome::PassLimit,
        passes: 0,
    };
    for (i, side) in start.active.into_iter().enumerate() {
        at.hold(bounds, i, side);
    }
    while at.passes < start.passes_max {
        at.passes += 1;
        let Some(goal) = at.minimum_of_free(hessian, linear) else {
            at.outcome = Outcome::Degenerate;
            break;
        };
        if at.approach(bounds, &goal) {
            continue;
        }
        match at.most_willing_inside(hessian, linear, bounds) {
            Some(i) => at.active[i] = Side::Free,
            None => {
                at.outcome = Outcome::Optimal;
                break;
            }
        }
    }
    at
}

impl Minimum {
    /// Makes bound `side` of variable `i` active, unless there is no bound on that side.
    fn hold(&mut self, bounds: &JointBox, i: usize, side: Side) {
        let value = match side {
            Side::Free => return,
            Side::Lower => bounds.lower[i],
            Side::Upper => bounds.upper[i],
        };
        if value.is_finite() {
            self.x[i] = value;
            self.active[i] = side;
        } else {
            self.active[i] = Side::Free;
        }
    }

    /// The minimum with the active variables where they are.
    fn minimum_of_free(
        &self,
        hessian: &SMatrix<f64, 7, 7>,
        linear: &JointVector,
    ) -> Option<JointVector> {
        let mut matrix = *hessian;
        let mut right = *linear;
        for i in 0..7 {
            if self.active[i] == Side::Free {
                continue;
            }
            for k in 0..7 {
                right[k] -= hessian[(k, i)] * self.x[i];
                matrix[(k, i)] = 0.0;
                matrix[(i, k)] = 0.0;
            }
            matrix[(i, i)] = 1.0;
        }
        for i in 0..7 {
            if self.active[i] != Side::Free {
                right[i] = self.x[i];
            }
        }
        let goal = Cholesky::new(matrix)?.solve(&right);
        goal.iter().all(|x| x.is_finite()).then_some(goal)
    }

    /// Goes towards `goal`; true if a bound came in the way.
    fn approach(&mut self, bounds: &JointBox, goal: &JointVector) -> bool {
        let mut first = None;
        let mut share = 1.0;
        for i in 0..7 {
            let (side, bound) = if goal[i] < bounds.lower[i] {
                (Side::Lower, bounds.lower[i])
            } else if goal[i] > bounds.upper[i] {
                (Side::Upper, bounds.upper[i])
            } else {
                continue;
            };
            if self.active[i] != Side::Free {
                continue; // the goal of a held variable is its bound, up to rounding
            }
            let until = (bound - self.x[i]) / (goal[i] - self.x[i]);
            if first.is_none() || until < share {
                share = until;
                first = Some((i, side));
            }
        }
        let Some((blocking, side)) = first else {
            self.move_free(goal, bounds, 1.0);
            return false;
        };
        self.move_free(goal, bounds, share);
        self.hold(bounds, blocking, side);
        true
    }

    fn move_free(&mut self, goal: &JointVector, bounds: &JointBox, share: f64) {
        for i in 0..7 {
            if self.active[i] == Side::Free {
                let x = self.x[i] + share * (goal[i] - self.x[i]);
                self.x[i] = x.max(bounds.lower[i]).min(bounds.upper[i]);
            }
        }
    }

    /// The active variable along which the function falls most steeply into the box.
    fn most_willing_inside(
        &self,
        hessian: &SMatrix<f64, 7, 7>,
        linear: &JointVector,
        bounds: &JointBox,
    ) -> Option<usize> {
        let mut steepest = None;
        let mut slope = 0.0;
        for i in 0..7 {
            let sign = match self.active[i] {
                Side::Free => continue,
                Side::Lower => -1.0,
                Side::Upper => 1.0,
            };
            if bounds.lower[i] == bounds.upper[i] {
                continue;
            }
            let mut gradient = -linear[i];
            let mut scale = linear[i].abs();
            for k in 0..7 {
                let term = hessian[(i, k)] * self.x[k];
                gradient += term;
                scale += term.abs();
            }
            let fall = sign * gradient;
            if fall > slope && fall > ROUNDING * scale {
                slope = fall;
                steepest = Some(i);
            }
        }
        steepest
    }
}

/// Relative to its terms, a gradient below this is rounding.
const ROUNDING: f64 = 1e-14;

#[cfg(test)]
mod tests;
