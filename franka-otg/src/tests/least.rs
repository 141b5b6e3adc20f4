//! Step one, tested through the public interface.

use proptest::prelude::*;

use super::oracle::least_duration;
use super::random::{Case, arm_limits, cases, extreme_limits, mixed_limits, one, problems};
use super::walk::{check_motion, check_step};
use crate::{AxisLimits, AxisState, Generator, Limits};

/// Compares the duration with a bisection, whose error is the rounding of positions divided by the
/// velocity, or a square root of it near a stop point.
fn check_duration(case: &Case) -> Result<(), TestCaseError> {
    let duration = case.generator().duration();
    let expected = least_duration(case.state, case.target, case.limits);
    let error = (duration - expected).abs() / expected;
    prop_assert!(error <= 1e-7, "{duration} instead of {expected}: {error:e}");
    Ok(())
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn the_duration_is_the_least_for_arms(case in problems(arm_limits())) {
        check_duration(&case)?;
        check_motion(&case.generator(), 200);
    }

    #[test]
    fn the_duration_is_the_least_in_every_family(case in problems(mixed_limits())) {
        check_duration(&case)?;
        check_motion(&case.generator(), 200);
    }

    #[test]
    fn limits_nine_decades_apart_are_kept(case in problems(extreme_limits())) {
        check_duration(&case)?;
        check_motion(&case.generator(), 200);
    }

    #[test]
    fn from_rest_nothing_overshoots(limits in mixed_limits(), exponent in -9.0..3.0, p in -3.0..3.0) {
        let target = p + 10_f64.powf(exponent);
        let case = Case { limits, state: AxisState::at_rest(p), target };
        let generator = case.generator();
        let mut last = p;
        for k in 0..=300 {
            let now = generator.sample(generator.duration() * f64::from(k) / 300.0).position[0];
            prop_assert!(now >= last && now <= target, "{last} {now} {target}");
            last = now;
        }
    }

    #[test]
    fn mirrored_problems_take_equally_long(case in problems(mixed_limits())) {
        let AxisState { position, velocity, acceleration } = case.state;
        let mirrored = Case {
            state: AxisState { position: -position, velocity: -velocity, acceleration: -acceleration },
            target: -case.target,
            ..case
        };
        prop_assert_eq!(case.generator().duration(), mirrored.generator().duration());
    }

    #[test]
    fn from_outside_the_limits_the_way_back_keeps_the_jerk(
        limits in mixed_limits(), v in -4.0..4.0, a in -4.0..4.0, target in -5.0..5.0,
    ) {
        let state = AxisState {
            position: 0.0,
            velocity: v * limits.velocity,
            acceleration: a * limits.acceleration,
        };
        let case = Case { limits, state, target };
        let generator = case.generator();
        let worst = AxisLimits {
            velocity: 1e3 * limits.velocity.max(limits.acceleration * limits.acceleration / limits.jerk),
            acceleration: 4.0 * limits.acceleration,
            jerk: limits.jerk,
        };
        let worst = Limits::per_axis([worst]).unwrap();
        let size = 10.0 + limits.velocity * generator.duration();
        let dt = generator.duration() / 500.0;
        let mut before = *generator.state();
        let mut was_inside = false;
        for k in 1..=500 {
            let after = generator.sample(dt * f64::from(k));
            check_step(&worst, &before, &after, dt, size);
            let inside = after.velocity[0].abs() <= limits.velocity * (1.0 + 1e-9)
                && after.acceleration[0].abs() <= limits.acceleration * (1.0 + 1e-9);
            prop_assert!(inside || !was_inside, "leaves the limits again at {}", dt * f64::from(k));
            let coasting = after.velocity[0]
                + 0.5 * after.acceleration[0] * after.acceleration[0].abs() / limits.jerk;
            was_inside |= inside && coasting.abs() <= limits.velocity;
            before = after;
        }
    }
}

/// Limits similar to an arm's joint.
const JOINT: AxisLimits = AxisLimits {
    velocity: 2.0,
    acceleration: 10.0,
    jerk: 5000.0,
};

#[test]
fn a_target_at_the_stop_point_is_a_stop() {
    let state = AxisState {
        position: 0.1,
        velocity: 1.5,
        acceleration: -3.0,
    };
    let stopping = Generator::new(one(state), Limits::per_axis([JOINT]).unwrap()).unwrap();
    let case = Case {
        limits: JOINT,
        state,
        target: stopping.target()[0],
    };
    assert!((case.generator().duration() - stopping.duration()).abs() < 1e-12);
}

#[test]
fn the_smallest_distance_is_moved() {
    let case = Case {
        limits: JOINT,
        state: AxisState::at_rest(1.0),
        target: 1.0 + f64::EPSILON,
    };
    let mut generator = case.generator();
    assert!(generator.duration() > 0.0);
    generator.step();
    assert_eq!(generator.state().position, [1.0 + f64::EPSILON]);
}
