//! Refused inputs, which must change nothing.

use proptest::prelude::*;

use super::random::cases;
use crate::{Generator, Limits, PlanError, Quantity, State};

fn moving() -> Generator<2> {
    let limits = Limits::from_arrays([2.0; 2], [10.0; 2], [5000.0; 2]).unwrap();
    let mut generator = Generator::new(State::at_rest([0.0; 2]), limits).unwrap();
    generator.set_target(&[1.0, 0.3]).unwrap();
    for _ in 0..50 {
        generator.step();
    }
    generator
}

fn same_motion(one: &Generator<2>, other: &Generator<2>) {
    for k in 0..1000 {
        let t = f64::from(k) * 1e-3;
        assert_eq!(one.sample(t), other.sample(t));
    }
}

#[test]
fn targets_and_states_that_are_not_finite_are_refused() {
    let untouched = moving();
    let mut generator = moving();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(
            generator.set_target(&[0.0, bad]),
            Err(PlanError::NotFinite {
                quantity: Quantity::Target,
                axis: 2
            })
        );
        let state = State {
            velocity: [bad, 0.0],
            ..State::at_rest([0.0; 2])
        };
        assert_eq!(
            generator.set_state(state),
            Err(PlanError::NotFinite {
                quantity: Quantity::Velocity,
                axis: 1
            })
        );
    }
    same_motion(&generator, &untouched);
}

#[test]
fn uncomputable_target_or_limit_is_refused() {
    let untouched = moving();
    let mut generator = moving();
    assert_eq!(
        generator.set_target(&[1e300, 0.0]),
        Err(PlanError::OutOfRange { axis: 1 })
    );
    let tiny = Limits::from_arrays([2.0; 2], [1e-250, 10.0], [5000.0; 2]).unwrap();
    assert_eq!(
        generator.set_limits(tiny),
        Err(PlanError::OutOfRange { axis: 1 })
    );
    assert_eq!(generator.limits(), untouched.limits());
    same_motion(&generator, &untouched);
}

#[test]
fn the_same_target_and_limits_are_not_planned_again() {
    let untouched = moving();
    let mut generator = moving();
    generator.set_target(&[1.0, 0.3]).unwrap();
    generator.set_limits(*untouched.limits()).unwrap();
    assert_eq!(generator.duration(), untouched.duration());
    same_motion(&generator, &untouched);
}

#[test]
fn after_braking_the_old_target_counts_again() {
    let mut generator = moving();
    generator.brake();
    generator.set_target(&[1.0, 0.3]).unwrap();
    assert_eq!(generator.target(), &[1.0, 0.3]);
    while !generator.is_done() {
        generator.step();
    }
    assert_eq!(generator.state(), &State::at_rest([1.0, 0.3]));
}

#[test]
fn limits_lowered_in_motion_are_reached_under_the_jerk_limit() {
    let mut generator = moving();
    let slow = Limits::from_arrays([0.1; 2], [1.0; 2], [500.0; 2]).unwrap();
    generator.set_limits(slow).unwrap();
    let mut before = *generator.state();
    while !generator.is_done() {
        let after = *generator.step();
        for i in 0..2 {
            let jerk = (after.acceleration[i] - before.acceleration[i]) / 1e-3;
            assert!(jerk.abs() <= 500.0 * (1.0 + 1e-9), "{jerk}");
        }
        before = after;
    }
    assert_eq!(generator.state(), &State::at_rest([1.0, 0.3]));
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn any_numbers_give_an_error_or_finite_motion(
        numbers in proptest::array::uniform7(any::<f64>()), t in any::<f64>(),
    ) {
        let [p, v, a, target, velocity, acceleration, jerk] = numbers;
        let Ok(limits) =
            Limits::from_arrays([velocity.abs(); 2], [acceleration.abs(); 2], [jerk.abs(); 2])
        else {
            return Ok(());
        };
        let state = State { position: [p, 0.0], velocity: [v, 0.0], acceleration: [0.0, a] };
        let Ok(mut generator) = Generator::new(state, limits) else {
            return Ok(());
        };
        let _refused = generator.set_target(&[target, p]);
        let finite = |state: &State<2>| state.check().is_ok();
        prop_assert!(finite(&generator.sample(t)));
        prop_assert!(finite(generator.step()));
        generator.brake();
        prop_assert!(finite(generator.step()));
        prop_assert!(finite(&generator.sample(f64::INFINITY)));
    }
}
