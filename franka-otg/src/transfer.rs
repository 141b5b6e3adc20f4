//! Transfers from one velocity to another, the building blocks of every profile.
//!
//! All quantities are in units in which the acceleration limit and the jerk limit are one: times in
//! `A/J`, velocities in `A^2/J`, positions in `A^3/J^2`. A transfer that begins and ends without
//! acceleration is point-symmetric, so its displacement is its mean velocity times its duration.

use crate::scalar::sqrt;

/// Returns the duration of the transfer over a velocity difference `d >= 0`, from and to zero
/// acceleration.
pub(crate) fn transfer_time(d: f64) -> f64 {
    if d <= 1.0 { 2.0 * sqrt(d) } else { d + 1.0 }
}

/// Returns the displacement of the transfer from velocity `u` to velocity `w`, from and to zero
/// acceleration.
pub(crate) fn transfer_distance(u: f64, w: f64) -> f64 {
    0.5 * (u + w) * transfer_time((w - u).abs())
}

/// Returns the displacement of the stop from velocity `w >= 0`. This is also the area `|w - c| *
/// time / 2` of any transfer over `|w - c|`.
pub(crate) fn stop_distance(w: f64) -> f64 {
    stop_distance_and_slope(w).0
}

/// Returns [`stop_distance`] and its derivative, which is continuous across `w = 1`.
pub(crate) fn stop_distance_and_slope(w: f64) -> (f64, f64) {
    if w <= 1.0 {
        let root = sqrt(w);
        (w * root, 1.5 * root)
    } else {
        (0.5 * w * (w + 1.0), w + 0.5)
    }
}

/// Returns the ramp time and the hold time of the transfer over `d >= 0`: the acceleration rises,
/// stays at one, and falls.
pub(crate) fn ramp_and_hold(d: f64) -> (f64, f64) {
    if d <= 1.0 {
        (sqrt(d.max(0.0)), 0.0)
    } else {
        (1.0, d - 1.0)
    }
}

/// Returns the change of velocity of a transfer, from and to zero acceleration, whose acceleration
/// rises to `a` and immediately falls. The change is zero if `a` is not positive.
///
/// A transfer that begins or ends with the acceleration `a` changes the velocity by at least this
/// value.
pub(crate) fn change_of_ramp(a: f64) -> f64 {
    let a = a.max(0.0);
    a * a
}

/// Computes the least-time stop from velocity `v` and acceleration `a`, `|a| <= 1`.
///
/// Returns the sign of the first jerk, and the durations of this jerk, the hold and the opposite
/// jerk.
pub(crate) fn stop(v: f64, a: f64) -> (f64, [f64; 3]) {
    let remaining = v + 0.5 * a * a.abs();
    let sign = if remaining > 0.0 { -1.0 } else { 1.0 };
    let (b, d) = (sign * a, -sign * v);
    // Peak of the acceleration without a hold. The peak is at least |b|, because the missing
    // velocity has the same sign.
    let square = (d + 0.5 * b * b).max(0.0);
    if square <= 1.0 {
        let peak = sqrt(square);
        (sign, [(peak - b).max(0.0), 0.0, peak])
    } else {
        (sign, [(1.0 - b).max(0.0), square - 1.0, 1.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacement_and_slope_are_continuous_where_the_hold_begins() {
        let (below, above) = (1.0 - 1e-12, 1.0 + 1e-12);
        let (d0, s0) = stop_distance_and_slope(below);
        let (d1, s1) = stop_distance_and_slope(above);
        assert!((d0 - d1).abs() < 1e-11 && (s0 - s1).abs() < 1e-11);
        assert!((transfer_time(below) - transfer_time(above)).abs() < 1e-11);
    }

    #[test]
    fn a_stop_ends_without_velocity_and_acceleration() {
        for v in [-30.0, -1.0, -0.1, 0.0, 0.3, 2.0, 50.0] {
            for a in [-1.0, -0.7, 0.0, 1e-3, 0.9, 1.0] {
                let (sign, [t1, t2, t3]) = stop(v, a);
                let peak = a + sign * t1;
                let velocity = v + a * t1 + 0.5 * sign * t1 * t1 + peak * t2 + peak * t3
                    - 0.5 * sign * t3 * t3;
                assert!((peak - sign * t3).abs() < 1e-14, "{v} {a}");
                assert!(
                    velocity.abs() < 1e-13 * (1.0 + v.abs()),
                    "{v} {a}: {velocity}"
                );
                assert!(peak.abs() <= 1.0 + 1e-15);
            }
        }
    }
}
