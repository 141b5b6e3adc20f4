//! Random reachable targets, one after the other.

use franka_model::limits::JointLimits;
use franka_model::{EndEffector, JointVector, RobotKind};
use franka_rt::session::{PoseError, Target};
use franka_tests::lockstep::{Lockstep, pose_of};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// Distance kept from the ends of the joints' ranges, `[rad]`, so that a straight line between targets has room.
const MARGIN: f64 = 0.3;

#[test]
fn two_hundred_random_targets_are_reached_within_a_millimetre() {
    two_hundred_random_targets(RobotKind::Fr3);
}

#[test]
fn a_panda_reaches_them_as_well() {
    two_hundred_random_targets(RobotKind::Fer);
}

fn two_hundred_random_targets(kind: RobotKind) {
    let seed = 20;
    let mut random = SmallRng::seed_from_u64(seed);
    let limits = JointLimits::of(kind);
    let mut lockstep = Lockstep::ready_of(kind);
    let hand = EndEffector {
        f_t_ee: franka_sim::Tool::hand().f_t_ne,
        ..EndEffector::default()
    };
    let mut worst = PoseError::default();
    let mut posture = franka_model::READY;
    for case in 0..200 {
        // Joint targets lie anywhere in the ranges; a pose lies near the posture before it, a straight line away.
        let anywhere = case % 2 == 0;
        posture = JointVector::from_fn(|i, _| {
            let (from, to) = (limits.lower[i] + MARGIN, limits.upper[i] - MARGIN);
            if anywhere {
                random.random_range(from..to)
            } else {
                (posture[i] + random.random_range(-0.35..0.35)).clamp(from, to)
            }
        });
        let target = pose_of(&posture, &hand);
        let goal = if anywhere {
            Target::Joints(posture.into())
        } else {
            Target::Pose(target)
        };
        let goal = lockstep.begin(goal);
        let report = lockstep
            .until_resolved(goal, 30_000)
            .unwrap_or_else(|error| panic!("{kind:?}, seed {seed}, case {case}: {error}"));
        let error = PoseError::between(&lockstep.true_pose(), &target);
        assert!(
            error.translation < 1e-3 && error.rotation < 2e-3,
            "{kind:?}, seed {seed}, case {case}: {error:?} after {:?}",
            report.duration
        );
        worst.translation = worst.translation.max(error.translation);
        worst.rotation = worst.rotation.max(error.rotation);
    }
    println!(
        "{kind:?}, seed {seed}: worst {:.3} mm, {:.3} mrad",
        worst.translation * 1e3,
        worst.rotation * 1e3
    );
}
