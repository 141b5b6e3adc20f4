//! A new target for moving axes, and the first step towards it: the most expensive cycle of the
//! generator.
//!
//! States are taken from random motions. Each sweep of a round measures every state once, so that
//! the branch predictor cannot learn a state. A state counts with its shortest time over the
//! sweeps, since longer ones include interruptions. The time of reading the clock is subtracted;
//! for one axis it would be a third of the figure.

use std::hint::black_box;
use std::time::Instant;

use franka_model::Model;
use franka_otg::{AxisLimits, Generator, Limits, State, Synchronisation};
use franka_rt::session::Budget;
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Statistic};

/// Benchmarks of one, three and seven axes with the limits of an arm, of seven with limits over
/// decades, and of the worst of many states.
///
/// One and seven axes are joints of the FR3, three the translation of the end effector in the
/// default budget. The axes are synchronised in time only, which costs more than a straight line.
pub fn all() -> Vec<Benchmark> {
    let joints = Model::fr3().joint_limits();
    let joint = move |axis: usize, _: &mut SmallRng| AxisLimits {
        velocity: joints.velocity[axis],
        acceleration: joints.acceleration[axis],
        jerk: joints.jerk[axis],
    };
    // Equal shares: then no direction exceeds the budget.
    let (budget, share) = (Budget::of(joints).translation, 1.0 / 3_f64.sqrt());
    let translation = AxisLimits {
        velocity: budget.velocity * share,
        acceleration: budget.acceleration * share,
        jerk: budget.jerk * share,
    };
    let cartesian = move |_: usize, _: &mut SmallRng| translation;
    let random = |_: usize, random: &mut SmallRng| {
        let mut decades = |low: f64, high: f64| 10_f64.powf(random.random_range(low..high));
        AxisLimits {
            velocity: decades(-1.0, 1.0),
            acceleration: decades(-1.0, 1.5),
            jerk: decades(0.0, 4.0),
        }
    };
    vec![
        replan::<1>("otg.replan_1_ns", joint),
        replan::<3>("otg.replan_3_ns", cartesian),
        replan::<7>("otg.replan_7_ns", joint),
        replan::<7>("otg.replan_7_random_ns", random),
        worst("otg.replan_7_ns", joint),
    ]
}

fn replan<const N: usize>(
    key: &'static str,
    limits: impl Fn(usize, &mut SmallRng) -> AxisLimits + 'static,
) -> Benchmark {
    let mut cases: Cases<N, _> = Cases::new(limits);
    let cases: Vec<_> = (0..STATES).map(|_| cases.next()).collect();
    Benchmark {
        key,
        statistics: &[Statistic::P50, Statistic::P99],
        round: Box::new(move || {
            let clock = clock();
            let mut shortest = vec![u64::MAX; cases.len()];
            for _ in 0..SWEEPS {
                for (case, shortest) in cases.iter().zip(&mut shortest) {
                    *shortest = (*shortest).min(case.measure(clock));
                }
            }
            shortest
        }),
    }
}

/// The first round measures all states. Every round then measures the slowest of them again, alone.
fn worst(
    key: &'static str,
    limits: impl Fn(usize, &mut SmallRng) -> AxisLimits + 'static,
) -> Benchmark {
    let mut cases: Cases<7, _> = Cases::new(limits);
    let mut suspects: Vec<(u64, Case<7>)> = Vec::new();
    Benchmark {
        key,
        statistics: &[Statistic::Max],
        round: Box::new(move || {
            let clock = clock();
            while suspects.is_empty() {
                for _ in 0..MANY_STATES / CHUNK {
                    suspects.extend((0..CHUNK).map(|_| {
                        let case = cases.next();
                        (case.measure(clock), case)
                    }));
                    suspects.sort_by_key(|(took, _)| std::cmp::Reverse(*took));
                    suspects.truncate(SUSPECTS);
                }
            }
            let alone = |case: &Case<7>| (0..REPEATS).map(|_| case.measure(clock)).min();
            suspects
                .iter()
                .filter_map(|(_, case)| alone(case))
                .collect()
        }),
    }
}

/// A generator in motion, and its next target.
#[derive(Clone)]
struct Case<const N: usize> {
    generator: Generator<N>,
    target: [f64; N],
}

impl<const N: usize> Case<N> {
    /// The nanoseconds of planning, less those of reading the `clock`.
    fn measure(&self, clock: u64) -> u64 {
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

/// The median nanoseconds between two consecutive readings of the clock.
fn clock() -> u64 {
    let mut readings = [0; 1001].map(|_: u64| {
        let start = Instant::now();
        u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    });
    readings.sort_unstable();
    readings[500]
}

/// States of motions to one target after the other, some way into each motion: before, in and after
/// its phase of constant velocity. After a while the next arm takes over.
struct Cases<const N: usize, L> {
    random: SmallRng,
    limits: L,
    generator: Option<Generator<N>>,
    left: usize,
}

impl<const N: usize, L: Fn(usize, &mut SmallRng) -> AxisLimits> Cases<N, L> {
    fn new(limits: L) -> Self {
        Self {
            random: SmallRng::seed_from_u64(SEED),
            limits,
            generator: None,
            left: 0,
        }
    }

    fn next(&mut self) -> Case<N> {
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
        case
    }
}

const SEED: u64 = 3;
const STATES: usize = 2000;
const SWEEPS: usize = 5;
const TARGETS: usize = 100;
/// The latest time of a new target in a motion, `[s]`.
const MOTION_MAX: f64 = 2.0;
/// Tests run a short round of each benchmark and ignore its figures.
const MANY_STATES: usize = if cfg!(debug_assertions) {
    10_000
} else {
    1_000_000
};
const CHUNK: usize = 1000;
const SUSPECTS: usize = 100;
const REPEATS: usize = 50;
