//! The least duration to rest by plain bisection: push for a while, then stop. Shares no code with
//! the generator.

use franka_otg::AxisLimits;

/// Position, velocity and acceleration.
pub(crate) type AxisMotion = [f64; 3];

/// Returns the least duration from a state that can stay inside the limits to rest `distance` away,
/// and true if the motion passes the target first.
pub(crate) fn least_duration(start: AxisMotion, distance: f64, limits: AxisLimits) -> f64 {
    let side = if distance >= stop_point(start, limits) {
        1.0
    } else {
        -1.0
    };
    let end = |theta: f64| end_of_push(start, theta, side * limits.velocity, limits);
    let reaches = |theta: f64| side * (end(theta).0 - distance) >= 0.0;
    let mut high = limits.acceleration / limits.jerk;
    while !reaches(high) {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if reaches(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    end(high).1
}

/// Returns the end of the least-time stop, relative to position zero.
pub(crate) fn stop_point(start: AxisMotion, limits: AxisLimits) -> f64 {
    end_of_push(start, 0.0, limits.velocity, limits).0
}

/// Returns the position and time of rest of an axis that pushes towards `velocity` for `theta` and
/// then stops.
fn end_of_push(start: AxisMotion, theta: f64, velocity: f64, limits: AxisLimits) -> (f64, f64) {
    let (mut state, mut left, mut duration) = (start, theta, theta);
    if theta > 0.0 {
        for (jerk, t) in transfer(start, velocity, limits) {
            let t = t.min(left);
            state = after(state, jerk, t);
            left -= t;
        }
        if left > 0.0 {
            // The transfer is complete. A remaining rounding error would grow over a long cruise.
            state = after([state[0], velocity, 0.0], 0.0, left);
        }
    }
    for (jerk, t) in transfer(state, 0.0, limits) {
        state = after(state, jerk, t);
        duration += t;
    }
    (state[0], duration)
}

/// Returns the least-time transfer to a velocity without acceleration.
fn transfer([_, v, a]: AxisMotion, to: f64, limits: AxisLimits) -> [(f64, f64); 3] {
    let (jerk, most) = (limits.jerk, limits.acceleration);
    let sign = 1_f64.copysign(to - (v + 0.5 * a * a.abs() / jerk));
    let (b, d) = (sign * a, sign * (to - v));
    let square = (jerk * d + 0.5 * b * b).max(0.0);
    let peak = square.sqrt().min(most);
    let hold = ((square - most * most) / (jerk * most)).max(0.0);
    [
        (sign * jerk, ((peak - b) / jerk).max(0.0)),
        (0.0, hold),
        (-sign * jerk, peak / jerk),
    ]
}

fn after([p, v, a]: AxisMotion, jerk: f64, t: f64) -> AxisMotion {
    [
        p + t * (v + t * (0.5 * a + t * jerk / 6.0)),
        v + t * (a + 0.5 * t * jerk),
        a + t * jerk,
    ]
}
