//! A slow, simple version of step one: the axis pushes for a while and then stops. Bisection finds
//! the duration of the push.

use crate::{AxisLimits, AxisState};

/// Returns the least duration from a state that can stay inside the limits.
pub(super) fn least_duration(start: AxisState, target: f64, limits: AxisLimits) -> f64 {
    // Starts from zero, so that an offset does not round the distance.
    let target = target - start.position;
    let start = AxisState {
        position: 0.0,
        ..start
    };
    let ahead = |theta: f64, side: f64| end_of_push(start, theta, side * limits.velocity, limits);
    let side = if target >= ahead(0.0, 1.0).0 {
        1.0
    } else {
        -1.0
    };
    let reaches = |theta: f64| side * (ahead(theta, side).0 - target) >= 0.0;
    let mut high = limits.acceleration / limits.jerk;
    while !reaches(high) {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if reaches(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    ahead(high, side).1
}

/// Returns the position and the time of rest of an axis that pushes towards `velocity` for `theta`
/// and then stops.
fn end_of_push(start: AxisState, theta: f64, velocity: f64, limits: AxisLimits) -> (f64, f64) {
    let mut state = start;
    let mut left = theta;
    let push = transfer(start, velocity, limits);
    for (jerk, t) in push {
        let t = t.min(left);
        state = state.after(jerk, t);
        left -= t;
    }
    if left > 0.0 {
        // The transfer is complete. A rounding error that remains would grow over a long cruise.
        state.velocity = velocity;
        state.acceleration = 0.0;
        state = state.after(0.0, left);
    }
    let mut duration = theta;
    for (jerk, t) in transfer(state, 0.0, limits) {
        state = state.after(jerk, t);
        duration += t;
    }
    (state.position, duration)
}

/// Returns the least-time transfer to a velocity without acceleration, in the caller's units.
fn transfer(state: AxisState, to: f64, limits: AxisLimits) -> [(f64, f64); 3] {
    let (jerk, most) = (limits.jerk, limits.acceleration);
    let AxisState {
        velocity: v,
        acceleration: a,
        ..
    } = state;
    let coasting = v + 0.5 * a * a.abs() / jerk;
    let sign = 1_f64.copysign(to - coasting);
    let (b, d) = (sign * a, sign * (to - v));
    let peak = (jerk * d + 0.5 * b * b).max(0.0).sqrt();
    let (peak, hold) = if peak <= most {
        (peak, 0.0)
    } else {
        (
            most,
            (d - (2.0 * most * most - b * b) / (2.0 * jerk)) / most,
        )
    };
    [
        (sign * jerk, ((peak - b) / jerk).max(0.0)),
        (0.0, hold),
        (-sign * jerk, peak / jerk),
    ]
}
