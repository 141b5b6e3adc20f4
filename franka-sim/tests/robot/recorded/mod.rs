//! Comparison of the model and of simulated arms with recordings of real arms.
//!
//! A recording is too large for the repository. `rows` contains some states of a recording, and
//! values computed from all its states.

mod four_gains;
mod friction;
mod rows;

use franka_model::{
    EndEffector, Frame, JointVector, Model, RobotKind, geometry::Lengths, transform,
};
use franka_sim::Tool;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use rows::{AT_REST, MOVING, Reported, SAMPLES, TORQUE};

/// Returns the distances between reported positions and positions of the model, `[m]`, and the
/// largest angle between the orientations, `[rad]`.
fn deviations<'a>(lengths: Lengths, rows: impl Iterator<Item = &'a Reported>) -> (Vec<f64>, f64) {
    let model = Model::physically_consistent(RobotKind::Fr3)
        .clone()
        .with_lengths(lengths);
    let ee = EndEffector {
        f_t_ee: Tool::hand().f_t_ne,
        ..EndEffector::default()
    };
    let mut angle = 0.0_f64;
    let mut distances: Vec<f64> = rows
        .map(|row| {
            let pose = model.pose(Frame::EndEffector, &JointVector::from(row.q), &ee);
            let pose = transform::isometry(&pose).expect("a rigid transform");
            let reported = UnitQuaternion::from_quaternion(Quaternion::from(row.quaternion));
            angle = angle.max(pose.rotation.angle_to(&reported));
            (pose.translation.vector - Vector3::from(row.p)).norm()
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    (distances, angle)
}

fn median(sorted: &[f64]) -> f64 {
    sorted[sorted.len() / 2]
}

#[test]
fn reported_poses_fit_the_model_with_recorded_lengths() {
    let (rest, angle) = deviations(Lengths::RECORDED_FR3, AT_REST.iter());
    assert!(median(&rest) < 1e-7, "{rest:?}");
    // The bound is the motion of joints with 5 mrad/s in 1.3 ms.
    let most = rest[rest.len() - 1];
    assert!(most < 1e-5 && angle < 3e-5, "{rest:?} {angle}");
    let (moving, _) = deviations(Lengths::RECORDED_FR3, MOVING.iter());
    assert!(median(&moving) < 1e-7, "{moving:?}");

    let all = || AT_REST.iter().chain(&MOVING);
    let (described, _) = deviations(Lengths::DESCRIBED, all());
    let (least, most) = (described[0], described[described.len() - 1]);
    assert!(least > 5e-5 && most < 6e-4, "{least} {most}");
}

#[test]
fn model_torques_equal_sensed_less_external_ones() {
    let model = Model::physically_consistent(RobotKind::Fr3);
    let load = Tool::hand().load;
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let mean = |model: &Model| -> JointVector {
        SAMPLES
            .iter()
            .map(|sample| {
                let [q, dq, ddq] = [sample.q, sample.dq, sample.ddq].map(JointVector::from);
                model.inverse_dynamics(&q, &dq, &ddq, &load, &gravity) * sample.weight
            })
            .sum()
    };
    let difference = JointVector::from(TORQUE) - mean(model);
    assert!(difference.amax() < 0.005, "{difference}");
}
