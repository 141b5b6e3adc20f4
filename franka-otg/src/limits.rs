//! Limits of the axes.

use crate::error::{PlanError, Quantity};

/// Symmetric limits of one axis. Each of velocity, acceleration and jerk stays between minus and
/// plus its limit.
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
}

/// Limits of `N` axes. All limits are positive and finite: the constructors check this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<const N: usize>([AxisLimits; N]);

impl<const N: usize> Limits<N> {
    /// Creates limits from one [`AxisLimits`] per axis.
    ///
    /// # Errors
    /// Returns [`PlanError::Limit`] if a limit is not a positive finite number.
    pub fn per_axis(limits: [AxisLimits; N]) -> Result<Self, PlanError> {
        for (axis, limit) in (1..).zip(&limits) {
            limit.check(axis)?;
        }
        Ok(Self(limits))
    }

    /// Creates limits from one array per quantity, as data sheets list them: velocities,
    /// accelerations and jerks.
    ///
    /// # Errors
    /// Returns [`PlanError::Limit`] if a limit is not a positive finite number.
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

    /// Returns the limits of one axis; the first axis has the number 0.
    ///
    /// # Panics
    /// Panics if the axis does not exist.
    #[must_use]
    pub const fn axis(&self, axis: usize) -> AxisLimits {
        self.0[axis]
    }

    /// Returns limits for the parameter `s` of a straight line `origin + s * direction`. They keep
    /// every axis within its own limits.
    ///
    /// A zero component does not limit `s`, so its bound is infinite.
    pub(crate) fn along(&self, direction: &[f64; N]) -> AxisLimits {
        let mut along = AxisLimits {
            velocity: f64::INFINITY,
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
        };
        for (limits, component) in self.0.iter().zip(direction) {
            let part = component.abs();
            if part > 0.0 {
                along.velocity = along.velocity.min(limits.velocity / part);
                along.acceleration = along.acceleration.min(limits.acceleration / part);
                along.jerk = along.jerk.min(limits.jerk / part);
            }
        }
        along
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_limited_by_the_axis_that_reaches_its_limit_first() {
        let limits = Limits::from_arrays([1.0, 0.2], [5.0, 8.0], [1000.0; 2]).unwrap();
        let along = limits.along(&[1.0, -0.5]);
        assert_eq!(
            along,
            AxisLimits {
                velocity: 0.4,
                acceleration: 5.0,
                jerk: 1000.0
            }
        );
        assert_eq!(limits.along(&[0.0, 1.0]), limits.axis(1));
    }

    #[test]
    fn limits_that_are_not_positive_and_finite_are_refused() {
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = Limits::from_arrays([1.0, 1.0], [1.0, value], [1.0, 1.0]);
            let Err(PlanError::Limit { quantity, axis, .. }) = refused else {
                panic!("{value} was accepted");
            };
            assert_eq!((quantity, axis), (Quantity::Acceleration, 2));
        }
    }
}
