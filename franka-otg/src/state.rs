//! Positions, velocities and accelerations of the axes.

use crate::error::{PlanError, Quantity};

/// Position, velocity and acceleration of one axis.
///
/// The caller chooses the unit of the position, for example radians or metres. Times are in
/// seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisState {
    /// Position of the axis.
    pub position: f64,
    /// Velocity, in units per second.
    pub velocity: f64,
    /// Acceleration, in units per second squared.
    pub acceleration: f64,
}

impl AxisState {
    /// Creates a state at `position` without motion.
    #[must_use]
    pub const fn at_rest(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    /// Returns the state after `t` seconds of constant `jerk`.
    pub(crate) fn after(self, jerk: f64, t: f64) -> Self {
        let Self {
            position: p,
            velocity: v,
            acceleration: a,
        } = self;
        Self {
            position: p + t * (v + t * (0.5 * a + t * jerk / 6.0)),
            velocity: v + t * (a + t * 0.5 * jerk),
            acceleration: a + t * jerk,
        }
    }

    /// Returns true if the axis is at rest: velocity and acceleration are exactly zero.
    pub(crate) fn is_at_rest(self) -> bool {
        self.velocity == 0.0 && self.acceleration == 0.0
    }
}

/// Position, velocity and acceleration of `N` axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<const N: usize> {
    /// Position of each axis.
    pub position: [f64; N],
    /// Velocity of each axis.
    pub velocity: [f64; N],
    /// Acceleration of each axis.
    pub acceleration: [f64; N],
}

impl<const N: usize> State<N> {
    /// Creates a state at `position` without motion.
    #[must_use]
    pub const fn at_rest(position: [f64; N]) -> Self {
        Self {
            position,
            velocity: [0.0; N],
            acceleration: [0.0; N],
        }
    }

    /// Returns the state of one axis; the first axis has the number 0.
    ///
    /// # Panics
    /// Panics if the axis does not exist.
    #[must_use]
    pub const fn axis(&self, axis: usize) -> AxisState {
        AxisState {
            position: self.position[axis],
            velocity: self.velocity[axis],
            acceleration: self.acceleration[axis],
        }
    }

    /// Returns true if all axes are at rest: all velocities and accelerations are exactly zero.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        (0..N).all(|i| self.axis(i).is_at_rest())
    }

    pub(crate) fn set_axis(&mut self, axis: usize, state: AxisState) {
        self.position[axis] = state.position;
        self.velocity[axis] = state.velocity;
        self.acceleration[axis] = state.acceleration;
    }

    /// Returns an error if a value is not finite.
    pub(crate) fn check(&self) -> Result<(), PlanError> {
        check_finite(&self.position, Quantity::Position)?;
        check_finite(&self.velocity, Quantity::Velocity)?;
        check_finite(&self.acceleration, Quantity::Acceleration)
    }
}

/// Returns an error for the first value that is not finite.
pub(crate) fn check_finite(values: &[f64], quantity: Quantity) -> Result<(), PlanError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(PlanError::NotFinite {
            quantity,
            axis: index + 1,
        }),
        None => Ok(()),
    }
}
