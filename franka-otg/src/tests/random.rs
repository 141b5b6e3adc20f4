//! Random limits, states and targets.

use proptest::prelude::*;

use super::allowed::{inside, target_motion, way_to_speed};
use crate::{AxisLimits, AxisState, Generator, Limits, State};

/// Generates numbers between `10^low` and `10^high` whose logarithm is uniform.
fn decades(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(|exponent| 10_f64.powf(exponent))
}

fn limits(
    velocity: (f64, f64),
    acceleration: (f64, f64),
    jerk: (f64, f64),
) -> impl Strategy<Value = AxisLimits> {
    let velocity = decades(velocity.0, velocity.1);
    let acceleration = decades(acceleration.0, acceleration.1);
    let jerk = decades(jerk.0, jerk.1);
    (velocity, acceleration, jerk).prop_map(|(velocity, acceleration, jerk)| AxisLimits {
        velocity,
        acceleration,
        jerk,
    })
}

/// Limits similar to the limits of an arm's joints and tools, down to a tenth of full speed.
pub(super) fn arm_limits() -> impl Strategy<Value = AxisLimits> {
    limits((-1.0, 0.7), (0.0, 1.3), (2.0, 4.0))
}

/// Limits that are reached in some cases and not in others, so that every family of profiles
/// occurs.
pub(super) fn mixed_limits() -> impl Strategy<Value = AxisLimits> {
    limits((-1.0, 1.0), (-1.0, 1.5), (0.0, 4.0))
}

/// Limits up to nine decades apart.
pub(super) fn extreme_limits() -> impl Strategy<Value = AxisLimits> {
    limits((-3.0, 6.0), (-3.0, 6.0), (-3.0, 6.0))
}

/// One axis: limits, a state that can stay inside them, and a target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case {
    pub(super) limits: AxisLimits,
    pub(super) state: AxisState,
    pub(super) target: f64,
}

impl Case {
    pub(super) fn generator(&self) -> Generator<1> {
        let limits = Limits::per_axis([self.limits]).unwrap();
        let mut generator = Generator::new(one(self.state), limits).unwrap();
        generator.set_target(&[self.target]).unwrap();
        generator
    }
}

pub(super) fn one(state: AxisState) -> State<1> {
    State {
        position: [state.position],
        velocity: [state.velocity],
        acceleration: [state.acceleration],
    }
}

/// Returns the position at which an axis with these limits stops.
pub(super) fn stop_point(limits: AxisLimits, state: AxisState) -> f64 {
    let limits = Limits::per_axis([limits]).unwrap();
    Generator::new(one(state), limits).unwrap().target()[0]
}

/// Generates states within the limits. The targets' distances from the stop point range from large
/// values to a millionth.
pub(super) fn problems(limits: impl Strategy<Value = AxisLimits>) -> impl Strategy<Value = Case> {
    let fraction = || prop_oneof![4 => -1.0..1.0, 1 => Just(1.0), 1 => Just(0.0)];
    let distance = (prop_oneof![3 => -1.0..1.5, 2 => -6.0..-1.0], any::<bool>());
    (limits, fraction(), fraction(), distance).prop_map(
        |(limits, coasting, bend, (exponent, up))| {
            let state = inside(limits, 0.25, coasting, bend);
            let distance = way_to_speed(limits) * 10_f64.powf(exponent);
            let stop = stop_point(limits, state);
            Case {
                limits,
                state,
                target: if up { stop + distance } else { stop - distance },
            }
        },
    )
}

/// Generates limits, states and targets of `N` axes.
pub(super) fn many<const N: usize>(
    limits: impl Strategy<Value = AxisLimits>,
) -> impl Strategy<Value = (Limits<N>, State<N>, [f64; N])> {
    proptest::collection::vec(problems(limits), N).prop_map(|cases| {
        let limits = Limits::per_axis(core::array::from_fn(|i| cases[i].limits)).unwrap();
        let state = State {
            position: core::array::from_fn(|i| cases[i].state.position),
            velocity: core::array::from_fn(|i| cases[i].state.velocity),
            acceleration: core::array::from_fn(|i| cases[i].state.acceleration),
        };
        (limits, state, core::array::from_fn(|i| cases[i].target))
    })
}

/// Generates limits, states and targets in motion of `N` axes; some targets move with constant
/// velocity, and some rest.
pub(super) fn many_moving<const N: usize>(
    limits: impl Strategy<Value = AxisLimits>,
) -> impl Strategy<Value = (Limits<N>, State<N>, State<N>)> {
    let bend = || prop_oneof![2 => Just(0.0), 1 => -1.0..1.0];
    let speed = prop_oneof![6 => -1.0..1.0, 1 => Just(0.0), 1 => -1e-9..1e-9, 1 => Just(1.0)];
    let motion = (speed, bend());
    (many::<N>(limits), proptest::collection::vec(motion, N)).prop_map(
        |((limits, state, position), motions)| {
            let mut target = State::at_rest(position);
            for (i, (speed, bend)) in motions.into_iter().enumerate() {
                let (velocity, acceleration) = target_motion(limits.axis(i), speed, bend);
                target.velocity[i] = velocity;
                target.acceleration[i] = acceleration;
            }
            (limits, state, target)
        },
    )
}

/// Runs `count` cases without a seed file next to the source. A failing case is printed, and should
/// become a separate test.
pub(crate) fn cases(count: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(count)
    }
}
