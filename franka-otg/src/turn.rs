//! Leaving a straight line that is faster than its axes on their own.
//!
//! Where a budget binds a norm, a line may use all of it, and each axis on its own only a share.
//! The moment a new target lies off the line the axes must go their own ways, and the one along the
//! line may be outside its share. Letting it brake while the others already accelerate would exceed
//! the budget: with the jerk of its share it cannot take its acceleration back in time. So the
//! motion first stays on the line, with the line's own jerk, until all axes are inside their
//! shares.

use crate::limits::AxisLimits;
use crate::profile::Profile;
use crate::scalar::sqrt;
use crate::state::AxisState;

/// Lays out the shortest piece of the line after which every axis is inside its share and can stay
/// there.
///
/// `full` and `shares` limit the parameter of the line, and `start` is inside `full`.
pub(crate) fn lay_out_lead(
    start: AxisState,
    full: AxisLimits,
    shares: AxisLimits,
    lead: &mut Profile,
) {
    lead.begin(start);
    let top = shares.velocity;
    // Taking this much acceleration back changes the velocity by no more than its limit.
    let most = shares.acceleration.min(sqrt(2.0 * top * shares.jerk));
    let excess = start.acceleration.abs() - most;
    if excess > 0.0 {
        let jerk = -full.jerk.copysign(start.acceleration);
        lead.push(jerk, excess / full.jerk);
    }
    let AxisState {
        velocity,
        acceleration,
        ..
    } = lead.front();
    let coasting = velocity + 0.5 * acceleration * acceleration.abs() / shares.jerk;
    let sign = if velocity > top || coasting > top {
        1.0
    } else if velocity < -top || coasting < -top {
        -1.0
    } else {
        return;
    };
    let (v, a) = (sign * velocity, sign * acceleration);
    let jerk = full.jerk;
    // Under this jerk the velocity at zero acceleration, reached or extended to, stays the same.
    let level = v + 0.5 * a * a / jerk;
    let (turned, hold) = if a > 0.0 && level <= top && shares.jerk < jerk {
        let square = 2.0 * (top - level) * jerk * shares.jerk / (jerk - shares.jerk);
        (sqrt(square).min(a), 0.0)
    } else {
        let needed = sqrt(2.0 * jerk * (level - top).max(0.0));
        if needed <= most {
            (-needed, 0.0)
        } else {
            let reached = level - 0.5 * most * most / jerk;
            (-most, (reached - top) / most)
        }
    };
    lead.push(-sign * jerk, (a - turned) / jerk);
    lead.push(0.0, hold);
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: AxisLimits = AxisLimits {
        velocity: 1.0,
        acceleration: 8.0,
        jerk: 400.0,
    };

    #[test]
    fn after_the_lead_the_shares_hold_and_can_be_kept() {
        let shares = FULL.per_axis_for_norm(3);
        for v in [-1.0, -0.6, -0.2, 0.0, 0.3, 0.57, 0.58, 0.9, 1.0] {
            for a in [-8.0, -5.0, -1.0, 0.0, 0.5, 4.0, 8.0] {
                let start = AxisState {
                    position: 0.0,
                    velocity: v,
                    acceleration: a,
                };
                let mut lead = Profile::at_rest(0.0);
                lay_out_lead(start, FULL, shares, &mut lead);
                let AxisState {
                    velocity,
                    acceleration,
                    ..
                } = lead.front();
                let coasting = velocity + 0.5 * acceleration * acceleration.abs() / shares.jerk;
                let bound = 1.0 + 1e-12;
                assert!(
                    velocity.abs() <= bound * shares.velocity,
                    "{v} {a}: {velocity}"
                );
                assert!(acceleration.abs() <= bound * shares.acceleration, "{v} {a}");
                assert!(
                    coasting.abs() <= bound * shares.velocity,
                    "{v} {a}: {coasting}"
                );
            }
        }
    }
}
