//! Pose, Jacobian, mass, Coriolis and gravity of the FR3 with a load: one by one, as five calls,
//! and in one pass.

use franka_model::{
    Dynamics, EndEffector, Frame, GRAVITY_EARTH, Jacobian, JointVector, Load, MassMatrix, Model,
};
use nalgebra::{Matrix3, Matrix4, Vector3};
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Inputs, Subject};

/// Benchmarks of the same five quantities in every way.
pub fn all() -> Vec<Benchmark> {
    subjects().into_iter().map(Subject::p50).collect()
}

/// Returns the calls to measure, with postures inside the limits and moderate velocities.
pub fn subjects() -> Vec<Subject> {
    let (model, ee, load, earth) = (Model::fr3(), EndEffector::default(), load(), GRAVITY_EARTH);
    let frame = Frame::EndEffector;
    vec![
        Subject::new("model.pose_ns", postures(), move |(q, _)| -> Matrix4<f64> {
            model.pose(frame, q, &ee)
        }),
        Subject::new("model.jacobian_ns", postures(), move |(q, _)| -> Jacobian {
            model.zero_jacobian(frame, q, &ee)
        }),
        Subject::new("model.mass_ns", postures(), move |(q, _)| -> MassMatrix {
            model.mass(q, &load)
        }),
        Subject::new(
            "model.coriolis_ns",
            postures(),
            move |(q, dq)| -> JointVector { model.coriolis(q, dq, &load) },
        ),
        Subject::new(
            "model.gravity_ns",
            postures(),
            move |(q, _)| -> JointVector { model.gravity(q, &load, &earth) },
        ),
        Subject::new("model.five_calls_ns", postures(), move |(q, dq)| {
            (
                model.pose(frame, q, &ee),
                model.zero_jacobian(frame, q, &ee),
                model.mass(q, &load),
                model.coriolis(q, dq, &load),
                model.gravity(q, &load, &earth),
            )
        }),
        Subject::new(
            "model.one_pass_ns",
            postures(),
            move |(q, dq)| -> Dynamics { model.dynamics(q, dq, &ee, &load, &earth) },
        ),
    ]
}

/// Returns positions inside the limits and moderate velocities.
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

/// Returns a load of 1 kg at some distance from the flange.
fn load() -> Load {
    Load {
        mass: 1.0,
        com: Vector3::new(0.01, 0.02, 0.1),
        inertia: Matrix3::from_diagonal(&Vector3::new(0.002, 0.003, 0.004)),
    }
}

const SEED: u64 = 2;
const POSTURES: usize = 256;
