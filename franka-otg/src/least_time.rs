//! Step one: the least-time profile of one axis.
//!
//! The axis may wait at rest, so the positions at which it can rest at time `T` form an interval
//! that grows with `T`. The fastest motion is therefore "push in one direction, then stop". The
//! push points from the end of an immediate stop to the target. A target inside the braking
//! distance needs no special case.
//!
//! In the frame in which the push is upwards, the jerks are `+ 0 - 0 - 0 +` (seven durations). The
//! first jerk, extended to the instant with zero acceleration, moves the start `(v, a)` to `(c, 0)`
//! with
//!
//! ```text
//! c = v - a^2/2      at      pi = a (a^2/3 - v)
//! ```
//!
//! Let `x` be the acceleration before the first negative jerk and `w = c + x^2 (+ hold)` the
//! velocity between the two halves. The motion ends at `pi + (c + w)/2 * time(w - c) + stop(w)`,
//! which grows with `w`. A comparison of the target with this value at the breakpoints determines
//! the case. The cases with a cruise or an acceleration hold have closed forms. In the remaining
//! case, Newton steps solve the monotone and convex equation
//!
//! ```text
//! F(x) = pi + 2 c x + x^3 + stop(c + x^2) = d
//! ```
//!
//! from the right, so they cannot leave the interval. `x` is negative if the axis already brakes
//! and only needs to brake less. A search over peak velocities misses this profile, and its result
//! takes up to 28 % longer.

use crate::scalar::{cbrt, sqrt};
use crate::shape::Shape;
use crate::task::Task;
use crate::transfer::{ramp_and_hold, stop_distance, transfer_distance};

/// The least-time solution of a task inside its limits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeastTime {
    /// Direction of the push, 1 or -1. The other fields are in the frame in which the push is
    /// upwards.
    pub(crate) sign: f64,
    /// Task in this frame.
    pub(crate) task: Task,
    /// Solution in this frame.
    pub(crate) shape: Shape,
    /// Sum of the durations.
    pub(crate) duration: f64,
}

/// Solves a task that is inside its limits.
pub(crate) fn least_time(task: Task) -> LeastTime {
    let (stop, rounding) = task.stop_point();
    let fuzz = task.fuzz + if task.fuzz > 0.0 { rounding } else { 0.0 };
    let (sign, mut task, is_stop) = if (task.d - stop).abs() <= fuzz {
        // Removing the last rounding error would take its square root in time.
        let sign = 1_f64.copysign(task.coasting_velocity());
        let stopping = Task { d: stop, ..task };
        (sign, stopping.mirrored(sign), true)
    } else {
        let sign = if task.d >= stop { 1.0 } else { -1.0 };
        (sign, task.mirrored(sign), false)
    };
    task.top = task.top.max(0.0);
    let start = ExtendedStart::of(&task);
    let shape = if is_stop {
        start.turning_at(start.least_ramp())
    } else {
        start.solve(task.d)
    };
    LeastTime {
        sign,
        task,
        shape,
        duration: shape.duration(),
    }
}

/// Start of a motion, extended by its first jerk to zero acceleration.
struct ExtendedStart {
    a: f64,
    /// Velocity at the extended start.
    c: f64,
    /// Position of the extended start.
    pi: f64,
    top: f64,
}

impl ExtendedStart {
    fn of(task: &Task) -> Self {
        let a = task.a;
        Self {
            a,
            c: task.v - 0.5 * a * a,
            pi: a * (a * a / 3.0 - task.v),
            top: task.top,
        }
    }

    /// Returns the shape for the distance `d`, which is at or above the stop point.
    fn solve(&self, d: f64) -> Shape {
        let Self { a, c, pi, top } = *self;
        let to_top = (top - c).max(0.0);
        let at_top = pi + transfer_distance(c, top) + stop_distance(top);
        if d >= at_top {
            let (up, down) = (ramp_and_hold(to_top), ramp_and_hold(top));
            let time = (d - at_top) / top;
            return Shape::two_transfers(a, up, (top, time), down);
        }
        if to_top > 1.0 {
            let w = c + 1.0;
            if w < 0.0 || d >= pi + 2.0 * c + 1.0 + stop_distance(w) {
                return self.with_hold(d);
            }
        }
        self.turning_at(self.solve_ramp(d, sqrt(to_top.min(1.0))))
    }

    /// Returns the shape whose first transfer holds its acceleration. The distance contains the
    /// areas of both transfers. It is a perfect square in `sqrt(w)` if the second transfer does not
    /// reach the acceleration limit. Otherwise it is quadratic in `w`.
    fn with_hold(&self, d: f64) -> Shape {
        let Self { a, c, pi, .. } = *self;
        let q = (d - pi - 0.5 * c * (1.0 - c)).max(0.0);
        let s = sqrt(2.0 * q);
        let m = 2.0 * s / (1.0 + sqrt(1.0 + 4.0 * s));
        let (w, down) = if m <= 1.0 {
            (m * m, (m, 0.0))
        } else {
            let w = 2.0 * q / (1.0 + sqrt(1.0 + 4.0 * q));
            (w, (1.0, (w - 1.0).max(0.0)))
        };
        let up = (1.0, (w - c - 1.0).max(0.0));
        Shape::two_transfers(a, up, (w, 0.0), down)
    }

    /// Returns the profile whose acceleration turns at `x`, without a cruise and without a first
    /// hold.
    fn turning_at(&self, x: f64) -> Shape {
        let w = (self.c + x * x).max(0.0);
        Shape::two_transfers(self.a, (x, 0.0), (w, 0.0), ramp_and_hold(w))
    }

    /// Returns the smallest acceleration at which the motion may turn (for an immediate stop).
    fn least_ramp(&self) -> f64 {
        if self.c < 0.0 {
            self.a.max(sqrt(-self.c))
        } else {
            self.a
        }
    }

    /// Returns `F(x)` and its derivative.
    fn end(&self, x: f64) -> (f64, f64) {
        let w = (self.c + x * x).max(0.0);
        let before = self.pi + x * (2.0 * self.c + x * x);
        if w <= 1.0 {
            let m = sqrt(w);
            (before + w * m, (x + m) * (x + 2.0 * m))
        } else {
            (before + 0.5 * w * (w + 1.0), (x + 1.0) * (x + 2.0 * w))
        }
    }

    /// Solves `F(x) = d` between the least ramp and `most`, where `F(most) >= d`.
    fn solve_ramp(&self, d: f64, most: f64) -> f64 {
        if self.c == 0.0 && self.a == 0.0 && d <= 2.0 {
            return cbrt(0.5 * d.max(0.0)); // from rest: F(x) = 2 x^3
        }
        let least = self.least_ramp();
        let (low, slope) = self.end(least);
        let gap = d - low;
        if gap <= 0.0 || most <= least {
            return least;
        }
        // Two upper bounds of the root: the tangent at the left end, because F is convex, and a
        // bound from F' >= 6 x^2 if c >= 0, or F' >= x^2 otherwise.
        let mut x = most;
        if gap < slope * (most - least) {
            x = least + gap / slope;
        }
        let cubic = if self.c >= 0.0 {
            let from_zero = d - self.end(0.0).0;
            if least < 0.0 && from_zero <= 0.0 {
                0.0
            } else {
                cbrt(0.5 * (from_zero.max(0.0)))
            }
        } else {
            cbrt(least * least * least + 3.0 * gap)
        };
        x = x.min(cubic).max(least);
        for _ in 0..MAX_NEWTON {
            let (value, slope) = self.end(x);
            let step = (value - d) / slope;
            // Steps from the right reduce x, until rounding reverses a step.
            if step > 2.0 * f64::EPSILON * x.abs() {
                x = (x - step).max(least);
            } else {
                break;
            }
        }
        x
    }
}

/// Largest number of Newton steps of a convex search. Three to five steps are usual. Near a double
/// root, each step only halves the error.
const MAX_NEWTON: usize = 60;
