//! The guards that act on targets: deviation and lead.

use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::Wrench;
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::{MotionError, Party, Tuning};
use franka_rt::session::{Guard, Lapse, Lead, OnArrival, PoseError, Target};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// A robot whose collision thresholds tolerate pushes.
fn tolerant(ready: &dyn Fn() -> Lockstep) -> Lockstep {
    let mut lockstep = ready();
    let behavior = CollisionBehavior::uniform([1000.0; 7], [1000.0; 7], [1000.0; 6], [1000.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(behavior));
    lockstep.run(5);
    lockstep
}

/// Pulls the arm aside against spring and damper, at constant velocity, until the deviation guard
/// binds: the arm must not swing back alone. Returns the distance, `[m]`.
fn pull_aside(lockstep: &mut Lockstep) -> f64 {
    let start = lockstep.arm_pose().translation.y;
    loop {
        let off = lockstep.arm_pose().translation.y - start;
        lockstep.robot.let_go();
        if lockstep.client.record.bindings.contains(Guard::Deviation) {
            return off;
        }
        assert!(off < 0.45, "{off} m aside");
        let pull = 60.0 - 100.0 * (lockstep.robot.dq().norm() - 0.3).max(0.0);
        let pull = Wrench::new(0.0, pull, 0.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(pull, 2);
        lockstep.tick();
        assert!(lockstep.now() < 30_000, "{off} m aside");
    }
}

#[test]
fn a_displaced_arm_stays_where_it_is_released() {
    for_each_robot(|ready| {
        for then in [OnArrival::ReportAndFinish, OnArrival::Hold] {
            let mut lockstep = tolerant(ready);
            let start = lockstep.arm_pose();
            let goal = lockstep.goal(Target::Pose(start), OnArrival::Hold);
            let id = lockstep.submit(goal).expect("it is there already");
            if then == OnArrival::ReportAndFinish {
                let up = Translation3::new(0.0, 0.0, 0.05) * start;
                assert_eq!(lockstep.update(id, Target::Pose(up)), Ok(true));
            }
            lockstep.run(100);
            let off = pull_aside(&mut lockstep);
            assert!(off > 0.2, "{off} m aside");
            let outcome = lockstep.until_resolved(id, 20_000);
            let displaced = MotionError::Braked(Lapse::Displaced);
            assert_eq!(displaced.party(), Party::Robot, "somebody pulls it");
            assert_eq!(outcome, Err(displaced));
            lockstep.run(500);
            let at = lockstep.arm_pose().translation.vector - start.translation.vector;
            assert!(at.y > off - 0.06, "from {off} m to {} m aside", at.y);
            let back = lockstep.begin(Target::Pose(start));
            lockstep.until_resolved(back, 10_000).expect("asked back");
        }
    });
}

const LEAD: Lead = Lead {
    translation: 0.05,
    rotation: 0.2,
    joints: 0.1,
};

#[test]
fn lead_bounds_the_motion_after_a_stream_stops() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let mut goal = lockstep.goal(Target::Pose(start), OnArrival::Hold);
        goal.lead = Some(LEAD);
        let id = lockstep.submit(goal).expect("it is there already");
        lockstep.run(100);
        assert!(!lockstep.client.record.bindings.contains(Guard::Lead));
        let wild = Translation3::new(0.0, 0.4, 0.0) * start;
        assert_eq!(lockstep.update(id, Target::Pose(wild)), Ok(true));
        lockstep.run(Lead::FRESH_MS + 1);
        assert!(lockstep.client.record.bindings.contains(Guard::Lead));
        let aside = |lockstep: &Lockstep| lockstep.arm_pose().translation.y - start.translation.y;
        let then = aside(&lockstep);
        lockstep.run(3000);
        let now = aside(&lockstep);
        assert!(
            now - then < LEAD.translation + 1e-3,
            "{then} m, then {now} m"
        );
        assert!(now > 0.03, "{now}");
        // While targets arrive, the arm keeps moving.
        for _ in 0..40 {
            let nearly = Translation3::new(1e-6 * lockstep.now() as f64, 0.0, 0.0) * wild;
            assert_eq!(lockstep.update(id, Target::Pose(nearly)), Ok(true));
            lockstep.run(100);
        }
        assert!(
            (aside(&lockstep) - 0.4).abs() < 5e-3,
            "{}",
            aside(&lockstep)
        );
        assert!(!lockstep.client.record.bindings.contains(Guard::Lead));
    });
}

#[test]
fn lead_unbounded_in_some_directions_binds_in_the_others() {
    for_each_robot(|ready| {
        let free = f64::INFINITY;
        for (translation, rotation) in [(0.05, free), (free, 0.2)] {
            let mut lockstep = ready();
            let start = lockstep.arm_pose();
            let mut goal = lockstep.goal(Target::Pose(start), OnArrival::Hold);
            goal.lead = Some(Lead {
                translation,
                rotation,
                joints: free,
            });
            let id = lockstep.submit(goal).expect("it is there already");
            lockstep.run(100);
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 0.5));
            let wild = if rotation == free {
                Translation3::new(0.0, 0.2, 0.0) * start
            } else {
                Isometry3::from_parts(start.translation, turn * start.rotation)
            };
            assert_eq!(lockstep.update(id, Target::Pose(wild)), Ok(true));
            lockstep.run(3000);
            let moved = PoseError::between(&lockstep.arm_pose(), &start);
            let (moved, most) = if rotation == free {
                (moved.translation, 0.2)
            } else {
                (moved.rotation, 0.5)
            };
            let lead = translation.min(rotation);
            assert!(moved > 0.9 * lead && moved < most - 0.5 * lead, "{moved}");
            assert!(lockstep.client.record.bindings.contains(Guard::Lead));
        }
    });
}

#[test]
fn tuning_does_not_send_back_a_displaced_arm() {
    for_each_robot(|ready| {
        let mut lockstep = tolerant(ready);
        let engaged = lockstep.engage();
        let start = lockstep.arm_pose();
        let goal = lockstep
            .within(engaged, Target::Pose(start), OnArrival::ReportAndHold)
            .expect("it is there already");
        lockstep.until_resolved(goal, 3000).expect("it is there");
        let off = pull_aside(&mut lockstep);
        assert!(off > 0.2, "{off} m aside");
        lockstep.run(3000);
        let at = lockstep.arm_pose();
        assert!(at.translation.y - start.translation.y > 0.2, "it is held");
        assert_eq!(lockstep.tune(engaged, Tuning::default()), Ok(()));
        lockstep.run(3000);
        let moved = PoseError::between(&lockstep.arm_pose(), &at);
        assert!(moved.translation < 5e-3, "{moved:?}");
    });
}
