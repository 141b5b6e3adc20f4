//! Inverse kinematics: all postures of a pose, and joint velocities in a box.

use std::hint::black_box;
use std::time::Instant;

use franka_model::analytic_ik::{self, Redundancy};
use franka_model::differential_ik::{DifferentialIk, JointBox, Side, Solution};
use franka_model::geometry::Lengths;
use franka_model::{
    CYCLE, EndEffector, Frame, Jacobian, JointVector, Model, Twist, elbow, transform,
};
use nalgebra::Isometry3;
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Inputs, Statistic, Subject};

/// Benchmarks of all postures for a pose and a redundancy parameter of each kind, and of the
/// velocity problem with joints at their bounds.
pub fn all() -> Vec<Benchmark> {
    let mut benchmarks: Vec<_> = subjects().into_iter().map(Subject::p50).collect();
    benchmarks.push(worst_pinned());
    benchmarks
}

/// The calls to measure.
pub fn subjects() -> Vec<Subject> {
    let (model, ee) = (Model::fr3(), EndEffector::default());
    let solve = |key, parameter: fn(&JointVector) -> Redundancy| {
        Subject::new(key, poses(parameter), move |(pose, given)| {
            analytic_ik::solve(model, pose, &ee, *given)
        })
    };
    vec![
        solve("model.ik_all_ns", |q| Redundancy::Joint7(q[6])),
        solve("model.ik_joint_4_ns", |q| Redundancy::Joint4(q[3])),
        solve("model.ik_swivel_ns", |q| {
            Redundancy::Swivel(elbow::swivel(&Lengths::DESCRIBED, q).unwrap_or(0.0))
        }),
        Subject::new(
            "model.box_ik_ns",
            Inputs::new(pinned().into_iter()),
            |state: &Pinned| state.solve(state.start),
        ),
        Subject::new(
            "model.box_ik_cold_ns",
            Inputs::new(pinned().into_iter()),
            |state: &Pinned| state.solve(COLD),
        ),
    ]
}

/// Measures each state alone, without knowledge of the active bounds, so that the worst state
/// shows. Takes the shortest of several repetitions of each, because a repetition may be
/// interrupted.
fn worst_pinned() -> Benchmark {
    let states = pinned();
    let time = |state: &Pinned| {
        let repetition = |_| {
            let start = Instant::now();
            black_box(black_box(state).solve(COLD));
            u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
        };
        (0..REPETITIONS).map(repetition).min().unwrap_or(0)
    };
    Benchmark {
        key: "model.box_ik_ns",
        statistics: &[Statistic::Max],
        round: Box::new(move || states.iter().map(time).collect()),
    }
}

/// A velocity problem whose solution has joints at their bounds.
struct Pinned {
    /// The active bounds of the previous millisecond.
    start: [Side; 7],
    jacobian: Jacobian,
    twist: Twist,
    posture: JointVector,
    bounds: JointBox,
}

impl Pinned {
    fn random(random: &mut SmallRng) -> Self {
        let jacobian = |q: &JointVector| {
            Model::fr3().zero_jacobian(Frame::EndEffector, q, &EndEffector::default())
        };
        let q = posture(random);
        let bound = JointVector::from_fn(|_, _| random.random_range(0.0..1.0));
        let before = Self {
            start: COLD,
            jacobian: jacobian(&q),
            twist: Twist::from_fn(|_, _| random.random_range(-0.5..0.5)),
            posture: JointVector::from_fn(|_, _| random.random_range(-0.5..0.5)),
            bounds: JointBox::symmetric(&bound),
        };
        let answer = before.solve(COLD);
        Self {
            start: answer.active,
            jacobian: jacobian(&(q + answer.velocity * CYCLE)),
            ..before
        }
    }

    fn solve(&self, start: [Side; 7]) -> Solution {
        let ik = DifferentialIk::default();
        ik.solve(
            &self.jacobian,
            &self.twist,
            &self.posture,
            &self.bounds,
            start,
        )
    }
}

fn pinned() -> Vec<Pinned> {
    let mut random = SmallRng::seed_from_u64(SEED);
    let all = std::iter::repeat_with(|| Pinned::random(&mut random));
    let bound = |state: &Pinned| state.start != COLD;
    all.filter(bound).take(STATES).collect()
}

/// Returns poses of postures inside the limits, with their redundancy parameter.
fn poses(parameter: fn(&JointVector) -> Redundancy) -> Inputs<(Isometry3<f64>, Redundancy)> {
    let mut random = SmallRng::seed_from_u64(SEED);
    Inputs::new((0..POSTURES).map(move |_| {
        let q = posture(&mut random);
        let pose = Model::fr3().pose(Frame::EndEffector, &q, &EndEffector::default());
        let pose = transform::isometry(&pose).expect("the frame is rigid");
        (pose, parameter(&q))
    }))
}

fn posture(random: &mut SmallRng) -> JointVector {
    let limits = Model::fr3().joint_limits();
    JointVector::from_fn(|i, _| random.random_range(limits.lower[i]..limits.upper[i]))
}

/// No bound is known to be active.
const COLD: [Side; 7] = [Side::Free; 7];
const SEED: u64 = 4;
const POSTURES: usize = 256;
const STATES: usize = 1000;
const REPETITIONS: usize = 5;
