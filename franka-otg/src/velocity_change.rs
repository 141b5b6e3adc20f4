//! When the velocity and the acceleration of a target can be met, wherever the axis is then.
//!
//! The position's problem one derivative lower. The velocities that can be reached in one duration
//! are an interval; its ends are "acceleration up, then down" and the reverse, and the areas under
//! them give the equations. A target that accelerates cannot be waited for with its acceleration
//! either, so there may be a blocked interval here, too.

use crate::scalar::sqrt;
use crate::task::{ROUNDING, Task};

/// The change of velocity that a task asks for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VelocityChange {
    a0: f64,
    af: f64,
    /// Square of the acceleration in between, or what takes its place with a hold, that leads to
    /// the end's velocity: the highest and the lowest.
    peak: f64,
    valley: f64,
    /// What the change is rounded relative to.
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

    /// What the velocities are rounded relative to.
    pub(crate) const fn size(&self) -> f64 {
        self.size
    }

    /// Whether the change can take `t`.
    pub(crate) fn is_possible(&self, t: f64) -> bool {
        self.is_possible_within(t, TIGHT * self.size)
    }

    fn is_possible_within(&self, t: f64, tolerance: f64) -> bool {
        let Self { a0, af, .. } = *self;
        let shortest = (af - a0).abs();
        let (highest, lowest) = (0.5 * (t + a0 + af), 0.5 * (t - a0 - af));
        t >= shortest * (1.0 - ROUNDING)
            && area(highest) >= self.peak - tolerance
            && area(lowest) >= self.valley - tolerance
    }

    /// Where possible durations begin or end, in no order, and what the rounding of velocities
    /// makes of them.
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
                    && self.is_possible_within(t.max(shortest), tolerance)
                {
                    times[2 * i + j] = Some((t.max(shortest), rounding));
                }
            }
        }
        times
    }
}

/// Area under an acceleration ramp to `x`, held at one for what `x` is more than that: in units of
/// twice the area.
fn area(x: f64) -> f64 {
    let x = x.abs();
    if x <= 1.0 { x * x } else { 2.0 * x - 1.0 }
}

/// Velocity that the rounding of the task's velocity may come from: an axis that slows down was
/// faster before. A limit that is much larger is seldom reached.
pub(crate) fn typical_velocity(task: &Task) -> f64 {
    task.top.min(1e3)
}

/// Relative rounding of a state that some thousand plans led to, each from the state that the one
/// before gave. Equal steps are rounded alike, so what they are rounded by adds up. For the
/// durations at which both farthest motions end at the target: a motion is there from some point
/// on, and has to stay.
pub(crate) const DRIFT: f64 = 1024.0 * ROUNDING;

/// Relative rounding of one plan, for all other durations. What is let pass here remains in the
/// state, so it has to be little of what is let pass there.
pub(crate) const TIGHT: f64 = 16.0 * ROUNDING;
