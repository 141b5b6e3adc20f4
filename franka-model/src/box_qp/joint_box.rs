//! Intervals for seven variables.

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
    pub(super) lower: JointVector,
    pub(super) upper: JointVector,
}

impl JointBox {
    /// The box between `lower` and `upper`; an infinite bound does not bind.
    ///
    /// Where they cross, as rounding can make them in an interval of no width, both become their
    /// midpoint: the variable is then fixed. A caller whose bounds can contradict each other by
    /// more than that has to decide beforehand which one to drop.
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

    /// The bound of variable `i` that the value `x` is beyond.
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
