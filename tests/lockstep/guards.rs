//! What the guards do that act on the way of the reference: clearance, deviation and lead.

use franka_model::collision::{Obstacle, Shape};
use franka_model::{JointVector, READY, Wrench};
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::driver::Activity;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{
    GoalId, Guard, KEEP_OUT_STOP, KeepOut, LEAD_FRESH_MS, Lapse, Lead, SELF_STOP, Target, Then,
};
use franka_tests::lockstep::{Lockstep, for_each_robot, self_distance};
use nalgebra::{Isometry3, Translation3, Vector3};

/// By how much less than the distance to keep there may be, `[m]`: the way to rest is looked at in two places.
const CURVE: f64 = 1e-4;

/// Bent forwards until the hand is in the base.
fn into_itself() -> Target {
    let mut q: [f64; 7] = READY.into();
    q[1] += 1.9;
    Target::Joints(q)
}

/// Runs until the goal is resolved, and tells the least that `room` was at the reference, and whether clearance bound.
fn least_room(
    lockstep: &mut Lockstep,
    goal: GoalId,
    room: impl Fn(&JointVector) -> f64,
) -> (f64, bool) {
    let (mut least, mut bound) = (f64::INFINITY, false);
    while lockstep.client.outcome(goal).is_none() {
        lockstep.tick();
        assert!(lockstep.now() < 60_000, "it is resolved");
        let record = &lockstep.client.record;
        if record.activity == Activity::Running {
            least = least.min(room(&record.q_ref.into()));
            bound |= record.bindings.contains(Guard::Clearance);
        }
    }
    (least, bound)
}

#[test]
fn an_arm_on_its_way_into_itself_slows_down_and_stops_before_it() {
    for_each_robot(|ready| {
        for speed in [0.5, 1.0, 1.5] {
            let mut lockstep = ready();
            let mut goal = lockstep.goal(into_itself(), Then::Finish);
            goal.budget = goal.budget.scaled(speed);
            let id = lockstep.submit(goal).expect("within the joints' ranges");
            let (least, bound) = least_room(&mut lockstep, id, self_distance);
            println!("speed {speed}: {:.2} mm", least * 1e3);
            assert!(
                bound && least >= SELF_STOP - CURVE,
                "speed {speed}: {least} m"
            );
            assert!(least < SELF_STOP + 0.01, "speed {speed}: {least} m");
            let outcome = lockstep.client.outcome(id);
            let blocked = Some(&Err(MotionError::Braked(Lapse::Blocked)));
            assert_eq!(outcome, blocked, "speed {speed}");
            assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
            // It is not trapped.
            let back = lockstep.begin(Target::Joints(READY.into()));
            lockstep.until_resolved(back, 10_000).expect("a way out");
        }
    });
}

/// A block whose top is at this height below the fingers of an arm in the ready pose.
fn block(top: f64) -> Obstacle {
    Obstacle::Box {
        pose: Isometry3::translation(0.31, 0.0, top - 0.05),
        half: Vector3::new(0.06, 0.1, 0.05),
    }
}

#[test]
fn a_hand_stays_out_of_a_region_and_leaves_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.true_pose();
        let kind = lockstep.robot.config().kind;
        let table = block(start.translation.z - 0.15);
        let mut regions = KeepOut::default();
        regions[2] = Some(table);
        lockstep.client.lifecycle.keep_out_of(regions);
        let room = |q: &JointVector| {
            let arm = Shape::covering(kind).with_hand().at(q);
            arm.nearest_to(&table).distance
        };
        let down = lockstep.begin(Target::Pose(Translation3::new(0.02, 0.0, -0.2) * start));
        let (least, bound) = least_room(&mut lockstep, down, room);
        println!("{:.2} mm", least * 1e3);
        assert!(bound && least >= KEEP_OUT_STOP - CURVE, "{least}");
        assert!(least < KEEP_OUT_STOP + 0.01, "{least}");
        let blocked = Some(&Err(MotionError::Braked(Lapse::Blocked)));
        assert_eq!(lockstep.client.outcome(down), blocked);
        let up = lockstep.begin(Target::Pose(start));
        lockstep.until_resolved(up, 10_000).expect("a way out");

        // An arm that stands in a region may only leave it.
        regions[2] = Some(block(start.translation.z - 0.01));
        lockstep.client.lifecycle.keep_out_of(regions);
        let down = lockstep.begin(Target::Pose(Translation3::new(0.0, 0.0, -0.02) * start));
        let outcome = lockstep.until_resolved(down, 20_000);
        assert_eq!(outcome, Err(MotionError::Braked(Lapse::Blocked)));
        let up = lockstep.begin(Target::Pose(Translation3::new(0.0, 0.0, 0.1) * start));
        lockstep.until_resolved(up, 10_000).expect("a way out");
    });
}

/// A robot whose collision thresholds let anybody push.
fn tolerant(ready: &dyn Fn() -> Lockstep) -> Lockstep {
    let mut lockstep = ready();
    let behavior = CollisionBehavior::uniform([1000.0; 7], [1000.0; 7], [1000.0; 6], [1000.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(behavior));
    lockstep.run(5);
    lockstep
}

#[test]
fn an_arm_that_is_carried_off_stays_where_it_is_let_go() {
    for_each_robot(|ready| {
        for then in [Then::Finish, Then::Hold] {
            let mut lockstep = tolerant(ready);
            let start = lockstep.true_pose();
            let goal = lockstep.goal(Target::Pose(start), Then::Hold);
            let id = lockstep.submit(goal).expect("it is there already");
            if then == Then::Finish {
                let up = Translation3::new(0.0, 0.0, 0.05) * start;
                assert_eq!(lockstep.update(id, Target::Pose(up)), Ok(true));
            }
            lockstep.run(100);
            // Pulled aside against spring and damper, at a steady pace.
            let mut off = 0.0;
            while lockstep.client.outcome(id).is_none() && off < 0.45 {
                lockstep.robot.let_go();
                let at = lockstep.true_pose().translation.vector - start.translation.vector;
                off = at.y;
                let pull = 60.0 - 100.0 * (lockstep.robot.dq().norm() - 0.3).max(0.0);
                lockstep
                    .robot
                    .push_end_effector(Wrench::new(0.0, pull, 0.0, 0.0, 0.0, 0.0), 2);
                lockstep.tick();
                assert!(lockstep.now() < 30_000, "{off} m aside");
                if lockstep.client.record.bindings.contains(Guard::Deviation) {
                    break;
                }
            }
            assert!(off > 0.2, "{off} m aside");
            lockstep.robot.let_go();
            let outcome = lockstep.until_resolved(id, 20_000);
            assert_eq!(outcome, Err(MotionError::Braked(Lapse::CarriedOff)));
            lockstep.run(500);
            let at = lockstep.true_pose().translation.vector - start.translation.vector;
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
fn a_wild_target_sends_the_arm_no_further_than_the_lead_once_the_stream_stops() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.true_pose();
        let mut goal = lockstep.goal(Target::Pose(start), Then::Hold);
        goal.lead = Some(LEAD);
        let id = lockstep.submit(goal).expect("it is there already");
        lockstep.run(100);
        assert!(!lockstep.client.record.bindings.contains(Guard::Lead));
        let wild = Translation3::new(0.0, 0.4, 0.0) * start;
        assert_eq!(lockstep.update(id, Target::Pose(wild)), Ok(true));
        lockstep.run(LEAD_FRESH_MS + 1);
        assert!(lockstep.client.record.bindings.contains(Guard::Lead));
        let aside = |lockstep: &Lockstep| lockstep.true_pose().translation.y - start.translation.y;
        let then = aside(&lockstep);
        lockstep.run(3000);
        let now = aside(&lockstep);
        assert!(
            now - then < LEAD.translation + 1e-3,
            "{then} m, then {now} m"
        );
        assert!(now > 0.03, "{now}");
        // As long as targets come, it goes on.
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
