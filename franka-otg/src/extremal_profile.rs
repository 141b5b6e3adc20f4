//! The extremal profile: the motion that gets farthest in a given time, and ends with a given
//! velocity and acceleration.
//!
//! In the frame in which "far" is upwards, the motion is a push, followed by a slow-down to the
//! final velocity, with jerks `+ 0 - 0 - 0 +`. The costate of the acceleration is a parabola in
//! time that opens upwards, so the jerk changes its sign at most twice. The acceleration or the
//! velocity is constant while it is at its limit. No other motion is optimal, and each duration has
//! exactly one such motion.
//!
//! Both ends are extended by their jerk to the instant with zero acceleration, as in `least_time`:
//!
//! ```text
//! c0 = v0 - a0^2/2 at pi0 = a0 (a0^2/3 - v0)     cf = vf - af^2/2 at pif = d + af (af^2/3 - vf)     D = pif - pi0
//! ```
//!
//! Let `x` be the acceleration before the first negative jerk and `-y` the acceleration before the
//! last positive jerk. Let `w` be the velocity between them at zero acceleration, `e = cf - c0`,
//! and `T` the duration counted from the extended ends. The integral of the acceleration requires
//! `w = c0 + x^2 = cf + y^2`, so without holds `x + y = T/2` and `x - y = 2 e/T`. If only the
//! larger of `x` and `y` reaches the limit, the smaller follows from `(1 + y)^2 = T - e` or `(1 +
//! x)^2 = T + e`. If both reach the limit, `w` follows from `2 w = T - 2 + c0 + cf`. If `w` is at
//! the velocity limit, the motion cruises for the remaining time. All cases have closed forms and
//! are continuous across their boundaries. Therefore no search is needed, and no root must be
//! rejected. A negative `x` or `y` means that the acceleration never changes its sign.
//!
//! As the duration grows, the end moves at the rate `w + x y/2` (or the velocity limit, in a
//! cruise). The rate may be negative: with more time, a motion that must end with a negative
//! velocity gets less far, until the time suffices to move upwards in between. The zeros of the
//! rate also have closed forms; see [`ExtremalProblem::turning_points`].

use crate::scalar::sqrt;
use crate::shape::Shape;
use crate::task::Task;
use crate::transfer::{change_of_ramp, ramp_and_hold, transfer_time};

/// Both ends of an extremal motion, extended to zero acceleration, in the frame in which the motion
/// goes upwards.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ExtremalProblem {
    a0: f64,
    af: f64,
    c0: f64,
    cf: f64,
    /// Distance between the extended ends if the motion ends at the target.
    d: f64,
    top: f64,
}

/// The extremal motion for one duration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ExtremalProfile {
    /// Distance of the motion's end beyond the target.
    pub(crate) beyond: f64,
    /// Velocity between the two halves. It is the largest velocity, if the acceleration of each
    /// half has the usual sign.
    pub(crate) w: f64,
    first: (f64, f64),
    cruise: f64,
    second: (f64, f64),
}

impl ExtremalProblem {
    /// Creates the problem for a task whose target moves with velocity `vf` and acceleration `af`.
    pub(crate) fn new(task: &Task, vf: f64, af: f64) -> Self {
        let (v0, a0) = (task.v, task.a);
        let before = a0 * (a0 * a0 / 3.0 - v0);
        let after = af * (af * af / 3.0 - vf);
        Self {
            a0,
            af,
            c0: v0 - 0.5 * a0 * a0,
            cf: vf - 0.5 * af * af,
            d: task.d + after - before,
            top: task.top,
        }
    }

    /// Returns the extremal motion of duration `t`. The final velocity must be reachable in this
    /// time.
    pub(crate) fn profile(&self, t: f64) -> ExtremalProfile {
        let Self { a0, af, c0, cf, .. } = *self;
        let whole = (t + a0 - af).max(0.0);
        let e = cf - c0;
        let q = 0.5 * whole;
        let difference = if q > 0.0 { e / q } else { 0.0 };
        // Because of rounding, `x` and `y` may be slightly below the accelerations at the ends.
        // Their sum is the time and must not change.
        let x = (0.5 * (q + difference)).max(a0).min(q + af);
        let y = q - x;
        let (x, first_hold, y, second_hold) = if x <= 1.0 && y <= 1.0 {
            (x, 0.0, y, 0.0)
        } else {
            // The holds take the time that remains after the ramps.
            let w = 0.5 * (whole - 2.0 + c0 + cf);
            let (first, second) = (w - c0 - 1.0, w - cf - 1.0);
            if first >= 0.0 && second >= 0.0 {
                (1.0, first, 1.0, second)
            } else if e > 0.0 {
                let y = (sqrt((whole - e).max(0.0)) - 1.0).max(-af).min(1.0);
                (1.0, (whole - 2.0 - 2.0 * y).max(0.0), y, 0.0)
            } else {
                let x = (sqrt((whole + e).max(0.0)) - 1.0).max(a0).min(1.0);
                (x, 0.0, 1.0, (whole - 2.0 - 2.0 * x).max(0.0))
            }
        };
        let w = if first_hold > 0.0 {
            c0 + 1.0 + first_hold
        } else {
            c0 + x * x
        };
        if w > self.top && x > 0.0 && y > 0.0 {
            return self.cruising(whole);
        }
        let distance = half(c0, x, first_hold) + half(cf, y, second_hold);
        ExtremalProfile {
            beyond: distance - self.d,
            w,
            first: (x, first_hold),
            cruise: 0.0,
            second: (y, second_hold),
        }
    }

    /// Returns the motion that reaches the velocity limit.
    fn cruising(&self, whole: f64) -> ExtremalProfile {
        let (c0, cf, w) = (self.c0, self.cf, self.top);
        // Rounding of the velocities must not make the ramps shorter than the ends require. The
        // cruise is the remaining time.
        let (x, first_hold) = ramp_and_hold((w - c0).max(change_of_ramp(self.a0)));
        let (y, second_hold) = ramp_and_hold((w - cf).max(change_of_ramp(-self.af)));
        let cruise = (whole - 2.0 * (x + y) - first_hold - second_hold).max(0.0);
        let distance = half(c0, x, first_hold) + half(cf, y, second_hold) + w * cruise;
        ExtremalProfile {
            beyond: distance - self.d,
            w,
            first: (x, first_hold),
            cruise,
            second: (y, second_hold),
        }
    }

    /// Returns the durations between which the end moves monotonically as the duration grows. They
    /// are not sorted, and some may be superfluous. The last entry is the duration at which a
    /// cruise becomes possible.
    ///
    /// Without holds the rate `w + x y/2` is zero where `3 s^2 + 4 (c0 + cf) s + e^2 = 0` with `s =
    /// (x + y)^2`. With one hold, the rate is zero where `y^2 + y/2 + cf = 0` or `x^2 + x/2 + c0 =
    /// 0`. With two holds, it is zero where `w = -1/2`. A root outside of its case only divides a
    /// monotone piece in two, which has no effect.
    pub(crate) fn turning_points(&self) -> [Option<f64>; 6] {
        let Self {
            a0,
            af,
            c0,
            cf,
            top,
            ..
        } = *self;
        let (e, sum) = (cf - c0, c0 + cf);
        let mut wholes = [None; 6];
        let square = 4.0 * sum * sum - 3.0 * e * e;
        if sum < 0.0 && square >= 0.0 {
            let s = (-2.0 * sum + sqrt(square)) / 3.0;
            wholes[0] = Some(2.0 * sqrt(s));
            wholes[1] = Some(2.0 * sqrt(e * e / (3.0 * s)));
        }
        // The half with the smaller change of velocity has no hold.
        let c = if e > 0.0 { cf } else { c0 };
        if c <= 1.0 / 16.0 {
            let root = sqrt(1.0 / 16.0 - c);
            wholes[2] = Some((0.75 + root) * (0.75 + root) + e.abs());
            wholes[3] = Some((0.75 - root) * (0.75 - root) + e.abs());
        }
        wholes[4] = Some(1.0 - sum);
        wholes[5] = Some(transfer_time((top - c0).max(0.0)) + transfer_time((top - cf).max(0.0)));
        wholes.map(|whole| whole.map(|whole| whole - a0 + af))
    }

    /// Returns the duration at which the motion reaches the target if its cruise is extended. With
    /// duration `t`, the motion ends `short` of the target.
    pub(crate) fn cruise_on(&self, t: f64, short: f64) -> f64 {
        t + short / self.top
    }
}

impl ExtremalProfile {
    /// Returns the rate at which the end moves as the duration grows.
    pub(crate) fn rate(&self) -> f64 {
        if self.cruise > 0.0 {
            self.w
        } else {
            self.w + 0.5 * self.first.0 * self.second.0
        }
    }

    /// Returns the shape of the motion from acceleration `a0` to `af`.
    pub(crate) fn shape(&self, ends: &ExtremalProblem) -> Shape {
        let ((x, first_hold), (y, second_hold)) = (self.first, self.second);
        // If an acceleration never changes its sign, there is one negative jerk, from x to -y.
        let (t3, t5) = if x < 0.0 {
            (0.0, (x + y).max(0.0))
        } else if y < 0.0 {
            ((x + y).max(0.0), 0.0)
        } else {
            (x, y)
        };
        let (t1, t7) = ((x - ends.a0).max(0.0), (y + ends.af).max(0.0));
        Shape {
            first: 1.0,
            t: [t1, first_hold, t3, self.cruise, t5, second_hold, t7],
            cruise: self.w,
        }
    }
}

/// Returns the displacement of the transfer between velocity `c` and the velocity that follows from
/// the peak acceleration `x` and its hold. The acceleration is zero at both ends. For a negative
/// `x`, the result is the excess of the other half.
fn half(c: f64, x: f64, hold: f64) -> f64 {
    let change = x * x + x * hold;
    (c + 0.5 * change) * (2.0 * x + hold)
}
