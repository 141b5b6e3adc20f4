//! Motions under each law, and the force with which they press.

use franka_model::Wrench;
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::law::{Gains, Law};
use franka_rt::session::{ForceCap, Goal, Guard, OnArrival, PoseError, Target};
use franka_tests::lockstep::{Lockstep, for_each_robot};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

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
                    Translation3::from(home.translation.vector + nalgebra::Vector3::new(x, y, z)),
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
/// whether the cap bound. The floor dissipates no energy, so a light arm bounces on it for a while.
fn force_on_floor(gains: Gains, force_cap: ForceCap) -> (f64, bool) {
    let mut lockstep = tolerant(Lockstep::ready());
    let start = lockstep.arm_pose();
    let floor = start.translation.z - 0.04;
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
        let force = 3000.0 * (floor - lockstep.arm_pose().translation.z).max(0.0);
        if cycle >= 2000 {
            sum += force;
            bound |= lockstep.client.record.bindings.contains(Guard::ForceCap);
        }
        lockstep.robot.let_go();
        lockstep
            .robot
            .push_end_effector(Wrench::new(0.0, 0.0, force, 0.0, 0.0, 0.0), 2);
        lockstep.tick();
    }
    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Move);
    (sum / 1000.0, bound)
}

#[test]
fn an_arm_presses_on_an_obstacle_with_the_capped_force() {
    for gains in laws() {
        let (free, bound) = force_on_floor(gains, ForceCap::Off);
        assert!(free > 16.0 && !bound, "{gains:?}: {free} N without a cap");
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

/// A constant force keeps the arm from its target while the law changes, with and without a cap
/// that binds.
#[test]
fn a_change_of_law_or_cap_under_load_does_not_step_the_torque() {
    let mut lockstep = tolerant(Lockstep::ready());
    let home = lockstep.arm_pose();
    let goal = lockstep.goal(Target::Pose(home), OnArrival::Hold);
    lockstep.submit(goal).expect("the arm is there");
    lockstep.run(50);
    lockstep
        .robot
        .push_end_effector(Wrench::new(6.0, -5.0, 8.0, 0.0, 0.0, 0.0), 1_000_000);
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
