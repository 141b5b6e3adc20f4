//! Distances of the arm with the Hand to itself: every pair that can meet, each with its gradient.

use std::hint::black_box;

use franka_model::collision::Shape;
use franka_model::{JointVector, Model};
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Inputs, Statistic, timed};

/// Benchmarks from joint positions to all distances and gradients.
pub fn all() -> Vec<Benchmark> {
    let limits = Model::fr3().joint_limits();
    let mut random = SmallRng::seed_from_u64(SEED);
    let posture =
        move |_| JointVector::from_fn(|i, _| random.random_range(limits.lower[i]..limits.upper[i]));
    let mut postures = Inputs::new((0..POSTURES).map(posture));
    let shape = Shape::vendor().with_hand();
    vec![Benchmark {
        key: "model.self_collision_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                let placed = shape.at(black_box(postures.next()));
                for pair in placed.pairs() {
                    black_box(pair);
                }
            })
        }),
    }]
}

const SEED: u64 = 3;
const POSTURES: usize = 256;
const SAMPLES: usize = 400;
const BATCH: u32 = 16;
