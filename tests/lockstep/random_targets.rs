//! Random reachable targets, one after the other.

use franka_lockstep::{Lockstep, pose_of, self_distance};
use franka_model::limits::JointLimits;
use franka_model::{EndEffector, JointVector, RobotKind};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{Lapse, PoseError, SELF_STOP, Target};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// Distance kept from the ends of the joints' ranges, `[rad]`, which leaves room for a straight
/// line between targets.
const MARGIN: f64 = 0.3;

#[test]
fn random_targets_are_reached_within_a_millimetre() {
    random_targets(RobotKind::Fr3);
}

#[test]
fn a_panda_reaches_them_as_well() {
    random_targets(RobotKind::Fer);
}

fn random_targets(kind: RobotKind) {
    let seed = 20;
    let mut random = SmallRng::seed_from_u64(seed);
    let limits = JointLimits::of(kind);
    let mut lockstep = Lockstep::ready_of(kind);
    let hand = EndEffector {
        f_t_ee: franka_sim::Tool::hand().f_t_ne,
        ..EndEffector::default()
    };
    let mut worst = PoseError::default();
    let mut blocked = 0;
    let cases = if franka_tests::thorough() { 200 } else { 16 };
    for case in 0..cases {
        // Joint targets lie anywhere in the ranges. A pose lies near the previous posture, on a
        // straight path.
        let anywhere = case % 2 == 0;
        let from = *lockstep.robot.q();
        let posture = loop {
            let posture = JointVector::from_fn(|i, _| {
                let (least, most) = (limits.lower[i] + MARGIN, limits.upper[i] - MARGIN);
                if anywhere {
                    random.random_range(least..most)
                } else {
                    (from[i] + random.random_range(-0.35..0.35)).clamp(least, most)
                }
            });
            // Targets in self-collision are skipped.
            if self_distance(&posture) > SELF_STOP {
                break posture;
            }
        };
        let target = pose_of(&posture, &hand);
        let goal = if anywhere {
            Target::Joints(posture.into())
        } else {
            Target::Pose(target)
        };
        let goal = lockstep.begin(goal);
        let report = match lockstep.until_resolved(goal, 60_000) {
            // The straight path collides with the arm itself.
            Err(MotionError::Braked(Lapse::Blocked { .. })) if anywhere => {
                let distance = self_distance(lockstep.robot.q());
                assert!(distance < SELF_STOP + 0.02, "{distance}");
                blocked += 1;
                continue;
            }
            outcome => outcome
                .unwrap_or_else(|error| panic!("{kind:?}, seed {seed}, case {case}: {error}")),
        };
        let error = PoseError::between(&lockstep.arm_pose(), &target);
        assert!(
            error.translation < 1e-3 && error.rotation < 2e-3,
            "{kind:?}, seed {seed}, case {case}: {error:?} after {:?}",
            report.duration
        );
        worst.translation = worst.translation.max(error.translation);
        worst.rotation = worst.rotation.max(error.rotation);
    }
    assert!(blocked < cases / 10, "{blocked} ways blocked");
    println!(
        "{kind:?}, seed {seed}: {blocked} ways blocked, worst {:.3} mm, {:.3} mrad",
        worst.translation * 1e3,
        worst.rotation * 1e3
    );
}
