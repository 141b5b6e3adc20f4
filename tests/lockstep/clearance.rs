//! Arms that stay clear of themselves and of regions: they slow down on approach and never come too
//! near.

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot, self_distance};
use franka_model::collision::{Obstacle, Shape};
use franka_model::{JointVector, READY, RobotKind};
use franka_otg::AxisLimits;
use franka_proto::RobotMode;
use franka_rt::driver::Activity;
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{
    Chunk, GoalId, Guard, KEEP_OUT_STOP, KeepOut, Lapse, OnArrival, SELF_STOP, Target,
};
use nalgebra::{Isometry3, Translation3, Vector3};

/// Largest shortfall of the distance, `[m]`: the braking path is checked at two points only.
const CURVE: f64 = 1e-4;

/// The same for braking at 6 rad/s^2, where the joints stop one after the other.
const QUICK_CURVE: f64 = 1e-3;

/// A posture bent forwards, with the hand in the base.
fn into_itself() -> Target {
    let mut q: [f64; 7] = READY.into();
    q[1] += 1.9;
    Target::Joints(q)
}

/// Runs until the goal is resolved. Returns the smallest `margin` at the reference, and true if
/// clearance bound.
fn least_room(
    lockstep: &mut Lockstep,
    goal: GoalId,
    margin: impl Fn(&JointVector) -> f64,
) -> (f64, bool) {
    let (mut least, mut bound) = (f64::INFINITY, false);
    while lockstep.client.outcome(goal).is_none() {
        lockstep.tick();
        assert!(lockstep.now() < 60_000, "it is resolved");
        let record = &lockstep.client.record;
        if record.activity == Activity::Running {
            least = least.min(margin(&record.q_ref.into()));
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
            let mut goal = lockstep.goal(into_itself(), OnArrival::ReportAndFinish);
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
            let blocked = Some(&Err(MotionError::Braked(Lapse::Blocked { region: None })));
            assert_eq!(outcome, blocked, "speed {speed}");
            assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
            // The arm can leave again.
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

/// The distance of arm and Hand from a region, `[m]`.
fn room_to(kind: RobotKind, region: &Obstacle, q: &JointVector) -> f64 {
    let arm = Shape::covering(kind).with_hand().at(q);
    arm.nearest_to(region).distance
}

#[test]
fn a_hand_stays_out_of_a_region_and_leaves_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let kind = lockstep.robot.config().kind;
        let table = block(start.translation.z - 0.15);
        let mut regions = KeepOut::default();
        regions[0] = Some(Obstacle::floor(-1.0));
        regions[2] = Some(table);
        lockstep.client.lifecycle.keep_out_of(regions);
        let margin = |q: &JointVector| room_to(kind, &table, q);
        let down = lockstep.begin(Target::Pose(Translation3::new(0.02, 0.0, -0.2) * start));
        let (least, bound) = least_room(&mut lockstep, down, margin);
        println!("{:.2} mm", least * 1e3);
        assert!(bound && least >= KEEP_OUT_STOP - CURVE, "{least}");
        assert!(least < KEEP_OUT_STOP + 0.01, "{least}");
        let blocked = Err(MotionError::Braked(Lapse::Blocked { region: Some(2) }));
        assert_eq!(lockstep.client.outcome(down), Some(&blocked));
        let up = lockstep.begin(Target::Pose(start));
        lockstep.until_resolved(up, 10_000).expect("a way out");

        // An arm inside a region may only leave it.
        regions[2] = Some(block(start.translation.z - 0.01));
        lockstep.client.lifecycle.keep_out_of(regions);
        let down = lockstep.begin(Target::Pose(Translation3::new(0.0, 0.0, -0.02) * start));
        let outcome = lockstep.until_resolved(down, 20_000);
        assert_eq!(outcome, blocked);
        let up = lockstep.begin(Target::Pose(Translation3::new(0.0, 0.0, 0.1) * start));
        lockstep.until_resolved(up, 10_000).expect("a way out");
    });
}

/// An engaged arm above a table 0.12 m below the hand, which its session keeps out of; and a
/// function that returns the distance left.
fn above_a_table(ready: &dyn Fn() -> Lockstep) -> (Lockstep, GoalId, impl Fn(&Lockstep) -> f64) {
    let mut lockstep = ready();
    let table = block(lockstep.arm_pose().translation.z - 0.12);
    let kind = lockstep.robot.config().kind;
    let engaged = lockstep.engage_with(Engagement {
        keep_out: Some(vec![table]),
        ..Engagement::default()
    });
    let margin = move |lockstep: &Lockstep| {
        let q = lockstep.client.record.q_ref;
        room_to(kind, &table, &q.into()) - KEEP_OUT_STOP
    };
    (lockstep, engaged, margin)
}

/// A policy that would go through the table, with a new prediction every 60 ms.
#[test]
fn successive_chunks_come_no_nearer_than_one_does() {
    for_each_robot(|ready| {
        for joints in [false, true] {
            let (mut lockstep, engaged, margin) = above_a_table(ready);
            let start = lockstep.arm_pose();
            let mut least = f64::INFINITY;
            let mut bound = 0;
            for call in 0..50_u32 {
                let points = (0..8_u32).map(|point| {
                    let offset = Duration::from_millis(60) * point;
                    let time = (Duration::from_millis(60) * call + offset).as_secs_f64();
                    (offset, (0.15 * time).min(0.25))
                });
                let chunk = if joints {
                    let bent = |down: f64| {
                        let mut q = READY;
                        q[1] += 2.0 * down;
                        <[f64; 7]>::from(q)
                    };
                    Chunk::joints(points.map(|(offset, down)| (offset, bent(down))))
                } else {
                    let below = |down: f64| Translation3::new(0.0, 0.0, -down) * start;
                    Chunk::poses(points.map(|(offset, down)| (offset, below(down))))
                };
                let chunk = chunk.expect("points 60 ms apart");
                lockstep
                    .chunk(engaged, chunk)
                    .expect("points in the ranges of the joints");
                for _ in 0..60 {
                    lockstep.tick();
                    least = least.min(margin(&lockstep));
                    let bindings = lockstep.client.record.bindings;
                    bound += u32::from(bindings.contains(Guard::Clearance));
                }
            }
            println!("{:.2} mm left, bound in {bound} cycles", least * 1e3);
            assert!((-CURVE..0.02).contains(&least), "{least} m left");
            assert!(bound > 500, "{bound}");
            // The arm can leave again.
            let up = lockstep.within(engaged, Target::Pose(start), OnArrival::ReportAndHold);
            lockstep
                .until_resolved(up.expect("a way out"), 10_000)
                .expect("it leaves");
        }
    });
}

/// A goal with a slow budget supersedes a fast one on its way to the table: braking within the slow
/// budget would require a far longer distance.
#[test]
fn a_gentler_goal_that_takes_over_comes_no_nearer() {
    for_each_robot(|ready| {
        for target in [None, Some(-0.3)] {
            let mut least = f64::INFINITY;
            for after in (300..700).step_by(20) {
                let (mut lockstep, engaged, margin) = above_a_table(ready);
                let start = lockstep.arm_pose();
                let below = |z: f64| Target::Pose(Translation3::new(0.0, 0.0, z) * start);
                let mut quick = lockstep.goal(below(-0.3), OnArrival::ReportAndHold);
                quick.budget = quick.budget.scaled(1.5);
                for joint in &mut quick.budget.joints {
                    *joint = AxisLimits {
                        acceleration: 6.0,
                        jerk: 600.0,
                        ..*joint
                    };
                }
                lockstep.submit_within(engaged, quick).expect("a quick one");
                lockstep.run(after);
                let mut gentle =
                    lockstep.goal(target.map_or(Target::Rest, below), OnArrival::ReportAndHold);
                gentle.budget = gentle.budget.scaled(0.2);
                lockstep
                    .submit_within(engaged, gentle)
                    .expect("a gentle one");
                for _ in 0..1500 {
                    lockstep.tick();
                    least = least.min(margin(&lockstep));
                }
            }
            println!("{:.2} mm left", least * 1e3);
            assert!((-QUICK_CURVE..0.02).contains(&least), "{least} m left");
        }
    });
}

#[test]
fn stream_waits_before_a_region_for_a_reachable_target() {
    for_each_robot(|ready| {
        let (mut lockstep, engaged, margin) = above_a_table(ready);
        let start = lockstep.arm_pose();
        let below = Translation3::new(0.0, 0.0, -0.2) * start;
        let stream = lockstep.within(engaged, below.into(), OnArrival::Hold);
        let stream = stream.expect("a goal");
        lockstep.run(8000);
        let record = &lockstep.client.record;
        let speed = JointVector::from(record.dq_ref).amax();
        assert!(record.bindings.contains(Guard::Clearance) && speed < 1e-3);
        assert!((-CURVE..0.01).contains(&margin(&lockstep)));
        assert_eq!(lockstep.client.outcome(stream), None);

        let up = lockstep.within(engaged, start.into(), OnArrival::ReportAndHold);
        lockstep
            .until_resolved(up.expect("a goal"), 10_000)
            .expect("a way out");
    });
}
