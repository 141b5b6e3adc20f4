//! A new target for moving axes, and the first step towards it: the most expensive cycle of the
//! generator. The states are the same as in the generator's own benchmark.

// By path, because a benchmark is not part of the library.
#[path = "../../franka-otg/benches/replan/cases.rs"]
mod cases;

use franka_model::Model;
use franka_otg::AxisLimits;
use franka_rt::session::Budget;
use rand::{Rng, rngs::SmallRng};

use cases::{Case, Cases, clock, shortest};

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
    // Equal shares, so that no direction exceeds the budget.
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
    let cases: Vec<Case<N>> = Cases::new(limits).take(STATES).collect();
    Benchmark {
        key,
        statistics: &[Statistic::P50, Statistic::P99],
        round: Box::new(move || shortest(&cases, SWEEPS)),
    }
}

/// The first round measures all states. Every later round measures the slowest of them again,
/// alone.
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
                    let chunk = cases.by_ref().take(CHUNK);
                    suspects.extend(chunk.map(|case| (case.measure(clock), case)));
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

const STATES: usize = 2000;
const SWEEPS: usize = 5;
/// Tests run a short round of each benchmark and ignore its values.
const MANY_STATES: usize = if cfg!(debug_assertions) {
    10_000
} else {
    1_000_000
};
const CHUNK: usize = 1000;
const SUSPECTS: usize = 100;
const REPEATS: usize = 50;
