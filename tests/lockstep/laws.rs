//! Motions under each law, and the force with which they press.

use franka_lockstep::{Lockstep, for_each_robot};
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::law::{Gains, Law};
use franka_rt::session::{ForceCap, Goal, Guard, OnArrival, PoseError, Target};
use franka_sim::Touch;
use franka_tests::push::STIFFNESS;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

fn laws() -> [Gains; 3] {
    let projected = Gains {
        project_joint_gains: true,
        feedforward_cutoff: 50.0,
        ..Gains::cartesian()
    };
    let operational = Gains {
        law: Law::OperationalSpace,
        ..Gains::cartesian()
    };
    [Gains::droid(), projected, operational]
}

/// A robot whose collision thresholds tolerate the force of an obstacle.
fn tolerant(mut lockstep: Lockstep) -> Lockstep {
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
    lockstep
}

#[test]
fn poses_are_reached_under_every_law() {
    for_each_robot(|ready| {
        for gains in laws() {
            let mut lockstep = ready();
            let home = lockstep.arm_pose();
            for (x, y, z, turn) in [(0.1, 0.1, -0.05, 0.3), (-0.08, -0.15, 0.1, -0.3)] {
                let target = Isometry3::from_parts(
                    Translation3::from(home.translation.vector + Vector3::new(x, y, z)),
                    UnitQuaternion::from_euler_angles(turn, turn / 2.0, -turn) * home.rotation,
                );
                let goal = lockstep.goal(Target::Pose(target), OnArrival::ReportAndFinish);
                let id = lockstep
                    .submit(Goal { gains, ..goal })
                    .expect("within reach");
                lockstep
                    .until_resolved(id, 10_000)
                    .unwrap_or_else(|error| panic!("{gains:?}: {error}"));
                let error = PoseError::between(&lockstep.arm_pose(), &target);
                assert!(
                    error.translation < 1e-3 && error.rotation < 2e-3,
                    "{error:?}"
                );
            }
        }
    });
}

/// Returns the mean force on a soft floor in the arm's way, over the last of three seconds, and
/// true if the cap bound.
fn force_on_floor(gains: Gains, force_cap: ForceCap) -> (f64, bool) {
    let mut lockstep = tolerant(Lockstep::ready());
    let start = lockstep.arm_pose();
    let floor = start.translation.vector - Vector3::z() * 0.04;
    let floor = lockstep
        .robot
        .touch(Touch::wall(floor, Vector3::z()).stiffness(3000.0));
    let goal = lockstep.goal(
        Target::Pose(Translation3::new(0.0, 0.0, -0.1) * start),
        OnArrival::Hold,
    );
    let goal = Goal {
        gains,
        force_cap,
        ..goal
    };
    lockstep.submit(goal).expect("within reach");
    let (mut sum, mut bound) = (0.0, false);
    for cycle in 0..3000 {
        lockstep.tick();
        if cycle >= 2000 {
            let felt = lockstep.robot.felt(floor).expect("it has not ended");
            sum += felt.fixed_rows::<3>(0).norm();
            bound |= lockstep.client.record.bindings.contains(Guard::ForceCap);
        }
    }
    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Move);
    (sum / 1000.0, bound)
}

#[test]
fn an_arm_presses_on_an_obstacle_with_the_capped_force() {
    for gains in laws() {
        let (free, bound) = force_on_floor(gains, ForceCap::Off);
        assert!(free > 13.0 && !bound, "{gains:?}: {free} N without a cap");
        for cap in [6.0, 12.0] {
            let (force, bound) = force_on_floor(gains, ForceCap::Newtons(cap));
            println!("{free} N free, {force} N under {cap} N");
            assert!(bound, "{gains:?}");
            assert!(
                (0.95 * cap..1.1 * cap).contains(&force),
                "{gains:?}: {force} N under {cap} N"
            );
        }
    }
}

/// A hand holds the arm away from its target while the law changes, with and without a cap that
/// binds.
#[test]
fn a_change_of_law_or_cap_under_load_does_not_step_the_torque() {
    let mut lockstep = tolerant(Lockstep::ready());
    let home = lockstep.arm_pose();
    let goal = lockstep.goal(Target::Pose(home), OnArrival::Hold);
    lockstep.submit(goal).expect("the arm is there");
    lockstep.run(50);
    let from = home.translation.vector;
    let away = Vector3::new(8.0, -7.0, 11.0) * 1e-3;
    let path = move |t: f64| from + away * t.min(1.0);
    lockstep.robot.touch(Touch::carry(path, STIFFNESS));
    lockstep.run(1500);
    let mut steepest = 0.0_f64;
    let mut capped = 0;
    for round in 0..2 {
        for gains in laws().into_iter().chain([Gains::cartesian()]) {
            let goal = Goal {
                gains,
                force_cap: [ForceCap::Off, ForceCap::Newtons(10.5)][round],
                ..lockstep.goal(Target::Pose(home), OnArrival::Hold)
            };
            lockstep.submit(goal).expect("the arm is near");
            for _ in 0..700 {
                let before = lockstep.client.record.tau_c;
                lockstep.tick();
                let record = &lockstep.client.record;
                capped += u32::from(record.bindings.contains(Guard::ForceCap));
                for (now, before) in record.tau_c.iter().zip(before) {
                    steepest = steepest.max((now - before).abs());
                }
            }
        }
    }
    println!("steepest {steepest} N m in a cycle, cap bound in {capped} cycles");
    assert!(steepest < 0.15, "{steepest} N m in a cycle");
    assert!(capped > 100, "{capped}");
}
