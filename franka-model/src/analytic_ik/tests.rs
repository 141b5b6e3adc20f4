use super::*;
use crate::random::Random;
use crate::{Frame, READY, RobotKind, elbow, rotation};
use nalgebra::{Matrix4, Translation3};

fn flange(q: &JointVector) -> Isometry3<f64> {
    let pose = Model::fr3().pose(Frame::Flange, q, &EndEffector::default());
    transform::isometry(&pose).expect("a rigid frame")
}

/// Metres and radians between the flange at `q` and `target`, the larger.
fn miss(q: &JointVector, target: &Isometry3<f64>) -> f64 {
    let reached = flange(q);
    let distance = (reached.translation.vector - target.translation.vector).norm();
    distance.max(rotation::error(&target.rotation, &reached.rotation).norm())
}

fn branch(q: &JointVector) -> Branch {
    Branch {
        elbow: q[3] > elbow::FLIP_ANGLE,
        wrist: sin_cos(q[4]).1 > 0.0,
        shoulder: q[1] < 0.0,
    }
}

#[test]
fn every_solution_is_one_and_the_seeding_posture_is_among_them() {
    for kind in RobotKind::ALL {
        let model = Model::of(kind);
        let limits = model.joint_limits();
        let mut random = Random::new(81);
        for _ in 0..50_000 {
            let q = random.posture(model);
            let target = flange(&q);
            let real = all(&target, q[6]);
            assert!([4, 8].contains(&real.len()), "{} solutions", real.len());
            for solution in real.iter() {
                assert!(miss(&solution.q, &target) < 1e-12);
            }
            let found = real.within(&limits.lower, &limits.upper);
            for solution in found.iter() {
                assert!(limits.contains(&solution.q));
                assert!(miss(&solution.q, &target) < 1e-12);
                assert_eq!(solution.branch, branch(&solution.q));
            }
            // Near a double root an angle is known to the root of the rounding.
            let seed = found.nearest(&q).expect("the seeding posture");
            assert!((seed.q - q).amax() < 1e-6, "{}", (seed.q - q).amax());
        }
    }
}

#[test]
fn the_ready_pose_has_eight_solutions_and_one_within_the_limits() {
    let target = flange(&READY);
    assert_eq!(all(&target, READY[6]).len(), 8);
    for kind in RobotKind::ALL {
        let found = solve(Model::of(kind), &target, &EndEffector::default(), READY[6]);
        let found = found.expect("finite");
        assert_eq!(found.len(), 1);
        assert!((found[0].q - READY).amax() < 1e-13);
    }
}

#[test]
fn the_tool_is_taken_off_first() {
    let tool = Isometry3::from_parts(
        Translation3::new(0.02, -0.01, 0.15),
        rotation::exp(&Vector3::new(0.1, 0.4, -0.8)),
    );
    let ee = EndEffector {
        f_t_ee: transform::matrix(&tool),
        ..EndEffector::default()
    };
    let target = flange(&READY) * tool;
    let found = solve(Model::fr3(), &target, &ee, READY[6]).expect("finite");
    assert!((found[0].q - READY).amax() < 1e-12);
}

#[test]
fn with_joint_2_at_zero_joints_1_and_3_share_the_turn() {
    let mut q = READY;
    (q[0], q[1], q[2]) = (0.3, 0.0, 0.5);
    let limits = Model::fr3().joint_limits();
    let target = flange(&q);
    let found = all(&target, q[6]).within(&limits.lower, &limits.upper);
    let solution = found.nearest(&q).expect("a solution");
    assert!(miss(&solution.q, &target) < 1e-12);
    // Rounding leaves a sine of about 1e-16, or none.
    assert!((solution.q[0] - 0.4).abs() < 1e-12 && (solution.q[2] - 0.4).abs() < 1e-12);
}

#[test]
fn near_joint_2_at_zero_poses_are_met_all_the_same() {
    let mut random = Random::new(82);
    for exponent in 3..16 {
        for _ in 0..100 {
            let mut q = random.posture(Model::fr3());
            q[1] = 10f64.powi(-exponent);
            let target = flange(&q);
            for solution in all(&target, q[6]).iter() {
                assert!(miss(&solution.q, &target) < 1e-12, "{exponent}");
            }
        }
    }
}

#[test]
fn a_stretched_arm_is_found_twice() {
    let mut q = READY;
    q[3] = elbow::FLIP_ANGLE;
    let target = flange(&q);
    let near = all(&target, q[6]);
    let near = near.iter().filter(|s| (s.q - q).amax() < 1e-5);
    for solution in near.clone() {
        // The cosine is known to a few roundings, its angle to the root of them.
        assert!(miss(&solution.q, &target) < 1e-7);
    }
    assert_eq!(near.count(), 2);
}

#[test]
fn out_of_reach_there_is_none() {
    let mut target = flange(&READY);
    target.translation.vector.x += 1.0;
    assert!(all(&target, 0.0).is_empty());
}

#[test]
fn input_that_means_nothing_is_refused() {
    let (model, ee, target) = (Model::fr3(), EndEffector::default(), flange(&READY));
    let error = |target, ee, q7| solve(model, target, ee, q7).expect_err("nonsense");
    assert_eq!(error(&target, &ee, f64::NAN), IkError::NotFinite);
    let mut nowhere = target;
    nowhere.translation.vector.z = f64::INFINITY;
    assert_eq!(error(&nowhere, &ee, 0.0), IkError::NotFinite);
    assert!(all(&nowhere, 0.0).is_empty());
    let flat = EndEffector {
        f_t_ee: Matrix4::zeros(),
        ..ee
    };
    assert_eq!(error(&target, &flat, 0.0), IkError::EndEffectorNotRigid);
}
