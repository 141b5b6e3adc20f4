//! One axis and its target in units of its own limits.
//!
//! Fourth powers of quantities in SI units would differ by fifteen decades. With the acceleration
//! limit and the jerk limit as units, only the velocity limit remains as a parameter. Positions are
//! relative to the axis, so large offsets cost no precision.

use crate::limits::AxisLimits;
use crate::state::AxisState;
use crate::transfer::stop_distance;

/// A motion to rest, in units in which the acceleration limit and the jerk limit are one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task {
    pub(crate) d: f64,
    pub(crate) v: f64,
    pub(crate) a: f64,
    pub(crate) top: f64,
    /// Expected rounding error of `d`. It is zero for a state at rest, because from rest even the
    /// smallest distance counts.
    pub(crate) fuzz: f64,
}

impl Task {
    /// Returns the task in units of the limits, and the unit of time (acceleration limit divided by
    /// jerk limit).
    ///
    /// Returns `None` if the quantities differ by more than 100 decades, because their squares
    /// could overflow.
    pub(crate) fn new(state: AxisState, target: f64, limits: AxisLimits) -> Option<(Self, f64)> {
        let (task, unit) = Self::unchecked(state, target, limits);
        let fits = |value: f64| value.abs() < FAR; // false for NaN
        let scales = |value: f64| value < FAR && value > 1.0 / FAR;
        let representable = fits(task.d)
            && fits(task.v)
            && fits(task.a * task.a)
            && scales(task.top)
            && scales(unit)
            && scales(limits.acceleration * unit * unit);
        representable.then_some((task, unit))
    }

    /// Returns the same as [`Task::new`], for quantities that are known to be in range.
    pub(crate) fn unchecked(state: AxisState, target: f64, limits: AxisLimits) -> (Self, f64) {
        let unit = limits.acceleration / limits.jerk;
        let per_velocity = 1.0 / (limits.acceleration * unit);
        let per_distance = per_velocity / unit;
        let size = state.position.abs().max(target.abs());
        let fuzz = if state.is_at_rest() {
            0.0
        } else {
            ROUNDING * size * per_distance
        };
        let task = Self {
            d: (target - state.position) * per_distance,
            v: state.velocity * per_velocity,
            a: state.acceleration / limits.acceleration,
            top: limits.velocity * per_velocity,
            fuzz,
        };
        (task, unit)
    }

    /// Returns the same task with all directions reversed if `sign` is negative.
    pub(crate) fn mirrored(self, sign: f64) -> Self {
        Self {
            d: sign * self.d,
            v: sign * self.v,
            a: sign * self.a,
            ..self
        }
    }

    /// Returns the remaining task after the time `t` with constant `jerk`.
    pub(crate) fn after(self, jerk: f64, t: f64) -> Self {
        Self {
            d: self.d - t * (self.v + t * (0.5 * self.a + t * jerk / 6.0)),
            v: self.v + t * (self.a + 0.5 * t * jerk),
            a: self.a + t * jerk,
            ..self
        }
    }

    /// Returns the velocity after the acceleration is ramped directly to zero.
    pub(crate) fn coasting_velocity(&self) -> f64 {
        self.v + 0.5 * self.a * self.a.abs()
    }

    /// Returns the end of the least-time stop, relative to the current position, and the expected
    /// rounding error.
    pub(crate) fn stop_point(&self) -> (f64, f64) {
        let sign = 1_f64.copysign(self.coasting_velocity());
        let (v, a) = (sign * self.v, sign * self.a);
        let ramp = a * (v + a * a / 3.0);
        let stop = stop_distance((v + 0.5 * a * a).max(0.0));
        (sign * (ramp + stop), ROUNDING * (ramp.abs() + stop))
    }
}

/// Relative rounding of a position after about ten operations.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Relative difference of durations that counts as rounding.
pub(crate) const SAME: f64 = 1e-14;

/// Bound of distances and velocities in units of the limits, chosen so that no product of the
/// solution overflows.
const FAR: f64 = 1e100;
