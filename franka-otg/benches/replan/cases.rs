//! Measures the time to plan to the next target, for generators in motion.
//!
//! States come from random motions. Each sweep measures every state once, so that the branch
//! predictor cannot learn a state. The result of a state is its shortest time over the sweeps,
//! because longer times include interruptions. The time to read the clock is subtracted, because
//! for one axis it would be a third of the result.

use std::hint::black_box;
use std::time::Instant;

use franka_otg::{AxisLimits, Generator, Limits, State, Synchronisation};
use rand::{Rng, SeedableRng, rngs::SmallRng};

/// Returns the shortest time of each case over all sweeps, `[ns]`.
pub(crate) fn shortest<const N: usize>(cases: &[Case<N>], sweeps: usize) -> Vec<u64> {
    let clock = clock();
    let mut shortest = vec![u64::MAX; cases.len()];
    for _ in 0..sweeps {
        for (case, shortest) in cases.iter().zip(&mut shortest) {
            *shortest = (*shortest).min(case.measure(clock));
        }
    }
    shortest
}

/// A generator in motion, and its next target.
pub(crate) struct Case<const N: usize> {
    generator: Generator<N>,
    target: [f64; N],
}

impl<const N: usize> Case<N> {
    /// Returns the planning time in nanoseconds, minus the time to read the `clock`.
    pub(crate) fn measure(&self, clock: u64) -> u64 {
        let mut generator = self.generator.clone();
        let start = Instant::now();
        let planned = generator.set_target(black_box(&self.target));
        black_box(generator.step());
        let nanoseconds = start.elapsed().as_nanos();
        planned.expect("the target is finite and in reach");
        u64::try_from(nanoseconds)
            .unwrap_or(u64::MAX)
            .saturating_sub(clock)
            .max(1)
    }
}

/// Returns the median time between two consecutive readings of the clock, in nanoseconds.
pub(crate) fn clock() -> u64 {
    let mut readings = [0; 1001].map(|_: u64| {
        let start = Instant::now();
        u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    });
    readings.sort_unstable();
    readings[500]
}

/// States of motions to a sequence of targets, at random times of each motion: before, in and after
/// the phase of constant velocity. From time to time, another arm's limits apply.
pub(crate) struct Cases<const N: usize, L> {
    random: SmallRng,
    limits: L,
    generator: Option<Generator<N>>,
    left: usize,
}

impl<const N: usize, L: Fn(usize, &mut SmallRng) -> AxisLimits> Cases<N, L> {
    pub(crate) fn new(limits: L) -> Self {
        Self {
            random: SmallRng::seed_from_u64(SEED),
            limits,
            generator: None,
            left: 0,
        }
    }
}

impl<const N: usize, L: Fn(usize, &mut SmallRng) -> AxisLimits> Iterator for Cases<N, L> {
    type Item = Case<N>;

    fn next(&mut self) -> Option<Case<N>> {
        let random = &mut self.random;
        let mut generator = match self.generator.take() {
            Some(generator) if self.left > 0 => generator,
            _ => {
                self.left = TARGETS;
                let limits = std::array::from_fn(|axis| (self.limits)(axis, random));
                let limits = Limits::per_axis(limits).expect("the limits are positive and finite");
                Generator::new(State::at_rest([0.0; N]), limits)
                    .expect("a start at rest is valid")
                    .with_synchronisation(Synchronisation::Time)
            }
        };
        self.left -= 1;
        let target = std::array::from_fn(|_| random.random_range(-2.0..2.0));
        let case = Case {
            generator: generator.clone(),
            target,
        };
        generator
            .set_target(&target)
            .expect("the target is finite and in reach");
        let into = random.random_range(0.0..1.0) * generator.remaining().min(MOTION_MAX);
        let state = generator.sample(into);
        generator
            .set_state(state)
            .expect("a state of the generator's own is valid");
        self.generator = Some(generator);
        Some(case)
    }
}

const SEED: u64 = 3;
const TARGETS: usize = 100;
/// Latest time in a motion at which a new target is set, `[s]`.
const MOTION_MAX: f64 = 2.0;
