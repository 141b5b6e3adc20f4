//! The processing of a returned command: filter, limiter and check of torques and of a pose.

use std::hint::black_box;

use franka_model::transform;
use franka_proto::{RobotState, Version};
use franka_rt::control::{CartesianPose, Shaper, Torques};
use nalgebra::{Isometry3, Vector3};
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Inputs, Statistic, timed};

/// Benchmarks with torques, and with a pose with an elbow, on states of protocol 10.
pub fn all() -> Vec<Benchmark> {
    vec![torques(), pose()]
}

fn torques() -> Benchmark {
    let mut random = SmallRng::seed_from_u64(SEED);
    let mut cases = Inputs::new((0..CASES).map(|_| {
        let last: [f64; 7] = std::array::from_fn(|_| as_f32(random.random_range(-40.0..40.0)));
        // From within the rate limit to several times above it.
        let command = last.map(|last| last + random.random_range(-5.0..5.0));
        (Torques(command), last)
    }));
    let shaper = Shaper::new(Version::V10, true, CUTOFF_FREQUENCY);
    let mut state = RobotState::default();
    Benchmark {
        key: "rt.shape_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                let (command, last) = black_box(cases.next());
                // As after decoding: just written.
                state.tau_J_d = *last;
                let shaped = black_box(&shaper).torques(command, black_box(&state));
                black_box(shaped).expect("the torques are finite");
            })
        }),
    }
}

fn pose() -> Benchmark {
    let mut random = SmallRng::seed_from_u64(SEED);
    let mut cases = Inputs::new((0..CASES).map(|_| {
        let mut vector = |scale: f64| Vector3::from_fn(|_, _| random.random_range(-scale..scale));
        let last = Isometry3::new(vector(0.5), vector(1.5));
        // A few times the allowed change per cycle.
        let step = Isometry3::new(vector(0.01), vector(0.01));
        let command = CartesianPose {
            O_T_EE: transform::array(&(step * last)),
            elbow: Some([0.1001, -1.0]),
        };
        let mut twist = |scale| {
            let (linear, angular) = (vector(scale), vector(scale));
            [
                linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
            ]
            .map(as_f32)
        };
        let last = transform::array(&last).map(as_f32);
        (command, last, twist(0.3), twist(3.0))
    }));
    let shaper = Shaper::new(Version::V10, true, CUTOFF_FREQUENCY);
    let mut state = RobotState {
        elbow_c: [0.1, -1.0],
        ..RobotState::default()
    };
    Benchmark {
        key: "rt.shape_pose_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                let (command, last, twist, acceleration) = black_box(cases.next());
                state.O_T_EE_c = *last;
                state.O_dP_EE_c = *twist;
                state.O_ddP_EE_c = *acceleration;
                let shaped = black_box(&shaper).cartesian_pose(command, black_box(&state), false);
                black_box(shaped).expect("the pose is valid");
            })
        }),
    }
}

/// Rounds as in a state of protocol 10.
fn as_f32(x: f64) -> f64 {
    f64::from(x as f32)
}

const CUTOFF_FREQUENCY: f64 = 100.0;
const SEED: u64 = 4;
const CASES: usize = 64;
const SAMPLES: usize = 400;
const BATCH: u32 = 32;
