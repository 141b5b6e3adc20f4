//! A motion of a given duration to a target in motion, through a constant velocity.
//!
//! The motion is a transfer to a velocity `w`, a cruise, and a transfer to the end's velocity. The
//! first transfer has the direction `s`, and the second has the direction `u`. Both ends are
//! extended to zero acceleration: `c0 = v0 - s a0^2/2` and `cf = vf + u af^2/2`. The duration of
//! the cruise, and the distance of the end beyond the target, are
//!
//! ```text
//! cruise(w) = T + s a0 + u af - time(w - c0) - time(cf - w)
//! excess(w) = M(c0, w) + w cruise(w) + M(w, cf) - D
//! ```
//!
//! with `M` the displacement of a transfer. The extremal motions up and down are the two ends of
//! this family. As long as the cruise is not negative, the excess grows with `w`, so exactly one
//! `w` between the velocities of the extremal motions makes it zero. If the duration is close to
//! the duration of the velocity change, the cruise may be negative, and no plateau fits. The mean
//! of the two extremal motions is then used.
//!
//! The mean is valid for every duration and needs no search. However, it differs with each new
//! plan: if a plan is created in each cycle, the motion would swing from one end of the interval to
//! the other. A new plan from a plateau motion continues with the same velocity.

use crate::root::{Point, root};
use crate::shape::Shape;
use crate::task::Task;
use crate::transfer::{change_of_ramp, ramp_and_hold, transfer_distance, transfer_time};

/// The problem of one duration, with the velocity as the unknown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plateau {
    task: Task,
    vf: f64,
    af: f64,
    time: f64,
}

impl Plateau {
    pub(crate) fn new(task: &Task, vf: f64, af: f64, time: f64) -> Self {
        Self {
            task: *task,
            vf,
            af,
            time,
        }
    }

    /// Returns the direction and the shape of the motion, or `None` if its velocity is not between
    /// `low` and `high`.
    pub(crate) fn between(&self, low: f64, high: f64) -> Option<(f64, Shape)> {
        let point = |at| Point {
            at,
            value: self.at(at).excess,
        };
        let (low, high) = (point(low), point(high));
        if low.value > 0.0 || high.value < 0.0 {
            return None;
        }
        let w = root(low, high, 0.0, |w| self.at(w).excess);
        self.shape(w)
    }

    fn at(&self, w: f64) -> Transfers {
        let Task { d, v, a, .. } = self.task;
        let (vf, af) = (self.vf, self.af);
        // Velocities after the acceleration is ramped to zero, forwards and backwards in time.
        let s = 1_f64.copysign(w - (v + 0.5 * a * a.abs()));
        let u = 1_f64.copysign((vf - 0.5 * af * af.abs()) - w);
        let (c0, cf) = (v - s * 0.5 * a * a, vf + u * 0.5 * af * af);
        let first = (s * (w - c0)).max(change_of_ramp(s * a));
        let second = (u * (cf - w)).max(change_of_ramp(u * af));
        let cruise = self.time + s * a + u * af - transfer_time(first) - transfer_time(second);
        let before = a * (a * a / 3.0 - s * v);
        let after = d + af * (af * af / 3.0 + u * vf);
        let way = transfer_distance(c0, w) + w * cruise + transfer_distance(w, cf);
        Transfers {
            signs: (s, u),
            changes: (first, second),
            cruise,
            excess: way - (after - before),
        }
    }

    fn shape(&self, w: f64) -> Option<(f64, Shape)> {
        let Transfers {
            signs: (s, u),
            changes,
            cruise,
            ..
        } = self.at(w);
        if cruise < 0.0 {
            return None;
        }
        let ((x, first_hold), (y, second_hold)) =
            (ramp_and_hold(changes.0), ramp_and_hold(changes.1));
        let (t1, t7) = ((x - s * self.task.a).max(0.0), (y - u * self.af).max(0.0));
        // The shape is in the frame in which the second transfer is downwards.
        let sign = -u;
        let shape = Shape {
            first: sign * s,
            t: [t1, first_hold, x, cruise, y, second_hold, t7],
            cruise: sign * w,
        };
        Some((sign, shape))
    }
}

/// The motion through one velocity.
struct Transfers {
    /// Directions of the first and the second transfer.
    signs: (f64, f64),
    /// Velocity changes of the two transfers, with extended ends.
    changes: (f64, f64),
    cruise: f64,
    /// Distance of the motion's end beyond the target.
    excess: f64,
}
