//! A new target for seven axes that are moving: the most that the generator does in one cycle.

use std::time::Instant;

use franka_model::Model;
use franka_rt::otg::{AxisLimits, Generator, Limits, State};
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Statistic};

/// A new target with limits of all kinds, and with those of the FR3's joints.
pub fn all() -> Vec<Benchmark> {
    let limits = Model::fr3().joint_limits();
    let fr3 = |axis: usize, _: &mut SmallRng| AxisLimits {
        velocity: limits.velocity[axis],
        acceleration: limits.acceleration[axis],
        jerk: limits.jerk[axis],
    };
    let mixed = |_: usize, random: &mut SmallRng| AxisLimits {
        velocity: random.random_range(0.5..5.0),
        acceleration: random.random_range(5.0..20.0),
        jerk: random.random_range(2_000.0..10_000.0),
    };
    vec![
        replan("otg.replan_7_ns", mixed),
        replan("otg.replan_7_fr3_ns", fr3),
    ]
}

fn replan(
    key: &'static str,
    axis_limits: impl Fn(usize, &mut SmallRng) -> AxisLimits + 'static,
) -> Benchmark {
    let mut random = SmallRng::seed_from_u64(SEED);
    let round = move || {
        let mut samples = Vec::with_capacity(ARMS * TARGETS);
        for _ in 0..ARMS {
            let limits = std::array::from_fn(|axis| axis_limits(axis, &mut random));
            let limits = Limits::per_axis(limits).expect("the limits are positive and finite");
            let start = State::at_rest([0.0; 7]);
            let mut generator = Generator::new(start, limits).expect("a start at rest is valid");
            for _ in 0..TARGETS {
                let target = std::array::from_fn(|_| random.random_range(-2.0..2.0));
                let start = Instant::now();
                let result = generator.set_target(&target);
                let nanoseconds = start.elapsed().as_nanos();
                result.expect("the target is finite and in reach");
                samples.push(u64::try_from(nanoseconds).unwrap_or(u64::MAX));
                // Some way into the motion: before, in and after its phase of constant velocity.
                for _ in 0..random.random_range(1..CYCLES_MAX) {
                    generator.step();
                }
            }
        }
        samples
    };
    Benchmark {
        key,
        statistics: &[Statistic::P50, Statistic::P99],
        round: Box::new(round),
    }
}

const SEED: u64 = 3;
const ARMS: usize = 20;
const TARGETS: usize = 100;
const CYCLES_MAX: usize = 600;
