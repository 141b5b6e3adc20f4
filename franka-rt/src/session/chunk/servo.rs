//! Follows a moving target. Stays within the limits, however the target moves.
//!
//! ```text
//! wanted velocity      = target's velocity + approach(distance)          within the velocity limit
//! wanted acceleration  = its derivative    + rate * (velocity missing)   within the acceleration limit
//! jerk                 = what makes the acceleration the wanted one      within the jerk limit, and able to stop
//! ```
//!
//! When the reference is at the target and the target moves within the limits, the reference
//! follows it exactly, because all of its motion is fed forward. Away from the target, the distance
//! decreases: with constant deceleration at first, and exponentially at the end.
//!
//! A generator that plans anew in each cycle, for the target of the next cycle, cannot do this. If
//! it is a micrometre away, it cannot reach the target in one millisecond. It passes the target's
//! place later, or all axes wait for the slowest axis and start again. A plan to a later point of
//! the chunk would arrive too early where the chunk is slow.
//!
//! **Limits.** A state is admissible if acceleration and velocity are within their limits, and stay
//! within them while the acceleration is removed as fast as the jerk allows, in whole cycles.
//! Removing the acceleration leads from one admissible state to another, so an admissible jerk
//! always exists. The desired jerk is moved toward that jerk only by the necessary part.
//!
//! All limits apply to norms, so this holds for any number of axes. While the acceleration is
//! removed along its line, the velocity moves on a straight line between two admissible velocities.

use franka_otg::AxisLimits;
use nalgebra::SVector;

use super::quintic::PointState;
use crate::shaping::CYCLE;

/// Greatest rate at which a missing velocity is compensated, `[1/s]`.
const RATE_MAX: f64 = 100.0;

/// Rate that is used, as a share of the rate at which the acceleration can change, which is the
/// ratio of jerk to acceleration limit.
const RATE_SHARE: f64 = 0.5;

/// Ratio between the decay times of the distance and of the missing velocity. With 3, nothing
/// oscillates.
const SLOWER: f64 = 3.0;

/// Share of the acceleration limit with which an approach from afar brakes. The rest is left for
/// the target's own acceleration.
const BRAKING_SHARE: f64 = 0.35;

/// Number of times that the interval is halved between the desired jerk and the jerk that removes
/// the acceleration.
const HALVINGS: usize = 12;

/// Advances by one cycle from `now` toward `target`, the target's state in that cycle. `bound` maps
/// a velocity to the nearest velocity that is allowed at this place.
pub(super) fn follow<const D: usize>(
    now: &PointState<D>,
    target: &PointState<D>,
    limits: &AxisLimits,
    bound: impl Fn(SVector<f64, D>) -> SVector<f64, D>,
) -> PointState<D> {
    let rate = (RATE_SHARE * limits.jerk / limits.acceleration).min(RATE_MAX);
    // Compares with the motion without jerk, so that a reference at the target stays there.
    let ahead = now.after(&SVector::zeros(), CYCLE);
    let distance = target.p - ahead.p;
    let (approach, growth) = approach(
        &distance,
        &(target.v - ahead.v),
        rate / SLOWER,
        BRAKING_SHARE * limits.acceleration,
    );
    let asked = target.v + approach;
    let wanted = bound(shortened(asked, limits.velocity));
    let fed_forward = if wanted == asked {
        target.a + growth
    } else {
        SVector::zeros() // not the target's motion, but a motion along the limit
    };
    let acceleration = shortened(fed_forward + (wanted - ahead.v) * rate, limits.acceleration);
    let jerk = shortened((acceleration - now.a) / CYCLE, limits.jerk);
    admissible(now, jerk, limits)
}

/// Returns the velocity with which the distance to the target is closed, and the derivative of that
/// velocity while the distance changes at `change`. The velocity is `rate` times the distance. Far
/// from the target, it is the velocity from which `braking` can stop.
fn approach<const D: usize>(
    distance: &SVector<f64, D>,
    change: &SVector<f64, D>,
    rate: f64,
    braking: f64,
) -> (SVector<f64, D>, SVector<f64, D>) {
    let length = distance.norm();
    let near = braking / (rate * rate);
    if length <= near {
        return (distance * rate, change * rate);
    }
    let direction = distance / length;
    let speed = (braking * (2.0 * length - near)).sqrt();
    let along = direction * direction.dot(change);
    (
        direction * speed,
        along * (braking / speed) + (change - along) * (speed / length),
    )
}

/// Returns the state after one cycle of `jerk`. If that state is not admissible, moves the jerk
/// toward the jerk that removes the acceleration until the state is admissible.
fn admissible<const D: usize>(
    now: &PointState<D>,
    jerk: SVector<f64, D>,
    limits: &AxisLimits,
) -> PointState<D> {
    // Outside the limits, the motion leads back toward them, never further out.
    let velocity = limits
        .velocity
        .max(now.v.norm())
        .max(coasting(now, limits.jerk).norm());
    let acceleration = limits.acceleration.max(now.a.norm());
    let keeps = |next: &PointState<D>| {
        next.a.norm() <= acceleration
            && next.v.norm() <= velocity
            && coasting(next, limits.jerk).norm() <= velocity
    };
    let wanted = now.after(&jerk, CYCLE);
    if keeps(&wanted) {
        return wanted;
    }
    let cycles = cycles(now, limits.jerk);
    let back = if cycles > 0.0 {
        -now.a / (cycles * CYCLE)
    } else {
        SVector::zeros()
    };
    let (mut kept, mut lost) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let part = 0.5 * (kept + lost);
        if keeps(&now.after(&(back + (jerk - back) * part), CYCLE)) {
            kept = part;
        } else {
            lost = part;
        }
    }
    now.after(&(back + (jerk - back) * kept), CYCLE)
}

/// Returns the velocity that remains once the acceleration has been removed.
fn coasting<const D: usize>(state: &PointState<D>, jerk: f64) -> SVector<f64, D> {
    state.v + state.a * (0.5 * CYCLE * cycles(state, jerk))
}

/// Returns the number of whole cycles in which the acceleration can be removed.
fn cycles<const D: usize>(state: &PointState<D>, jerk: f64) -> f64 {
    // A remainder from rounding does not count as another cycle.
    (state.a.norm() / (jerk * CYCLE) - 1e-9).ceil().max(0.0)
}

fn shortened<const D: usize>(vector: SVector<f64, D>, length: f64) -> SVector<f64, D> {
    let norm = vector.norm();
    if norm > length {
        vector * (length / norm)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{SVector, Vector3};

    /// Joint 1 and the translation of the default budget.
    const LIMITS: [AxisLimits; 2] = [
        AxisLimits {
            velocity: 0.524,
            acceleration: 2.0,
            jerk: 1000.0,
        },
        AxisLimits {
            velocity: 0.3,
            acceleration: 0.5,
            jerk: 20.0,
        },
    ];

    fn still<const D: usize>(p: SVector<f64, D>) -> PointState<D> {
        PointState {
            p,
            ..PointState::zero()
        }
    }

    #[test]
    fn a_step_is_walked_within_the_limits_and_hardly_overshot() {
        for limits in LIMITS {
            for step in [1e-4, 0.01, 0.1, 0.5] {
                let goal = still(SVector::from([step]));
                let (mut now, mut highest, mut cycles) = (still(SVector::from([0.0])), 0.0_f64, 0);
                while (now.p - goal.p).norm() > 1e-3 * step || now.v.norm() > 1e-3 {
                    now = follow(&now, &goal, &limits, |v| v);
                    highest = highest.max(now.p[0]);
                    cycles += 1;
                    assert!(cycles < 5000, "{limits:?} {step}: {now:?}");
                }
                assert!(highest <= 1.01 * step, "{limits:?} {step}: {highest}");
            }
        }
    }

    #[test]
    fn a_motion_within_the_limits_is_followed_exactly() {
        let (radius, pace) = (0.05, 2.0);
        let on_circle = |t: f64| {
            let (sin, cos) = (pace * t).sin_cos();
            PointState {
                p: SVector::from([radius * cos, radius * sin, 0.3]),
                v: SVector::from([-sin, cos, 0.0]) * (radius * pace),
                a: SVector::from([-cos, -sin, 0.0]) * (radius * pace * pace),
            }
        };
        let mut now = on_circle(0.0);
        for cycle in 1..5000 {
            let target = on_circle(f64::from(cycle) * CYCLE);
            now = follow(&now, &target, &LIMITS[1], |v| v);
            let off = (now.p - target.p).norm();
            assert!(off < 1e-7, "{off} in cycle {cycle}");
        }
    }

    #[test]
    fn state_outside_limits_returns_and_strays_no_further() {
        let limits = LIMITS[1];
        let mut now = PointState {
            p: Vector3::zeros(),
            v: SVector::from([0.4, 0.3, 0.0]),
            a: SVector::from([0.0, 0.6, 0.5]),
        };
        let (mut velocity, mut acceleration) = (
            now.v.norm().max(coasting(&now, limits.jerk).norm()),
            now.a.norm(),
        );
        for _ in 0..3000 {
            let before = now;
            now = follow(&now, &still(SVector::from([9.0, 0.0, 0.0])), &limits, |v| v);
            let jerk = (now.a - before.a).norm() / CYCLE;
            assert!(jerk <= limits.jerk * (1.0 + 1e-9), "{jerk}");
            assert!(now.v.norm() <= velocity * (1.0 + 1e-12));
            assert!(now.a.norm() <= acceleration.max(limits.acceleration) * (1.0 + 1e-12));
            velocity = now
                .v
                .norm()
                .max(limits.velocity)
                .max(coasting(&now, limits.jerk).norm());
            acceleration = now.a.norm();
        }
        assert!(now.v.norm() <= limits.velocity * (1.0 + 1e-12));
    }
}
