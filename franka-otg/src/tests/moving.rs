//! Targets in motion, tested through the public interface.

use std::vec::Vec;

use proptest::prelude::*;

use super::allowed::{beside_one_that_takes, target_motion};
use super::random::{arm_limits, cases, extreme_limits, many, many_moving, mixed_limits};
use super::walk::{check_motion, check_step};
use crate::{AxisLimits, AxisState, CYCLE, Generator, Limits, State, Synchronisation};

fn towards<const N: usize>(limits: Limits<N>, state: State<N>, target: &State<N>) -> Generator<N> {
    let mut generator = Generator::new(state, limits)
        .unwrap()
        .with_synchronisation(Synchronisation::Time);
    generator.set_moving_target(target).unwrap();
    generator
}

/// Returns one axis of a problem, with its own duration.
fn alone<const N: usize>(
    limits: &Limits<N>,
    state: &State<N>,
    target: &State<N>,
    axis: usize,
) -> Generator<1> {
    let one = |state: &State<N>| super::random::one(state.axis(axis));
    let limits = Limits::per_axis([limits.axis(axis)]).unwrap();
    towards(limits, one(state), &one(target))
}

/// Checks that a motion stays within its limits, and is at its target at the announced time.
fn check<const N: usize>(
    (limits, state, target): (Limits<N>, State<N>, State<N>),
) -> Result<(), TestCaseError> {
    let generator = towards(limits, state, &target);
    check_motion(&generator, 300);
    let arrival = generator.time_to_target();
    let met = generator.sample(arrival * (1.0 + f64::EPSILON));
    for i in 0..N {
        let slowest = alone(&limits, &state, &target, i).time_to_target();
        prop_assert!(
            slowest <= arrival * (1.0 + 1e-12),
            "axis {i} takes {slowest}, not {arrival}"
        );
        let (got, to) = (met.axis(i), target.axis(i));
        // Effect of a rounded duration on the velocity and the acceleration.
        let rounding = 64.0 * f64::EPSILON;
        let limits = limits.axis(i);
        let size = to.position.abs() + state.position[i].abs() + limits.velocity * arrival;
        prop_assert!(
            (got.position - to.position).abs() <= rounding * size,
            "{got:?} {to:?}"
        );
        let size = limits.velocity + limits.acceleration * arrival;
        prop_assert!(
            (got.velocity - to.velocity).abs() <= rounding * size,
            "{got:?} {to:?}"
        );
        // The target's acceleration is reached within a few picoseconds.
        let size = limits.acceleration + limits.jerk * (arrival + 1e3);
        prop_assert!(
            (got.acceleration - to.acceleration).abs() <= rounding * size,
            "{got:?} {to:?}"
        );
    }
    Ok(())
}

/// Follows a random motion within the limits for a while, and uses its end as the target. The plan
/// must not take longer than this motion, and the motion's duration must be feasible.
fn certify(
    (limits, state, _): (Limits<1>, State<1>, [f64; 1]),
    legs: &[(f64, f64)],
) -> Result<(), TestCaseError> {
    let top = limits.axis(0);
    let unit = top.velocity / top.acceleration + top.acceleration / top.jerk;
    let mut guide = Generator::new(state, limits).unwrap();
    let (mut now, mut took) = (state, 0.0);
    for &(distance, part) in legs {
        guide.set_state(now).unwrap();
        let target = now.position[0] + distance * unit * top.velocity;
        guide.set_target(&[target]).unwrap();
        let t = part * guide.duration();
        now = guide.sample(t);
        took += t;
    }
    let target = now.axis(0);
    let change = 0.5 * target.acceleration * target.acceleration / top.jerk;
    // A motion within the limits may be unable to reach the target, so such cases are skipped.
    prop_assume!(target.velocity.abs() + change <= top.velocity);
    let least = towards(limits, state, &now).time_to_target();
    prop_assert!(least <= took * (1.0 + 1e-9), "{least} instead of {took}");
    let (limits, state, target) = beside_one_that_takes(took, top, state.axis(0), target);
    let both = towards(limits, state, &target);
    let got = both.time_to_target();
    prop_assert!(
        (got - took).abs() <= 1e-9 * took,
        "{got} instead of {took}, least {least}"
    );
    Ok(())
}

/// Creates a new plan in each cycle. The time of arrival must not change.
fn replan<const N: usize>(
    (limits, state, target): (Limits<N>, State<N>, State<N>),
) -> Result<(), TestCaseError> {
    let mut generator = towards(limits, state, &target);
    let duration = generator.time_to_target();
    for k in 1..((duration / CYCLE) as usize).min(3000) {
        let before = *generator.state();
        let now = *generator.step();
        check_step(&limits, &before, &now, CYCLE, 8.0);
        generator.set_state(now).unwrap();
        let late = generator.time_to_target() + CYCLE * k as f64 - duration;
        prop_assert!(
            late.abs() <= ROOT_OF_ROUNDING,
            "{late:e} late after {k} cycles of {duration}"
        );
    }
    Ok(())
}

/// A number of cycles, and the target that is set before them. For each axis, the target is a
/// position, a speed, and a flag for motion.
type Change = (usize, Vec<(f64, f64, bool)>);

/// Follows a sequence of moving and resting targets, with gaps and bursts, to the end.
fn follow<const N: usize>(
    (limits, state, _): (Limits<N>, State<N>, [f64; N]),
    changes: &[Change],
) -> Result<(), TestCaseError> {
    let mut generator = Generator::new(state, limits).unwrap();
    let step = |generator: &mut Generator<N>| -> Result<(), TestCaseError> {
        let before = *generator.state();
        let to = *generator.target();
        let after = *generator.step();
        check_step(&limits, &before, &after, CYCLE, 8.0);
        for (i, (to, end)) in to.iter().zip(generator.end()).enumerate() {
            // An axis at rest without a displacement keeps every bit.
            let stays = end == to && before.axis(i) == AxisState::at_rest(*to);
            prop_assert!(
                !stays || after.axis(i) == before.axis(i),
                "{:?}",
                after.axis(i)
            );
        }
        Ok(())
    };
    for (cycles, axes) in changes {
        let mut target = State::at_rest(generator.state().position);
        for (i, &(position, speed, changes)) in axes.iter().enumerate() {
            if changes {
                target.position[i] = position;
                (target.velocity[i], target.acceleration[i]) =
                    target_motion(limits.axis(i), speed.max(0.0), 0.5 * speed);
            }
        }
        generator.set_moving_target(&target).unwrap();
        for _ in 0..*cycles {
            step(&mut generator)?;
        }
    }
    for _ in 0..(generator.remaining() / CYCLE).ceil() as usize {
        prop_assert!(!generator.is_done());
        step(&mut generator)?;
    }
    prop_assert!(generator.is_done());
    prop_assert_eq!(generator.state(), &State::at_rest(*generator.end()));
    Ok(())
}

fn changes<const N: usize>() -> impl Strategy<Value = Vec<Change>> {
    let axis = (-2.0..2.0, -1.0..1.0, any::<bool>());
    let cycles = prop_oneof![0_usize..4, 0_usize..300];
    proptest::collection::vec((cycles, proptest::collection::vec(axis, N)), 1..6)
}

fn leg() -> impl Strategy<Value = (f64, f64)> {
    let distance = prop_oneof![-3.0..3.0, -0.1..0.1];
    (distance, prop_oneof![4 => 0.0..1.0, 1 => Just(1.0)])
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn one_axis_meets_its_target(problem in many_moving::<1>(mixed_limits())) {
        check(problem)?;
    }

    #[test]
    fn seven_axes_meet_their_targets_together(problem in many_moving::<7>(arm_limits())) {
        check(problem)?;
    }

    #[test]
    fn three_axes_with_mixed_limits_meet_their_targets_together(problem in many_moving::<3>(mixed_limits())) {
        check(problem)?;
    }

    #[test]
    fn limits_nine_decades_apart_are_kept(problem in many_moving::<1>(extreme_limits())) {
        check(problem)?;
    }

    #[test]
    fn no_motion_inside_the_limits_is_faster(
        problem in many::<1>(mixed_limits()), legs in proptest::collection::vec(leg(), 1..4),
    ) {
        certify(problem, &legs)?;
    }
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn one_axis_follows_what_moves_and_what_rests(
        problem in many::<1>(arm_limits()), changes in changes::<1>(),
    ) {
        follow(problem, &changes)?;
    }

    #[test]
    fn six_axes_follow_what_moves_and_what_rests(
        problem in many::<6>(arm_limits()), changes in changes::<6>(),
    ) {
        follow(problem, &changes)?;
    }

    #[test]
    fn one_axis_replanned_in_each_cycle_arrives_when_planned(problem in many_moving::<1>(arm_limits())) {
        replan(problem)?;
    }

    #[test]
    fn seven_axes_replanned_in_each_cycle_arrive_when_planned(problem in many_moving::<7>(arm_limits())) {
        replan(problem)?;
    }
}

/// Time to correct a rounding error of the position near the end, as for targets at rest.
const ROOT_OF_ROUNDING: f64 = 2e-5;

/// This axis can be at its target until 0.11403 s, and again after 0.36 s.
#[test]
fn axis_early_by_less_than_a_cycle_is_not_early() {
    let limits = AxisLimits {
        velocity: 0.19915637055060992,
        acceleration: 14.697186906757418,
        jerk: 21.860681939737024,
    };
    let state = AxisState {
        position: 0.25,
        velocity: 0.19206426171502156,
        acceleration: -0.8554151344164556,
    };
    let target = AxisState {
        position: 0.2688356466016486,
        velocity: 0.17920354498482197,
        acceleration: 0.5382449056039369,
    };
    for (duration, expected) in [
        (0.1140, 0.1140),
        (0.11404, 0.362034),
        (0.1142, 0.362034),
        (0.3, 0.362034),
        (0.37, 0.37),
    ] {
        let problem = beside_one_that_takes(duration, limits, state, target);
        check(problem).unwrap();
        let arrival = towards(problem.0, problem.1, &problem.2).time_to_target();
        assert!(
            (arrival - expected).abs() < 1e-5,
            "{arrival} beside {duration}"
        );
    }
}

/// At the start, the acceleration can just be removed before the velocity exceeds its limit. The
/// first ramp therefore has no duration, and rounding must not make this duration negative.
#[test]
fn start_whose_ramp_ends_at_velocity_limit_is_on_time() {
    for (limits, from, to) in [
        (
            [1.5535810034256612, 0.12317897597788591, 857.8158894876473],
            [0.25, 1.5535810034256015, 1.0129782423983028e-5],
            [7.965082069798872, 1.1297348971077423, 0.0],
        ),
        (
            [0.8240603066797059, 1.4049498153490305, 141.70095386372785],
            [0.25, 0.824060306642014, 0.00010335350578967577],
            [0.49463795734067134, 0.48162239048678246, 0.0],
        ),
    ] {
        let [velocity, acceleration, jerk] = limits.map(|limit| [limit]);
        let limits = Limits::from_arrays(velocity, acceleration, jerk).unwrap();
        let state = |[position, velocity, acceleration]: [f64; 3]| State {
            position: [position],
            velocity: [velocity],
            acceleration: [acceleration],
        };
        check((limits, state(from), state(to))).unwrap();
    }
}
