//! Pose, Jacobian, mass, Coriolis and gravity of the FR3 under a load: five calls, and one pass.

use std::hint::black_box;

use franka_model::{EndEffector, Frame, GRAVITY_EARTH, JointVector, Load, Model};
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Inputs, Statistic, timed};

/// The same five quantities in both ways.
pub fn all() -> Vec<Benchmark> {
    vec![five_calls(), one_pass()]
}

fn five_calls() -> Benchmark {
    let mut postures = postures();
    let (ee, load) = (EndEffector::default(), load());
    let model = Model::fr3();
    Benchmark {
        key: "model.five_calls_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                let (q, dq) = black_box(postures.next());
                black_box(model.pose(Frame::EndEffector, q, &ee));
                black_box(model.zero_jacobian(Frame::EndEffector, q, &ee));
                black_box(model.mass(q, &load));
                black_box(model.coriolis(q, dq, &load));
                black_box(model.gravity(q, &load, &GRAVITY_EARTH));
            })
        }),
    }
}

fn one_pass() -> Benchmark {
    let mut postures = postures();
    let (ee, load) = (EndEffector::default(), load());
    let model = Model::fr3();
    Benchmark {
        key: "model.one_pass_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                let (q, dq) = black_box(postures.next());
                black_box(model.dynamics(q, dq, &ee, &load, &GRAVITY_EARTH));
            })
        }),
    }
}

/// Positions inside the limits and moderate velocities.
fn postures() -> Inputs<(JointVector, JointVector)> {
    let limits = Model::fr3().joint_limits();
    let mut random = SmallRng::seed_from_u64(SEED);
    let posture = move |_| {
        let q = JointVector::from_fn(|i, _| random.random_range(limits.lower[i]..limits.upper[i]));
        let dq = JointVector::from_fn(|_, _| random.random_range(-1.0..1.0));
        (q, dq)
    };
    Inputs::new((0..POSTURES).map(posture))
}

/// A load of 1 kg some way off the flange.
fn load() -> Load {
    Load {
        mass: 1.0,
        com: Vector3::new(0.01, 0.02, 0.1),
        inertia: Matrix3::from_diagonal(&Vector3::new(0.002, 0.003, 0.004)),
    }
}

const SEED: u64 = 2;
const POSTURES: usize = 256;
const SAMPLES: usize = 400;
const BATCH: u32 = 16;
