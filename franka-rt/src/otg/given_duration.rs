//! Step two: a profile of exactly a given duration, not less than the least.
//!
//! For targets at rest two families with one parameter each suffice.
//!
//! **Velocity cap.** Transfer to a velocity `w`, cruise, stop. Eliminating the cruise from the equations of time and distance
//! leaves one equation, which needs no division by `w`. Upwards (`w` at or above the velocity that remains when the
//! acceleration is ramped out), with `c, pi` the start extended to zero acceleration as in step one and `A(d)` the area of
//! [`stop_distance`](super::transfer::stop_distance):
//!
//! ```text
//! g(w) = A(w - c) + A(w) - (T + a) w + d - pi = 0
//! ```
//!
//! and downwards `A(w) - A(c - w) - (T - a) w + d - pi`, with `c, pi` of a negative first jerk. `g` is convex or monotone
//! where the cruise is not negative. If both transfers hold their acceleration it is a quadratic or linear equation. The
//! cruise follows from the time equation, so the duration is exact and rounding goes into the position, where it is smallest.
//!
//! **Acceleration cap.** Needed where an axis is braking already into a target just past its stop point and should lose a
//! little time. Lower the acceleration limit to `cap`, ramping a larger acceleration down to it first, and take the
//! least-time profile under it. Its duration is continuous in `cap`, least at one, and unbounded towards zero, so there is a
//! solution for every duration; a bracketed search finds it. The velocity limit is safe: the ramp leaves the coasting
//! velocity unchanged.
//!
//! Slowing time down instead (one factor for the whole profile) would change the velocity at the start, and lowering all
//! three limits at once makes the duration discontinuous where a start no longer fits inside them.

use super::least_time::{Least, Shape, least_time};
use super::task::Task;
use super::transfer::{ramp_and_hold, stop_distance_and_slope, transfer_time};

/// A profile that lasts as long as asked for, in the frame of the least-time solution that it comes from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lasting {
    /// Jerk and duration of a ramp before the shape.
    pub(super) ramp: (f64, f64),
    /// Acceleration limit of the shape: 1 unless capped. Its times are in units of it.
    pub(super) cap: f64,
    /// Direction of the shape.
    pub(super) sign: f64,
    /// The shape, in units of `cap`.
    pub(super) shape: Shape,
}

/// Stretches a least-time solution to `duration`, in units of the axis; to its own if that is longer.
pub(super) fn lasting(least: &Least, duration: f64) -> Lasting {
    let unstretched = Lasting {
        ramp: (0.0, 0.0),
        cap: 1.0,
        sign: 1.0,
        shape: least.shape,
    };
    if duration - least.duration <= SAME * duration {
        return unstretched;
    }
    match velocity_cap(&least.task, least.peak, duration) {
        Some(shape) => Lasting {
            shape,
            ..unstretched
        },
        None => acceleration_cap(&least.task, duration),
    }
}

/// Transfer, cruise and stop; `None` if no cruise fits.
fn velocity_cap(task: &Task, peak: f64, duration: f64) -> Option<Shape> {
    let coasting = task.coasting_velocity();
    let low = coasting.max(0.0);
    let up = Cap::new(task, duration, 1.0);
    if up.excess(low).0 >= 0.0 {
        let w = up.solve(low, peak.max(low));
        return up.shape(task.a, w);
    }
    let down = Cap::new(task, duration, -1.0);
    let w = down.solve(0.0, low);
    down.shape(task.a, w)
}

/// The equation of the velocity cap for one sign of the first jerk.
struct Cap {
    sign: f64,
    /// Start velocity, extended to zero acceleration.
    c: f64,
    /// Distance from the start extended so.
    d: f64,
    /// Duration from there.
    time: f64,
}

impl Cap {
    fn new(task: &Task, duration: f64, sign: f64) -> Self {
        let Task { d, v, a, .. } = *task;
        Self {
            sign,
            c: v - sign * 0.5 * a * a,
            d: d - a * (a * a / 3.0 - sign * v),
            time: duration + sign * a,
        }
    }

    /// Distance still missing after `time` with cruise velocity `w`, and its derivative.
    fn excess(&self, w: f64) -> (f64, f64) {
        let (first, first_slope) = stop_distance_and_slope((self.sign * (w - self.c)).max(0.0));
        let (second, second_slope) = stop_distance_and_slope(w);
        (
            self.sign * first + second - self.time * w + self.d,
            first_slope + second_slope - self.time,
        )
    }

    /// The root of the excess between `low`, where it is not negative, and `high`, where it is not positive.
    fn solve(&self, low: f64, high: f64) -> f64 {
        let (mut low, mut high) = (low, high);
        let guess = self.with_holds();
        if guess >= low && guess <= high && guess >= 1.0 && self.sign * (guess - self.c) >= 1.0 {
            return guess;
        }
        let mut w = if guess >= low && guess <= high {
            guess
        } else {
            0.5 * (low + high)
        };
        for _ in 0..MAX_STEPS {
            let (excess, slope) = self.excess(w);
            if excess > 0.0 {
                low = w;
            } else {
                high = w;
            }
            let newton = w - excess / slope;
            let next = if newton > low && newton < high {
                newton
            } else if excess == 0.0 {
                return w;
            } else {
                0.5 * (low + high)
            };
            if (next - w).abs() <= 2.0 * f64::EPSILON * w {
                return next;
            }
            w = next;
        }
        w
    }

    /// The root if both transfers hold their acceleration: a quadratic upwards, a linear equation downwards.
    fn with_holds(&self) -> f64 {
        let c = self.c;
        if self.sign > 0.0 {
            let half = 0.5 * (self.time + c - 1.0);
            let q = 0.5 * c * (c - 1.0) + self.d;
            q / (half + (half * half - q).max(0.0).sqrt())
        } else {
            (self.d - 0.5 * c * (c + 1.0)) / (self.time - c - 1.0)
        }
    }

    /// The profile with cruise velocity `w`, if its cruise is not negative.
    fn shape(&self, a: f64, w: f64) -> Option<Shape> {
        let first = (self.sign * (w - self.c)).max(0.0);
        let cruise = self.time - transfer_time(first) - transfer_time(w);
        if cruise < 0.0 {
            return None;
        }
        let shape = Shape::two_transfers(
            self.sign * a,
            ramp_and_hold(first),
            cruise,
            ramp_and_hold(w),
        );
        Some(Shape {
            first: self.sign,
            ..shape
        })
    }
}

/// The least-time profile under a lowered acceleration limit.
fn acceleration_cap(task: &Task, duration: f64) -> Lasting {
    let probe = |cap: f64| Probe::new(task, cap, duration);
    // At a cap of one the profile is too short. Find a cap at which it is not.
    let mut a = probe(0.5);
    let mut b = probe(1.0);
    for _ in 0..MAX_STEPS {
        if a.excess >= 0.0 {
            break;
        }
        (b, a) = (a, probe(0.5 * a.cap));
    }
    // Chandrupatla's method: inverse quadratic interpolation where the three points allow it, else bisection. `a` and `b`
    // bracket the root, `a` is the newest probe, `c` the one that it or `b` replaced.
    let mut part = 0.5_f64;
    for _ in 0..MAX_STEPS {
        let best = if a.excess.abs() < b.excess.abs() {
            a
        } else {
            b
        };
        let width = (b.cap - a.cap).abs();
        let resolution = 2.0 * f64::EPSILON * best.cap / width;
        if best.excess.abs() <= SAME * duration || resolution >= 0.5 {
            return best.lasting();
        }
        let next = probe(a.cap + part.clamp(resolution, 1.0 - resolution) * (b.cap - a.cap));
        let c = if (next.excess > 0.0) == (a.excess > 0.0) {
            a
        } else {
            core::mem::replace(&mut b, a)
        };
        a = next;
        part = interpolate(&a, &b, &c);
    }
    a.lasting()
}

/// Where between `a` and `b` the root lies, as a fraction, by the parabola through three points if it is monotone there.
fn interpolate(a: &Probe, b: &Probe, c: &Probe) -> f64 {
    let (fa, fb, fc) = (a.excess, b.excess, c.excess);
    let xi = (a.cap - b.cap) / (c.cap - b.cap);
    let phi = (fa - fb) / (fc - fb);
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        fa / (fb - fa) * fc / (fb - fc)
            + (c.cap - a.cap) / (b.cap - a.cap) * fa / (fc - fa) * fb / (fc - fb)
    } else {
        0.5
    }
}

/// The least-time profile under one acceleration cap.
#[derive(Clone, Copy)]
struct Probe {
    cap: f64,
    ramp: (f64, f64),
    least: Least,
    /// By how much it is too long.
    excess: f64,
}

impl Probe {
    fn new(task: &Task, cap: f64, duration: f64) -> Self {
        let jerk = -1_f64.copysign(task.a);
        let time = (task.a.abs() - cap).max(0.0);
        let after = if time > 0.0 {
            task.after(jerk, time)
        } else {
            *task
        };
        let least = least_time(after.capped(cap));
        Self {
            cap,
            ramp: (jerk, time),
            least,
            excess: time + cap * least.duration - duration,
        }
    }

    fn lasting(&self) -> Lasting {
        Lasting {
            ramp: self.ramp,
            cap: self.cap,
            sign: self.least.sign,
            shape: self.least.shape,
        }
    }
}

/// Relative difference of durations that is rounding.
const SAME: f64 = 1e-14;

/// Bound of each search.
const MAX_STEPS: usize = 60;
