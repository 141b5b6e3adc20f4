//! The durations in which an axis can reach the velocity and the acceleration of a target, at any
//! position.
//!
//! The velocities that are reachable in one duration form an interval. At its ends, the
//! acceleration first rises and then falls, or first falls and then rises. The equations follow
//! from the areas under these accelerations. An axis cannot wait at the acceleration of the target
//! either, so a blocked interval may also exist here.

use crate::scalar::sqrt;
use crate::task::{ROUNDING, Task};

/// The change of velocity of a task.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VelocityChange {
    a0: f64,
    af: f64,
    /// Square of the peak acceleration that leads to the final velocity (with a hold: twice the
    /// area), for the highest and for the lowest acceleration.
    peak: f64,
    valley: f64,
    /// Magnitude that determines the rounding of the change.
    size: f64,
}

impl VelocityChange {
    pub(crate) fn new(task: &Task, vf: f64, af: f64) -> Self {
        let (v0, a0) = (task.v, task.a);
        let squares = 0.5 * (a0 * a0 + af * af);
        Self {
            a0,
            af,
            peak: squares + (vf - v0),
            valley: squares - (vf - v0),
            size: v0.abs() + vf.abs() + squares + typical_velocity(task),
        }
    }

    /// Returns the magnitude that determines the rounding of velocities.
    pub(crate) const fn size(&self) -> f64 {
        self.size
    }

    /// Returns true if duration `t` is feasible for the change.
    pub(crate) fn is_feasible(&self, t: f64) -> bool {
        self.is_feasible_within(t, TIGHT * self.size)
    }

    fn is_feasible_within(&self, t: f64, tolerance: f64) -> bool {
        let Self { a0, af, .. } = *self;
        let shortest = (af - a0).abs();
        let (highest, lowest) = (0.5 * (t + a0 + af), 0.5 * (t - a0 - af));
        t >= shortest * (1.0 - ROUNDING)
            && area(highest) >= self.peak - tolerance
            && area(lowest) >= self.valley - tolerance
    }

    /// Returns the durations at which feasible intervals begin or end, in no order. Each duration
    /// comes with its uncertainty from the rounding of velocities.
    pub(crate) fn crossings(&self) -> [Option<(f64, f64)>; 4] {
        let Self { a0, af, .. } = *self;
        let shortest = (af - a0).abs();
        let ways = [(self.peak, a0 + af), (self.valley, -a0 - af)];
        let mut times = [None; 4];
        let tolerance = 2.0 * DRIFT * self.size;
        for (i, (area, sum)) in ways.into_iter().enumerate() {
            if area < -tolerance {
                continue;
            }
            let extreme = if area > 1.0 {
                0.5 * (area + 1.0)
            } else {
                sqrt(area.max(0.0))
            };
            let rounding = tolerance / extreme.min(1.0).max(sqrt(tolerance));
            for (j, extreme) in [extreme, -extreme].into_iter().enumerate() {
                let t = 2.0 * extreme - sum;
                if t >= shortest - 2.0 * rounding
                    && self.is_feasible_within(t.max(shortest), tolerance)
                {
                    times[2 * i + j] = Some((t.max(shortest), rounding));
                }
            }
        }
        times
    }
}

/// Returns twice the area under an acceleration ramp to `x`. If `x` exceeds one, the ramp ends at
/// one, and the acceleration is held for the excess.
fn area(x: f64) -> f64 {
    let x = x.abs();
    if x <= 1.0 { x * x } else { 2.0 * x - 1.0 }
}

/// Returns the magnitude that may have determined the rounding of the task's velocity. An axis that
/// slows down was faster before, but an axis seldom reaches a much larger limit.
pub(crate) fn typical_velocity(task: &Task) -> f64 {
    task.top.min(1e3)
}

/// Relative rounding of a state after some thousand plans, each from the state of the previous
/// plan. Equal steps are rounded in the same way, so their errors add up. This value applies to
/// durations at which both extremal motions end at the target. The last part of a motion is always
/// in this situation, and must remain feasible.
pub(crate) const DRIFT: f64 = 1024.0 * ROUNDING;

/// Relative rounding of one plan, for all other durations. An error that is accepted here remains
/// in the state, so it must be a small part of [`DRIFT`].
pub(crate) const TIGHT: f64 = 16.0 * ROUNDING;
