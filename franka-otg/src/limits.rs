//! Limits of the axes, each on its own or as norms over groups of axes.
//!
//! Some limits bind a norm: the speed of a hand, not each of its three components. Independent axes
//! keep such a budget if each gets an equal share of it, the budget divided by the square root of
//! the group's size: then no combination of the axes exceeds it. But shares waste up to
//! `1 - 1/sqrt(3)`, 42 %, of the speed along a base axis. A straight line needs no shares: its
//! direction is known, so the whole budget holds along it. [`Limits`] therefore keeps the budgets,
//! uses the whole of them on straight lines, and the shares where axes move on their own.

use crate::error::{PlanError, Quantity};
use crate::scalar::sqrt;

/// Limits of one axis, symmetric: velocity, acceleration and jerk stay within plus or minus these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisLimits {
    /// Largest velocity, in units per second.
    pub velocity: f64,
    /// Largest acceleration, in units per second squared.
    pub acceleration: f64,
    /// Largest jerk, in units per second cubed.
    pub jerk: f64,
}

impl AxisLimits {
    /// Equal shares for `axes` axes of a budget that binds their Euclidean norm: divided by
    /// `sqrt(axes)`.
    ///
    /// As long as each axis keeps its share, the norms of velocity, acceleration and jerk keep the
    /// budget.
    #[must_use]
    pub fn per_axis_for_norm(self, axes: usize) -> Self {
        self.scaled(1.0 / sqrt(axes.max(1) as f64))
    }

    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            velocity: self.velocity * factor,
            acceleration: self.acceleration * factor,
            jerk: self.jerk * factor,
        }
    }

    /// The tighter of two limits, quantity by quantity.
    fn min(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.min(other.velocity),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }

    fn check(self, axis: usize) -> Result<(), PlanError> {
        for (quantity, value) in [
            (Quantity::Velocity, self.velocity),
            (Quantity::Acceleration, self.acceleration),
            (Quantity::Jerk, self.jerk),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(PlanError::Limit {
                    quantity,
                    axis,
                    value,
                });
            }
        }
        Ok(())
    }

    const UNBOUNDED: Self = Self {
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };
}

/// Checked limits of `N` axes: positive and finite.
///
/// Consecutive axes form groups. A group of one axis is limited by itself; in a larger group the
/// budget binds the Euclidean norm over its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<const N: usize> {
    /// What each axis may do on its own: its share of the group's budget.
    shares: [AxisLimits; N],
    /// Budget of the group that the axis belongs to.
    budgets: [AxisLimits; N],
    /// First axis of the group that the axis belongs to.
    first: [usize; N],
}

impl<const N: usize> Limits<N> {
    /// Each axis with limits of its own.
    ///
    /// # Errors
    /// [`PlanError::Limit`] for a limit that is not a positive finite number.
    pub fn per_axis(limits: [AxisLimits; N]) -> Result<Self, PlanError> {
        for (axis, limit) in limits.iter().enumerate() {
            limit.check(axis)?;
        }
        Ok(Self {
            shares: limits,
            budgets: limits,
            first: core::array::from_fn(|axis| axis),
        })
    }

    /// Each axis with limits of its own, quantity by quantity, as data sheets list them.
    ///
    /// # Errors
    /// [`PlanError::Limit`] for a limit that is not a positive finite number.
    pub fn from_arrays(
        velocity: [f64; N],
        acceleration: [f64; N],
        jerk: [f64; N],
    ) -> Result<Self, PlanError> {
        Self::per_axis(core::array::from_fn(|axis| AxisLimits {
            velocity: velocity[axis],
            acceleration: acceleration[axis],
            jerk: jerk[axis],
        }))
    }

    /// Groups of consecutive axes, as pairs of size and budget; a budget binds the Euclidean norm
    /// over its group.
    ///
    /// A Cartesian generator has two groups of three: translation and rotation.
    ///
    /// # Errors
    /// [`PlanError::Limit`] for a budget that is not a positive finite number, with the first axis
    /// of its group; [`PlanError::Groups`] if the sizes do not sum to `N`.
    pub fn norms(groups: &[(usize, AxisLimits)]) -> Result<Self, PlanError> {
        let got = groups
            .iter()
            .fold(0_usize, |sum, (size, _)| sum.saturating_add(*size));
        if got != N {
            return Err(PlanError::Groups { got, axes: N });
        }
        let mut limits = Self {
            shares: [AxisLimits::UNBOUNDED; N],
            budgets: [AxisLimits::UNBOUNDED; N],
            first: [0; N],
        };
        let mut start = 0;
        for &(size, budget) in groups {
            budget.check(start)?;
            for axis in start..start + size {
                limits.shares[axis] = budget.per_axis_for_norm(size);
                limits.budgets[axis] = budget;
                limits.first[axis] = start;
            }
            start += size;
        }
        Ok(limits)
    }

    /// What one axis may do on its own: its limit, or its share of its group's budget.
    ///
    /// # Panics
    /// If there is no such axis.
    #[must_use]
    pub const fn axis(&self, axis: usize) -> AxisLimits {
        self.shares[axis]
    }

    /// Limits of the parameter `s` of a straight line `origin + s * direction` that uses the whole
    /// budgets.
    ///
    /// A zero direction is not limited: infinite.
    pub(crate) fn along(&self, direction: &[f64; N]) -> AxisLimits {
        let mut limits = AxisLimits::UNBOUNDED;
        let mut square = 0.0;
        for (axis, component) in direction.iter().enumerate() {
            square += component * component;
            let ends = axis + 1 == N || self.first[axis + 1] == axis + 1;
            if ends {
                if square > 0.0 {
                    // A group of one needs no root: it would only round.
                    let norm = if self.first[axis] == axis {
                        component.abs()
                    } else {
                        sqrt(square)
                    };
                    limits = limits.min(divided(self.budgets[axis], norm));
                }
                square = 0.0;
            }
        }
        limits
    }

    /// Limits of the same parameter that keep every axis inside its share.
    pub(crate) fn shares_along(&self, direction: &[f64; N]) -> AxisLimits {
        (0..N)
            .filter(|&axis| direction[axis] != 0.0)
            .map(|axis| divided(self.shares[axis], direction[axis].abs()))
            .fold(AxisLimits::UNBOUNDED, AxisLimits::min)
    }

    /// Whether a straight line may be faster than its axes on their own.
    pub(crate) fn has_norms(&self) -> bool {
        (0..N).any(|axis| self.first[axis] != axis)
    }
}

fn divided(limits: AxisLimits, by: f64) -> AxisLimits {
    AxisLimits {
        velocity: limits.velocity / by,
        acceleration: limits.acceleration / by,
        jerk: limits.jerk / by,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: AxisLimits = AxisLimits {
        velocity: 1.0,
        acceleration: 8.0,
        jerk: 4000.0,
    };

    #[test]
    fn shares_fill_the_norm_exactly_when_all_axes_use_them() {
        let share = BUDGET.per_axis_for_norm(3);
        let norm = (3.0 * share.velocity * share.velocity).sqrt();
        assert!((norm - BUDGET.velocity).abs() < 1e-15);
    }

    #[test]
    fn a_line_along_one_axis_of_a_group_gets_the_whole_budget() {
        let rotation = AxisLimits {
            velocity: 2.0,
            ..BUDGET
        };
        let limits = Limits::<6>::norms(&[(3, BUDGET), (3, rotation)]).unwrap();
        let line = limits.along(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(line.velocity, 1.0);
        let line = limits.along(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(line.velocity, 2.0);
        let both = limits.along(&[0.1, 0.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(both.velocity, 2.0);
        let shares = limits.shares_along(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!((shares.velocity - 1.0 / 3_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn groups_must_cover_the_axes() {
        let refused = Limits::<6>::norms(&[(3, BUDGET), (2, BUDGET)]);
        assert_eq!(refused, Err(PlanError::Groups { got: 5, axes: 6 }));
        let refused = Limits::<6>::norms(&[(usize::MAX, BUDGET), (7, BUDGET)]);
        assert!(matches!(refused, Err(PlanError::Groups { .. })));
    }

    #[test]
    fn limits_that_are_not_positive_and_finite_are_refused() {
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = Limits::from_arrays([1.0, 1.0], [1.0, value], [1.0, 1.0]);
            let Err(PlanError::Limit { quantity, axis, .. }) = refused else {
                panic!("{value} was accepted");
            };
            assert_eq!((quantity, axis), (Quantity::Acceleration, 1));
        }
    }
}
