//! The legs of a path: their shares of the budget, and the rounding of their corners.

use franka_otg::AxisLimits;
use nalgebra::SVector;

use super::timing::{self, Corner, Knot, Leg};

/// Shares of the budget's velocity, acceleration and jerk with which a path is planned. The
/// follower uses the rest to return to the path.
const SHARES: [f64; 3] = [0.99, 0.95, 0.9];

/// Returns the share of these limits that a path may use.
pub(super) fn share(limits: AxisLimits) -> AxisLimits {
    AxisLimits {
        velocity: SHARES[0] * limits.velocity,
        acceleration: SHARES[1] * limits.acceleration,
        jerk: SHARES[2] * limits.jerk,
    }
}

/// Returns the limits of a leg on which each of the `ways` stays within its own limits.
pub(super) fn limits_of_leg(ways: impl Iterator<Item = (f64, AxisLimits)>) -> AxisLimits {
    let free = AxisLimits {
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };
    ways.filter(|(way, _)| *way > 0.0)
        .fold(free, |leg, (way, limits)| AxisLimits {
            velocity: leg.velocity.min(limits.velocity / way),
            acceleration: leg.acceleration.min(limits.acceleration / way),
            jerk: leg.jerk.min(limits.jerk / way),
        })
}

/// Returns the length of a corner's blend on each side, as shares of legs with these lengths.
fn shares(blend: f64, lengths: (f64, f64)) -> Option<(f64, f64)> {
    let share = |length: f64| (blend / length).min(0.5);
    (blend > 0.0).then(|| (share(lengths.0), share(lengths.1)))
}

/// Times the `legs` and the corners between them. `lengths` are the lengths of the legs in the unit
/// of the `blends`. There is one blend for each place. For `duration`, see [`Corner::new`].
pub(super) fn timed<const D: usize>(
    legs: &[Leg<D>],
    lengths: &[f64],
    blends: &[f64],
    duration: impl Fn(&SVector<f64, D>) -> f64,
) -> Vec<Knot> {
    if legs.is_empty() {
        return vec![Knot::START];
    }
    let corner = |i: usize| {
        let sizes = shares(blends[i + 1], (lengths[i], lengths[i + 1]))?;
        Some(Corner::new(sizes, (&legs[i], &legs[i + 1]), &duration))
    };
    let mut corners: Vec<_> = (0..legs.len() - 1).map(corner).collect();
    timing::time(legs, &mut corners)
}
