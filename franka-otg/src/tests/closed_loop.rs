//! Cycle-by-cycle motions, with targets that change at any time.

use std::vec::Vec;

use proptest::prelude::*;

use super::random::{arm_limits, cases, many};
use super::walk::check_step;
use crate::{CYCLE, Generator, Limits, State, Synchronisation};

/// A number of cycles, and the target (as fractions of a range) that is set before them.
type Change = (usize, Vec<f64>);

fn changes<const N: usize>() -> impl Strategy<Value = Vec<Change>> {
    let change = (0_usize..400, proptest::collection::vec(-2.0..2.0, N));
    proptest::collection::vec(change, 1..6)
}

/// Follows all changes to the end, and checks each cycle and the arrival.
fn follow<const N: usize>(
    (limits, state, _): (Limits<N>, State<N>, [f64; N]),
    changes: &[Change],
    synchronisation: Synchronisation,
) -> Result<(), TestCaseError> {
    let mut generator = Generator::new(state, limits)
        .unwrap()
        .with_synchronisation(synchronisation);
    let step = |generator: &mut Generator<N>| {
        let before = *generator.state();
        let after = *generator.step();
        check_step(&limits, &before, &after, CYCLE, 8.0);
    };
    for (cycles, target) in changes {
        let target: [f64; N] = core::array::from_fn(|i| target[i]);
        generator.set_target(&target).unwrap();
        for _ in 0..*cycles {
            step(&mut generator);
        }
    }
    let target = *generator.target();
    let cycles = (generator.remaining() / CYCLE).ceil() as usize;
    for _ in 0..cycles {
        prop_assert!(!generator.is_done());
        step(&mut generator);
    }
    prop_assert!(generator.is_done());
    prop_assert_eq!(generator.state(), &State::at_rest(target));
    prop_assert_eq!(generator.remaining(), 0.0);
    step(&mut generator);
    prop_assert_eq!(generator.state(), &State::at_rest(target));
    Ok(())
}

/// Creates a new plan in each cycle, from the state of the previous cycle. The time of arrival must
/// not change.
fn replan<const N: usize>(
    (limits, state, target): (Limits<N>, State<N>, [f64; N]),
    synchronisation: Synchronisation,
) -> Result<(), TestCaseError> {
    let mut generator = Generator::new(state, limits)
        .unwrap()
        .with_synchronisation(synchronisation);
    generator.set_target(&target).unwrap();
    let duration = generator.remaining();
    let cycles = ((duration / CYCLE).ceil() as usize).min(4000);
    for k in 1..cycles {
        let before = *generator.state();
        let now = *generator.step();
        check_step(&limits, &before, &now, CYCLE, 8.0);
        generator.set_state(now).unwrap();
        let late = generator.remaining() + CYCLE * k as f64 - duration;
        prop_assert!(
            late.abs() <= ROOT_OF_ROUNDING,
            "{late:e} late after {k} cycles of {cycles}"
        );
    }
    Ok(())
}

fn brake<const N: usize>(
    (limits, state, target): (Limits<N>, State<N>, [f64; N]),
    cycles: usize,
) -> Result<(), TestCaseError> {
    let mut generator = Generator::new(state, limits).unwrap();
    generator.set_target(&target).unwrap();
    for _ in 0..cycles {
        generator.step();
    }
    generator.brake();
    for _ in 0..(generator.remaining() / CYCLE).ceil() as usize {
        let before = *generator.state();
        let after = *generator.step();
        check_step(&limits, &before, &after, CYCLE, 8.0);
    }
    prop_assert!(generator.is_done());
    prop_assert_eq!(generator.state(), &State::at_rest(*generator.target()));
    Ok(())
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn one_axis_follows(problem in many::<1>(arm_limits()), changes in changes::<1>()) {
        follow(problem, &changes, Synchronisation::Straight)?;
    }

    #[test]
    fn three_axes_follow(problem in many::<3>(arm_limits()), changes in changes::<3>()) {
        follow(problem, &changes, Synchronisation::Straight)?;
        follow(problem, &changes, Synchronisation::Time)?;
    }

    #[test]
    fn six_axes_follow(problem in many::<6>(arm_limits()), changes in changes::<6>()) {
        follow(problem, &changes, Synchronisation::Straight)?;
    }

    #[test]
    fn seven_axes_follow(problem in many::<7>(arm_limits()), changes in changes::<7>()) {
        follow(problem, &changes, Synchronisation::Straight)?;
        follow(problem, &changes, Synchronisation::Time)?;
    }

    #[test]
    fn one_axis_replanned_in_each_cycle_arrives_when_planned(problem in many::<1>(arm_limits())) {
        replan(problem, Synchronisation::Time)?;
    }

    #[test]
    fn seven_axes_replanned_in_each_cycle_arrive_when_planned(problem in many::<7>(arm_limits())) {
        replan(problem, Synchronisation::Time)?;
    }

    #[test]
    fn braking_ends_at_rest(problem in many::<7>(arm_limits()), cycles in 0_usize..600) {
        brake(problem, cycles)?;
    }

    #[test]
    fn braking_on_a_straight_line_ends_at_rest(
        (limits, state, target) in many::<3>(arm_limits()), cycles in 0_usize..600,
    ) {
        brake((limits, State::at_rest(state.position), target), cycles)?;
    }
}

/// Time that a motion needs near its end to correct a rounding error of the position, a fiftieth of
/// a cycle. It is about the cube root of the error divided by the jerk: `4 * cbrt(16 eps * 2 /
/// 100)` for positions up to 2 and jerks of 100 and more.
const ROOT_OF_ROUNDING: f64 = 2e-5;
