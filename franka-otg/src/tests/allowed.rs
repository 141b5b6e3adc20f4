//! States and targets that are possible within limits, for the tests of this crate and for
//! `otg_soak`.

use super::{AxisLimits, AxisState, Limits, State};

/// Returns a state inside `limits` that can stay inside. `coasting` and `bend` are fractions of the
/// allowed values.
pub(crate) fn inside(limits: AxisLimits, position: f64, coasting: f64, bend: f64) -> AxisState {
    let sign = 1_f64.copysign(bend);
    let coasting = limits.velocity * coasting;
    // The velocity from which the acceleration came must not be outside either.
    let room = (2.0 * limits.jerk * (limits.velocity + sign * coasting)).sqrt();
    let acceleration = bend * limits.acceleration.min(room);
    let lost = 0.5 * acceleration * acceleration.abs() / limits.jerk;
    AxisState {
        position,
        velocity: (coasting - lost).clamp(-limits.velocity, limits.velocity),
        acceleration,
    }
}

/// Returns a velocity and an acceleration of a target that an axis can reach and leave within
/// `limits`.
pub(crate) fn target_motion(limits: AxisLimits, speed: f64, bend: f64) -> (f64, f64) {
    let velocity = speed * limits.velocity;
    let room = 2.0 * limits.jerk * (limits.velocity - velocity.abs());
    (velocity, bend * limits.acceleration.min(room.sqrt()))
}

/// Returns the distance in which an axis accelerates from rest to about its velocity limit and
/// stops again.
pub(crate) fn way_to_speed(limits: AxisLimits) -> f64 {
    let AxisLimits {
        velocity,
        acceleration,
        jerk,
    } = limits;
    velocity * (velocity / acceleration + acceleration.min((velocity * jerk).sqrt()) / jerk)
}

/// Returns one axis that moves to a target, and another axis that takes `duration` from rest to
/// rest.
pub(crate) fn beside_one_that_takes(
    duration: f64,
    limits: AxisLimits,
    state: AxisState,
    target: AxisState,
) -> (Limits<2>, State<2>, State<2>) {
    // The motion has four ramps of the jerk and does not reach the other limits. Its distance is 2
    // ramp^3.
    let ramp = 0.25 * duration;
    let beside = AxisLimits {
        velocity: 2.0 * ramp * ramp,
        acceleration: 2.0 * ramp,
        jerk: 1.0,
    };
    let both = |one: AxisState, position| State {
        position: [one.position, position],
        velocity: [one.velocity, 0.0],
        acceleration: [one.acceleration, 0.0],
    };
    (
        Limits::per_axis([limits, beside]).unwrap(),
        both(state, 0.0),
        both(target, 2.0 * ramp.powi(3)),
    )
}
