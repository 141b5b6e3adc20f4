//! The place of a contact on the arm: a force on each body in turn, in random postures.

use std::hint::black_box;

use franka_model::collision::Shape;
use franka_model::contact::{TorqueError, locate};
use franka_model::{JointVector, RobotKind};

use super::{Benchmark, Inputs, Statistic, timed};
use franka_tests::contacts::pushes;

/// Benchmarks from joint positions and external torques to the contact.
pub fn all() -> Vec<Benchmark> {
    let kind = RobotKind::Fr3;
    let pushes = pushes(kind, PUSHES, SEED).into_iter();
    let mut inputs = Inputs::new(pushes.map(|push| (push.q, push.torque())));
    let shape = Shape::covering(kind).with_hand();
    let mut found = move || {
        let (q, torque): &(JointVector, JointVector) = inputs.next();
        black_box(&locate(&shape.at(q), torque, &TorqueError::AT_REST)).is_ok()
    };
    vec![Benchmark {
        key: "model.locate_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(PUSHES, 1, || {
                found();
            })
        }),
    }]
}

const SEED: u64 = 5;
const PUSHES: usize = 64;
