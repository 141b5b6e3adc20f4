//! Step two where no cruise fits: a lowered acceleration limit.
//!
//! Needed where an axis is slowing down into a target just past its stop point and should lose a little time,
//! up to a fifth of the duration. Lower the acceleration limit to `cap`, ramping a larger acceleration down
//! to it first, and take the least-time profile under it. The velocity limit is safe: the ramp leaves the
//! coasting velocity unchanged. The duration is continuous in `cap`, and grows from the least at one to that
//! of the stop that ends at the target; a bracketed search finds it.
//!
//! A still smaller cap would last longer by overshooting the target and coming back, which at a joint limit
//! is worse than being early. So if even the gentlest stop is too short, the axis takes that and waits at the
//! target.

use super::given_duration::{Lasting, MAX_STEPS, SAME};
use super::least_time::{Least, least_time};
use super::task::Task;

/// The least-time profile under a lowered acceleration limit, or the gentlest stop.
pub(super) fn acceleration_cap(task: &Task, duration: f64) -> Lasting {
    let mut a = Probe::stop(task, gentlest_stop(task), duration);
    if a.excess <= 0.0 {
        return a.lasting();
    }
    let mut b = Probe::new(task, 1.0, duration);
    // Chandrupatla's method: inverse quadratic interpolation where the three points allow it, else bisection.
    // `a` and `b` bracket the root, `a` is the newest probe, `c` the one that it or `b` replaced.
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
        let cap = a.cap + part.clamp(resolution, 1.0 - resolution) * (b.cap - a.cap);
        let next = Probe::new(task, cap, duration);
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

/// The acceleration cap under which an immediate stop ends at the target, which lies past the stop point.
fn gentlest_stop(task: &Task) -> f64 {
    let Task { d, v, a, .. } = *task;
    // The stop with a hold at the cap: from the acceleration through zero, or adding to it, down to the cap.
    // Its end is ramp + w^2/(2 cap) + w cap/2, a quadratic equation for the cap.
    let w = v + 0.5 * a * a;
    let far = d - a * (v + a * a / 3.0);
    let cap = w * w / (far + (far * far - w * w * w).max(0.0).sqrt());
    if a >= -cap {
        return cap.min(1.0);
    }
    // Braking harder than that already: up to the cap, hold, up to zero. Its end is
    // coasting |a| + |a|^3/6 + coasting^2/(2 cap) - coasting cap/2.
    let coasting = v - 0.5 * a * a;
    let half = d + a * (coasting + a * a / 6.0);
    let root = (half * half + coasting * coasting * coasting)
        .max(0.0)
        .sqrt();
    let cap = if half > 0.0 {
        coasting * coasting / (half + root)
    } else {
        (root - half) / coasting
    };
    // Numbers small enough to underflow leave nothing to lower.
    if cap > 0.0 { cap.min(1.0) } else { 1.0 }
}

/// Where between `a` and `b` the root lies, as a fraction, by the parabola through three points if it is
/// monotone there.
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
        let (ramp, after) = ramped(task, cap);
        Self::solved(cap, ramp, after, duration)
    }

    /// The same where the target is the stop point but for rounding.
    fn stop(task: &Task, cap: f64, duration: f64) -> Self {
        let (ramp, after) = ramped(task, cap);
        let d = after.stop_point().0;
        Self::solved(cap, ramp, Task { d, ..after }, duration)
    }

    fn solved(cap: f64, ramp: (f64, f64), task: Task, duration: f64) -> Self {
        let least = least_time(task);
        Self {
            cap,
            ramp,
            least,
            excess: ramp.1 + cap * least.duration - duration,
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

/// The ramp down to `cap`, and what is left of the task after it, in units of `cap`.
fn ramped(task: &Task, cap: f64) -> ((f64, f64), Task) {
    let jerk = -1_f64.copysign(task.a);
    let time = (task.a.abs() - cap).max(0.0);
    let after = if time > 0.0 {
        task.after(jerk, time)
    } else {
        *task
    };
    ((jerk, time), after.capped(cap))
}
