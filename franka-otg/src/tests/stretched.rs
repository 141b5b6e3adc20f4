//! Step two, tested through the public interface: all axes arrive together.

use proptest::prelude::*;

use super::random::{arm_limits, cases, extreme_limits, many, mixed_limits};
use super::walk::check_motion;
use crate::{Generator, Limits, State, Synchronisation};

fn check<const N: usize>(
    (limits, state, target): (Limits<N>, State<N>, [f64; N]),
) -> Result<(), TestCaseError> {
    let mut generator = Generator::new(state, limits)
        .unwrap()
        .with_synchronisation(Synchronisation::Time);
    generator.set_target(&target).unwrap();
    let slowest = (0..N)
        .map(|i| {
            let limits = Limits::per_axis([limits.axis(i)]).unwrap();
            let mut alone = Generator::new(super::random::one(state.axis(i)), limits).unwrap();
            alone.set_target(&[target[i]]).unwrap();
            alone.duration()
        })
        .fold(0.0, f64::max);
    prop_assert_eq!(generator.duration(), slowest);
    check_motion(&generator, 300);
    Ok(())
}

proptest! {
    #![proptest_config(cases(600))]

    #[test]
    fn three_axes_of_an_arm_arrive_with_the_slowest(problem in many::<3>(arm_limits())) {
        check(problem)?;
    }

    #[test]
    fn six_axes_with_mixed_limits_arrive_with_the_slowest(problem in many::<6>(mixed_limits())) {
        check(problem)?;
    }

    #[test]
    fn seven_axes_with_mixed_limits_arrive_with_the_slowest(problem in many::<7>(mixed_limits())) {
        check(problem)?;
    }

    #[test]
    fn three_axes_with_extreme_limits_arrive_with_the_slowest(problem in many::<3>(extreme_limits())) {
        check(problem)?;
    }
}
