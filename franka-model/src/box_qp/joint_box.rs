//! Intervals for seven variables.

use crate::JointVector;

/// Bound on which the search holds a variable, if any.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// No bound: the variable is inside its interval.
    #[default]
    Free,
    /// The lower bound.
    Lower,
    /// The upper bound.
    Upper,
}

/// Intervals for seven variables. An interval is never empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointBox {
    pub(super) lower: JointVector,
    pub(super) upper: JointVector,
}

impl JointBox {
    /// Creates the box between `lower` and `upper`. An infinite bound is never active.
    ///
    /// If a lower bound exceeds its upper bound, both become their midpoint, and the variable is
    /// fixed. If bounds can contradict each other by more than rounding, the caller must first
    /// decide which bound to drop.
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

    /// Creates the box with the interval `[-bound, bound]` for each variable.
    pub fn symmetric(bound: &JointVector) -> Self {
        Self::new(&-bound, bound)
    }

    /// Returns the lower bounds.
    pub fn lower(&self) -> &JointVector {
        &self.lower
    }

    /// Returns the upper bounds.
    pub fn upper(&self) -> &JointVector {
        &self.upper
    }

    /// Returns the point of the box nearest to `x`.
    pub fn clamp(&self, x: &JointVector) -> JointVector {
        JointVector::from_fn(|i, _| x[i].max(self.lower[i]).min(self.upper[i]))
    }

    /// Returns the bound of variable `i` that the value `x` exceeds.
    pub(super) fn side_beyond(&self, i: usize, x: f64) -> Side {
        if x < self.lower[i] {
            Side::Lower
        } else if x > self.upper[i] {
            Side::Upper
        } else {
            Side::Free
        }
    }
}
