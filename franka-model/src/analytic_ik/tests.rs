use super::*;
use crate::random::Random;
use crate::{Frame, JointVector, READY, RobotKind, elbow, rotation};
use core::f64::consts::{FRAC_PI_2, TAU};
use nalgebra::{Matrix4, Translation3, Vector3};

/// Number of poses per robot and parameter. With `--release`, it is the number that the docs state.
const CASES: usize = if cfg!(debug_assertions) {
    2_000
} else {
    100_000
};

pub(super) fn flange(q: &JointVector) -> Isometry3<f64> {
    let pose = Model::fr3().pose(Frame::Flange, q, &EndEffector::default());
    transform::isometry(&pose).expect("a rigid frame")
}

/// Returns the larger of the distances between the flange at `q` and `target`, in metres and
/// radians.
pub(super) fn miss(q: &JointVector, target: &Isometry3<f64>) -> f64 {
    let reached = flange(q);
    let distance = (reached.translation.vector - target.translation.vector).norm();
    distance.max(rotation::error(&target.rotation, &reached.rotation).norm())
}

fn branch(q: &JointVector) -> Branch {
    Branch {
        elbow: q[3] > elbow::FLIP_ANGLE,
        wrist: q[4].cos() > 0.0,
        shoulder: q[1] < 0.0,
    }
}

/// A redundancy parameter, and the function that computes it from a posture.
type Parameter = (Redundancy, fn(&JointVector) -> f64);

/// Returns the parameters of all kinds for a posture.
fn parameters(q: &JointVector) -> [Parameter; 3] {
    let swivel = |q: &JointVector| elbow::swivel(&Lengths::DESCRIBED, q).expect("defined");
    [
        (Redundancy::Joint7(q[6]), |q| q[6]),
        (Redundancy::Joint4(q[3]), |q| q[3]),
        (Redundancy::Swivel(swivel(q)), swivel),
    ]
}

/// Returns the difference between the redundancy parameter of posture `q` and the given parameter.
fn parameter_miss(q: &JointVector, given: Redundancy, of: fn(&JointVector) -> f64) -> f64 {
    let (Redundancy::Joint7(angle) | Redundancy::Joint4(angle) | Redundancy::Swivel(angle)) = given;
    let off = of(q) - angle;
    (off - TAU * (off / TAU).round()).abs()
}

#[test]
fn solutions_meet_pose_and_limits_and_include_the_seed() {
    for kind in RobotKind::ALL {
        let model = Model::of(kind);
        let limits = model.joint_limits();
        let mut random = Random::new(81);
        for case in 0..CASES {
            let q = random.posture(model);
            let target = flange(&q);
            for (given, of) in parameters(&q) {
                let found = solve(model, &target, &EndEffector::default(), given);
                let found = found.expect("finite");
                for solution in found.iter() {
                    let miss = miss(&solution.q, &target);
                    assert!(miss < 1e-12, "{kind:?} {case} {given:?}: {miss:e}");
                    assert!(limits.contains(&solution.q));
                    assert_eq!(solution.branch, branch(&solution.q), "{case} {given:?}");
                    let off = parameter_miss(&solution.q, given, of);
                    // The wrist may be only a few micrometres off axis 1; rounding then limits the
                    // precision of the swivel angle.
                    assert!(off < 1e-7, "{kind:?} {case} {given:?}: {off:e} rad");
                }
                // Near a double root, the error of an angle is the square root of the rounding
                // error.
                let seed = found
                    .nearest(&q)
                    .unwrap_or_else(|| panic!("{case} {given:?}"));
                let off = (seed.q - q).amax();
                assert!(
                    off < 2e-6,
                    "{kind:?} {case} {given:?}: {off:e} from the seed"
                );
            }
        }
    }
}

#[test]
fn joint_7_gives_none_four_or_eight_solutions() {
    let mut random = Random::new(82);
    for _ in 0..2_000 {
        let target = flange(&random.posture(Model::fr3()));
        let real = all(
            &Lengths::DESCRIBED,
            &target,
            Redundancy::Joint7(random.uniform(-PI, PI)),
        );
        assert!([0, 4, 8].contains(&real.len()), "{} solutions", real.len());
        assert!(
            real.iter()
                .all(|solution| miss(&solution.q, &target) < 1e-12)
        );
    }
}

/// Counts how often the swivel angle passes `angle` while joint 7 moves through its range, for all
/// branches. The count does not use the solver's equation.
fn count_by_scanning(target: &Isometry3<f64>, angle: f64, steps: u32) -> usize {
    let mut last: [Option<f64>; 8] = [None; 8];
    let mut count = 0;
    for step in 0..=steps {
        let q7 = -PI + TAU * f64::from(step) / f64::from(steps);
        let mut now = [None; 8];
        for solution in all(&Lengths::DESCRIBED, target, Redundancy::Joint7(q7)).iter() {
            let index = solution.branch.index();
            let off = elbow::swivel(&Lengths::DESCRIBED, &solution.q).map(|found| found - angle);
            now[index] = off.map(|off| off - TAU * (off / TAU).round());
        }
        for (before, after) in last.iter().zip(&now) {
            if let (Some(before), Some(after)) = (before, after) {
                let passes = (*before > 0.0) != (*after > 0.0);
                count += usize::from(passes && (before - after).abs() < 1.0);
            }
        }
        last = now;
    }
    count
}

#[test]
fn swivel_solutions_match_a_scan_of_joint_7() {
    let mut random = Random::new(83);
    let (mut fewer, mut total) = (0, 0);
    for _ in 0..60 {
        let target = flange(&random.posture(Model::fr3()));
        let angle = random.uniform(-PI, PI);
        let found = all(&Lengths::DESCRIBED, &target, Redundancy::Swivel(angle)).len();
        let scanned = count_by_scanning(&target, angle, 20_000);
        // A scan misses roots between its last step and the end of a branch.
        assert!(scanned <= found, "{scanned} scanned, {found} found");
        fewer += found - scanned;
        total += found;
    }
    assert!(total > 300 && fewer * 50 < total, "{fewer} of {total}");
}

#[test]
fn the_ready_pose_has_eight_solutions_and_one_within_the_limits() {
    let (target, given) = (flange(&READY), Redundancy::Joint7(READY[6]));
    assert_eq!(all(&Lengths::DESCRIBED, &target, given).len(), 8);
    for kind in RobotKind::ALL {
        let model = Model::of(kind);
        let found = solve(model, &target, &EndEffector::default(), given);
        let found = found.expect("finite");
        assert_eq!(found.len(), 1);
        assert!((found[0].q - READY).amax() < 1e-13);
        let limits = model.joint_limits();
        assert_eq!(found[0].limit_margin(limits), READY[3] - limits.lower[3]);
        let singularity = found[0].singularity();
        let expected = (
            FRAC_PI_2 / 2.0,
            FRAC_PI_2,
            -1.5 * FRAC_PI_2 - elbow::FLIP_ANGLE,
        );
        assert!((singularity.shoulder - expected.0).abs() < 1e-13);
        assert!((singularity.wrist - expected.1).abs() < 1e-13);
        assert!((singularity.elbow - expected.2.abs()).abs() < 1e-13);
        assert_eq!(singularity.least(), singularity.shoulder);
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
    let q = READY + JointVector::from_fn(|i, _| 0.1 * i as f64);
    let target = flange(&q) * tool;
    for (given, _) in parameters(&q) {
        let found = solve(Model::fr3(), &target, &ee, given).expect("finite");
        let off = (found.nearest(&q).expect("one").q - q).amax();
        assert!(off < 1e-9, "{given:?}: {off:e}");
    }
}

#[test]
fn with_joint_2_at_zero_joints_1_and_3_share_the_turn_and_slide() {
    let mut q = READY;
    (q[0], q[1], q[2]) = (0.3, 0.0, 0.5);
    let limits = Model::fr3().joint_limits();
    let target = flange(&q);
    for (given, _) in &parameters(&q)[..2] {
        let found = all(&Lengths::DESCRIBED, &target, *given).within(&limits.lower, &limits.upper);
        // Rounding leaves a sine of about 1e-16, or zero.
        let half = found.iter().find(|s| (s.q[0] - 0.4).abs() < 1e-12);
        let half = half.expect("a solution");
        assert!((half.q[2] - 0.4).abs() < 1e-12);
        assert!(miss(&half.q, &target) < 1e-12);
        let [back, on] = half.slide.expect("in line");
        for step in [back, on] {
            let mut slid = half.q;
            slid[0] += step;
            slid[2] -= step;
            assert!(miss(&slid, &target) < 1e-12);
            let margin = (slid - limits.lower).inf(&(limits.upper - slid)).min();
            assert!(
                margin.abs() < 1e-12,
                "the slide ends at a limit: {margin:e}"
            );
        }
        let nearest = found.nearest(&q).expect("a solution");
        assert!((nearest.q - q).amax() < 1e-12);
    }
}

#[test]
fn turn_of_joints_1_and_3_is_shared_within_the_limits() {
    let limits = Model::fr3().joint_limits();
    let mut q = READY;
    (q[0], q[1], q[2]) = (limits.upper[0] - 0.01, 0.0, limits.upper[2] - 0.01);
    let target = flange(&q);
    let found = all(&Lengths::DESCRIBED, &target, Redundancy::Joint7(q[6]))
        .within(&limits.lower, &limits.upper);
    let nearest = found.nearest(&q).expect("the posture itself");
    assert!((nearest.q - q).amax() < 1e-12);
    assert!(found.iter().all(|solution| limits.contains(&solution.q)));
}

#[test]
fn path_through_the_shoulder_singularity_does_not_jump() {
    // Joint 2 passes through zero, and the other joints move evenly.
    let at = |step: i32| {
        let share = f64::from(step) * 1e-3;
        let mut q = READY + JointVector::repeat(0.2 * share);
        q[1] = 0.1 * share;
        q
    };
    let mut last = at(-101);
    for step in -100..=100 {
        let q = at(step);
        let target = flange(&q);
        let found = all(&Lengths::DESCRIBED, &target, Redundancy::Joint7(q[6]));
        let nearest = found.nearest(&last).expect("a solution");
        assert!(miss(&nearest.q, &target) < 1e-12);
        assert!((nearest.q - last).amax() < 3e-4, "step {step}");
        assert!((nearest.q - q).amax() < 1e-9, "step {step}");
        last = nearest.q;
    }
}

#[test]
fn near_joint_2_at_zero_poses_are_met_all_the_same() {
    let mut random = Random::new(84);
    for exponent in 3..16 {
        for _ in 0..100 {
            let mut q = random.posture(Model::fr3());
            q[1] = 10f64.powi(-exponent);
            let target = flange(&q);
            for (given, _) in parameters(&q) {
                for solution in all(&Lengths::DESCRIBED, &target, given).iter() {
                    assert!(miss(&solution.q, &target) < 1e-12, "{exponent} {given:?}");
                }
            }
        }
    }
}

#[test]
fn solutions_merge_as_square_roots_at_elbow_and_wrist() {
    let fold = |index: usize, place: f64| {
        let mut last: Option<f64> = None;
        for exponent in 1..8 {
            let gap = 10f64.powi(-exponent);
            let mut q = READY;
            q[index] = place - gap;
            let target = flange(&q);
            let found = all(&Lengths::DESCRIBED, &target, Redundancy::Joint7(q[6]));
            // The two solutions are the posture and its mirror image beyond the fold.
            let near = found.iter().filter(|s| (s.q - q).amax() < 8.0 * gap);
            assert_eq!(near.clone().count(), 2, "joint {index}, {gap:e}");
            assert!(near.clone().all(|s| miss(&s.q, &target) < 1e-12));
            let mirrored = near.map(|s| s.q[index] - place).fold(f64::MIN, f64::max);
            assert!((mirrored / gap - 1.0).abs() < 0.3 && mirrored < last.unwrap_or(1.0));
            last = Some(mirrored);
        }
        let mut q = READY;
        q[index] = place;
        let target = flange(&q);
        let found = all(&Lengths::DESCRIBED, &target, Redundancy::Joint7(q[6]));
        let near = found.iter().filter(|s| (s.q - q).amax() < 3e-6);
        assert!(near.clone().all(|s| miss(&s.q, &target) < 2e-12));
        assert_eq!(near.count(), 2, "on the fold of joint {index}");
    };
    fold(3, elbow::FLIP_ANGLE);
    fold(4, FRAC_PI_2);
}

#[test]
fn with_the_shoulder_on_axis_7_joint_4_leaves_joint_7_at_zero() {
    // The flange is straight above the shoulder, and its axis points down through the shoulder.
    let down = rotation::exp(&(Vector3::x() * PI));
    let pose = Isometry3::from_parts(Translation3::new(0.0, 0.0, 0.333 + 0.6), down);
    // The wrist then has the same distance for every angle of joint 7.
    let posture = all(&Lengths::DESCRIBED, &pose, Redundancy::Joint7(1.0))[0].q;
    let found = all(&Lengths::DESCRIBED, &pose, Redundancy::Joint4(posture[3]));
    assert!(!found.is_empty());
    for solution in found.iter() {
        assert_eq!(solution.q[6], 0.0);
        assert!(miss(&solution.q, &pose) < 1e-12);
    }
}

#[test]
fn nearest_posture_is_no_further_than_the_known_one() {
    let mut random = Random::new(85);
    let (model, ee) = (Model::fr3(), EndEffector::default());
    let mut further = 0;
    for _ in 0..200 {
        let q = random.posture(model);
        let from = q + random.joints(0.3);
        let target = flange(&q);
        let found = nearest(model, &target, &ee, &from).expect("finite");
        let found = found.expect("the posture itself is one");
        assert!(model.joint_limits().contains(&found.q));
        assert!(miss(&found.q, &target) < 1e-12);
        // A sweep misses narrow minima.
        further += usize::from((found.q - from).norm() > (q - from).norm() + 1e-6);
        // If the reference posture itself reaches the pose, it is the nearest posture.
        let same = nearest(model, &target, &ee, &q)
            .expect("finite")
            .expect("one");
        assert!((same.q - q).amax() < 2e-6);
    }
    assert!(further <= 2, "{further} of 200");
    let mut nowhere = flange(&READY);
    nowhere.translation.vector.x = 2.0;
    assert_eq!(nearest(model, &nowhere, &ee, &READY), Ok(None));
}

#[test]
fn out_of_reach_there_is_none() {
    let mut target = flange(&READY);
    target.translation.vector.x += 1.0;
    for (given, _) in parameters(&READY) {
        assert!(all(&Lengths::DESCRIBED, &target, given).is_empty());
    }
}

#[test]
fn input_that_means_nothing_is_refused() {
    let (model, ee, target) = (Model::fr3(), EndEffector::default(), flange(&READY));
    let error = |target, ee, given| solve(model, target, ee, given).expect_err("nonsense");
    let mut nowhere = target;
    nowhere.translation.vector.z = f64::INFINITY;
    let flat = EndEffector {
        f_t_ee: Matrix4::zeros(),
        ..ee
    };
    for kind in [Redundancy::Joint7, Redundancy::Joint4, Redundancy::Swivel] {
        assert_eq!(error(&target, &ee, kind(f64::NAN)), IkError::NotFinite);
        assert_eq!(error(&nowhere, &ee, kind(0.5)), IkError::NotFinite);
        assert!(all(&Lengths::DESCRIBED, &nowhere, kind(-0.5)).is_empty());
        assert!(all(&Lengths::DESCRIBED, &target, kind(f64::INFINITY)).is_empty());
        assert_eq!(
            error(&target, &flat, kind(0.0)),
            IkError::EndEffectorNotRigid
        );
    }
}

#[test]
fn solutions_with_other_lengths_meet_their_own_poses() {
    let model = Model::fr3().clone().with_lengths(Lengths::RECORDED_FR3);
    let limits = model.joint_limits();
    let mut random = Random::new(83);
    for _ in 0..200 {
        let q = random.posture(&model);
        let at = |q: &JointVector| {
            let pose = model.pose(Frame::Flange, q, &EndEffector::default());
            transform::isometry(&pose).expect("a rigid frame")
        };
        let target = at(&q);
        let swivel = elbow::swivel(model.lengths(), &q).expect("defined");
        for given in [
            Redundancy::Joint7(q[6]),
            Redundancy::Joint4(q[3]),
            Redundancy::Swivel(swivel),
        ] {
            let found = solve(&model, &target, &EndEffector::default(), given).expect("finite");
            let near = |solution: &Solution| (solution.q - q).amax() < 1e-6;
            assert!(found.iter().any(near), "{given:?} at {q}");
            for solution in found.iter() {
                assert!(limits.contains(&solution.q));
                let off = at(&solution.q).translation.vector - target.translation.vector;
                assert!(off.norm() < 2e-9, "{given:?}: {off}");
            }
        }
    }
}
