//! Extreme limits, distances and states. The generator refuses none of them, and every motion
//! arrives.

use proptest::prelude::*;

use super::random::{cases, extreme_limits, many, many_moving, problems};
use super::walk::check_motion;
use crate::{CYCLE, Generator, Limits, State, Synchronisation};

/// Checks a motion. Motions that end within a thousandth of a cycle are not checked, because every
/// motion ends a millionth of a cycle early.
fn check_visible<const N: usize>(generator: &Generator<N>) {
    if generator.remaining() > 1e-3 * CYCLE {
        check_motion(generator, 100);
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn distances_down_to_rounding_are_moved(
        case in problems(extreme_limits()), exponent in -15.0_f64..-9.0, up in any::<bool>(),
    ) {
        let limits = Limits::per_axis([case.limits]).unwrap();
        let way = if up { 10_f64.powf(exponent) } else { -10_f64.powf(exponent) };
        let mut generator = Generator::new(State::at_rest([0.0]), limits).unwrap();
        generator.set_target(&[way]).unwrap();
        prop_assert!(generator.duration() > 0.0);
        check_visible(&generator);
        prop_assert_eq!(generator.sample(generator.duration()), State::at_rest([way]));
    }

    #[test]
    fn no_distance_with_speed_is_a_way_back(case in problems(extreme_limits())) {
        let limits = Limits::per_axis([case.limits]).unwrap();
        let mut generator = Generator::new(super::random::one(case.state), limits).unwrap();
        generator.set_target(&[case.state.position]).unwrap();
        check_visible(&generator);
        prop_assert_eq!(generator.end(), &[case.state.position]);
    }

    #[test]
    fn states_of_a_motion_are_starts_of_motions(
        (limits, state, target) in many::<3>(extreme_limits()), part in 0.0..1.0, other in -2.0..2.0,
    ) {
        for synchronisation in [Synchronisation::Time, Synchronisation::Straight] {
            let mut generator = Generator::new(state, limits)
                .unwrap()
                .with_synchronisation(synchronisation);
            generator.set_target(&target).unwrap();
            let now = generator.sample(part * generator.duration());
            generator.set_state(now).unwrap();
            check_visible(&generator);
            generator.set_target(&target.map(|p| p * other)).unwrap();
            check_visible(&generator);
            generator.brake();
            check_visible(&generator);
        }
    }

    #[test]
    fn states_of_motions_to_moving_targets_are_starts_of_motions(
        (limits, state, target) in many_moving::<3>(extreme_limits()), part in 0.0..1.5,
    ) {
        let mut generator = Generator::new(state, limits).unwrap();
        generator.set_moving_target(&target).unwrap();
        let now = generator.sample(part * generator.time_to_target());
        generator.set_state(now).unwrap();
        check_visible(&generator);
        generator.set_target(&target.position).unwrap();
        check_visible(&generator);
    }
}

#[test]
fn a_target_that_is_met_already_is_passed() {
    let limits = Limits::from_arrays([1.0], [5.0], [1000.0]).unwrap();
    let state = State {
        position: [0.3],
        velocity: [0.5],
        acceleration: [0.0],
    };
    let mut generator = Generator::new(state, limits).unwrap();
    generator.set_moving_target(&state).unwrap();
    assert_eq!(generator.time_to_target(), 0.0);
    // The axis continues with the target's velocity for a cycle.
    assert_eq!(generator.step().velocity, [0.5]);
    assert!((generator.state().position[0] - 0.3 - 0.5 * CYCLE).abs() < 1e-15);
    while !generator.is_done() {
        generator.step();
    }
    assert!(generator.state().position[0] > 0.3);
}
