//! Motions on straight lines.

use proptest::prelude::*;

use super::random::{arm_limits, cases, many};
use super::walk::check_step;
use crate::{CYCLE, Generator, Limits, State, Synchronisation};

/// Returns the distance of a position from the line through the distinct points `from` and `to`.
fn distance_from_line<const N: usize>(from: &[f64; N], to: &[f64; N], position: &[f64; N]) -> f64 {
    let square: f64 = (0..N).map(|i| (to[i] - from[i]).powi(2)).sum();
    let along: f64 = (0..N)
        .map(|i| (position[i] - from[i]) * (to[i] - from[i]))
        .sum();
    let distance = |i: usize| (position[i] - from[i] - along / square * (to[i] - from[i])).abs();
    (0..N).map(distance).fold(0.0, f64::max)
}

fn norm<const N: usize>(vector: &[f64; N]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    [-0.6..0.6, -0.6..0.6, -0.6..0.6]
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn from_rest_the_path_is_straight((limits, state, target) in many::<7>(arm_limits())) {
        let start = state.position;
        let mut generator = Generator::new(State::at_rest(start), limits).unwrap();
        generator.set_target(&target).unwrap();
        let size = 1.0 + norm(&target);
        while !generator.is_done() {
            let before = *generator.state();
            let after = *generator.step();
            check_step(&limits, &before, &after, CYCLE, size);
            prop_assert!(distance_from_line(&start, &target, &after.position) <= 4e-15 * size);
        }
    }

    #[test]
    fn new_targets_on_the_line_keep_it(
        start in point(), way in point(), stops in proptest::collection::vec((1_usize..300, -3.0..3.0), 1..5),
    ) {
        let limits = Limits::from_arrays([1.0, 0.8, 0.5], [5.0, 4.0, 6.0], [900.0, 800.0, 700.0]).unwrap();
        let mut generator = Generator::new(State::at_rest(start), limits).unwrap();
        let at = |s: f64| core::array::from_fn(|i| start[i] + s * way[i]);
        generator.set_target(&at(1.0)).unwrap();
        for (cycles, s) in stops {
            for _ in 0..cycles {
                let before = *generator.state();
                let after = *generator.step();
                check_step(&limits, &before, &after, CYCLE, 4.0);
                prop_assert!(distance_from_line(&start, &at(1.0), &after.position) <= 1e-14);
            }
            generator.set_target(&at(s)).unwrap();
        }
    }

    #[test]
    fn motion_slowed_every_cycle_stays_on_line_and_arrives(
        start in point(), way in point(), most in 0.05..0.5,
    ) {
        let limits = Limits::from_arrays([1.0, 0.8, 0.5], [5.0, 4.0, 6.0], [900.0, 800.0, 700.0]).unwrap();
        let mut generator = Generator::new(State::at_rest(start), limits).unwrap();
        let target = core::array::from_fn(|i| start[i] + way[i]);
        generator.set_target(&target).unwrap();
        let mut cycles = 0;
        while !generator.is_done() {
            let speed = norm(&generator.step().velocity);
            if speed > most {
                generator.slow_down(most / speed).unwrap();
            }
            let State { position, velocity, .. } = generator.state();
            prop_assert!(norm(velocity) <= most * (1.0 + 1e-12));
            prop_assert!(distance_from_line(&start, &target, position) <= 1e-13);
            cycles += 1;
            prop_assert!(cycles < 60_000, "it never arrives");
        }
    }

    #[test]
    fn motion_held_back_stays_on_line_and_arrives(
        start in point(), way in point(), aside in point(), held in 1..300_usize,
    ) {
        let limits = Limits::from_arrays([1.0, 0.8, 0.5], [5.0, 4.0, 6.0], [900.0, 800.0, 700.0]).unwrap();
        let mut generator = Generator::new(State::at_rest(start), limits).unwrap();
        let target = core::array::from_fn(|i| start[i] + way[i]);
        prop_assert!(!generator.hold_back(&start, 1.0).unwrap(), "it rests");
        generator.set_target(&target).unwrap();
        let along = |at: &[f64; 3]| (0..3).map(|i| (at[i] - start[i]) * way[i]).sum::<f64>();
        let mut cycles = 0;
        while !generator.is_done() {
            let before = generator.step().position;
            // A place beside the line, 1 % behind or ahead.
            let share = if cycles % 2 == 0 { 0.99 } else { 1.01 };
            let place = core::array::from_fn(|i| start[i] + share * (before[i] - start[i]) + 1e-3 * aside[i]);
            if cycles < held && generator.hold_back(&place, 0.98).unwrap() {
                prop_assert!(along(&generator.state().position) <= along(&before) + 1e-12);
            }
            prop_assert!(distance_from_line(&start, &target, &generator.state().position) <= 1e-13);
            cycles += 1;
            prop_assert!(cycles < 60_000, "it never arrives");
        }
        prop_assert_eq!(generator.state().position, target);
    }

    #[test]
    fn line_is_as_fast_as_independent_axes_if_one_binds(start in point(), target in point()) {
        let limits = Limits::from_arrays([1.0; 3], [5.0; 3], [1000.0; 3]).unwrap();
        let duration = |synchronisation| {
            let mut generator = Generator::new(State::at_rest(start), limits)
                .unwrap()
                .with_synchronisation(synchronisation);
            generator.set_target(&target).unwrap();
            generator.duration()
        };
        let (line, time) = (duration(Synchronisation::Straight), duration(Synchronisation::Time));
        prop_assert!((line - time).abs() <= 1e-13, "{line} {time}");
    }

}

#[test]
fn an_axis_without_a_way_to_go_does_not_move_a_bit() {
    let limits = Limits::from_arrays([1.0; 3], [5.0; 3], [1000.0; 3]).unwrap();
    for synchronisation in [Synchronisation::Straight, Synchronisation::Time] {
        let start = State::at_rest([0.1, 0.7, 0.3]);
        let mut generator = Generator::new(start, limits)
            .unwrap()
            .with_synchronisation(synchronisation);
        generator.set_target(&[0.5, 0.7, -0.2]).unwrap();
        while !generator.is_done() {
            assert_eq!(generator.step().axis(1), start.axis(1));
        }
    }
}
