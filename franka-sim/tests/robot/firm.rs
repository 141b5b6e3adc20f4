//! Firm touches on every family of arms, on every plant. An arm at rest must stay at rest.

use franka_model::{Frame, READY, Wrench};
use nalgebra::Vector3;

use crate::pair::*;
use crate::plants::robots;
use franka_sim::arm::Family;
use franka_sim::config::Tool;
use franka_sim::{Arm, Touch};

/// Calls `test` for the ideal arm, the central arm of each family with elastic joints, and some
/// random arms of each family. Each arm is tested with and without a Hand, and in a different pose.
/// The text describes the arm.
fn for_each_arm(seeds: u64, test: impl Fn(&str, &mut Pair)) {
    let families = [("realistic", Family::realistic()), ("bad", Family::bad())];
    let mut poses = poses().into_iter().cycle();
    for (tool, tool_name) in [(Tool::NONE, "bare"), (Tool::hand(), "Hand")] {
        let config = Config {
            tool,
            ..Config::default()
        };
        let mut run = |arm_name: &str, arm: &dyn Fn(RobotKind) -> Arm| {
            for (name, mut pair) in robots(&config) {
                pair.robot.fit(arm(pair.robot.config().kind));
                let (pose, q) = poses.next().expect("a cycle");
                pair.robot.place(&q);
                pair.idle(300);
                let name = format!("{name}, {tool_name}, {arm_name}, {pose}");
                test(&name, &mut pair);
            }
        };
        run("ideal", &Arm::ideal);
        for (family_name, family) in &families {
            run(family_name, &|kind| Arm::central(kind, family));
            for seed in 0..seeds {
                run(&format!("{family_name} {seed}"), &|kind| {
                    Arm::sample(kind, seed, family)
                });
            }
        }
    }
}

fn poses() -> [(&'static str, JointVector); 5] {
    let near = |off: [f64; 7]| READY + JointVector::from(off);
    [
        ("ready", READY),
        ("turned", near([0.6, 0.2, -0.4, 0.3, 0.5, 0.3, 0.7])),
        ("high", near([-0.4, -0.5, 0.2, 0.6, -0.3, 0.4, -0.9])),
        ("stretched", near([0.2, 0.4, 0.3, 1.3, 0.2, 0.6, 0.2])),
        ("folded", near([0.0, -0.4, 0.5, -0.3, -0.6, -0.2, 1.2])),
    ]
}

/// Waits, and asserts that nothing happens. An instability would show within milliseconds.
fn assert_still(name: &str, pair: &mut Pair) {
    let before = *pair.robot.q();
    let (mut fastest, mut farthest) = (0.0_f64, 0.0_f64);
    for _ in 0..300 {
        pair.tick(None);
        fastest = fastest.max(pair.robot.dq().amax());
        farthest = farthest.max((pair.robot.q() - before).amax());
    }
    assert_fine(name, pair);
    assert!(fastest < 0.01, "{name}: {fastest} rad/s");
    assert!(farthest < 1e-3, "{name}: {farthest} rad");
}

fn assert_fine(name: &str, pair: &Pair) {
    assert_eq!(pair.state.errors, Errors::default(), "{name}");
    assert_eq!(pair.state.robot_mode, RobotMode::Idle, "{name}");
}

fn end_effector(pair: &Pair) -> Vector3<f64> {
    pair.robot.true_pose().translation.vector
}

#[test]
fn a_still_arm_stays_still_in_every_firm_grip() {
    for_each_arm(1, |name, pair| {
        for frame in [Frame::EndEffector, Frame::Flange, Frame::Joint4] {
            pair.robot.touch(Touch::hold().at(frame));
            assert_still(&format!("{name}, {frame:?}"), pair);
            pair.robot.let_go();
            pair.idle(50);
        }
    });
}

#[test]
fn a_still_arm_stays_still_while_any_joint_or_all_are_blocked() {
    for_each_arm(0, |name, pair| {
        for joint in 1..=7 {
            pair.robot.touch(Touch::block(joint));
            assert_still(&format!("{name}, joint {joint}"), pair);
            pair.robot.let_go();
        }
        (1..=7).for_each(|joint| _ = pair.robot.touch(Touch::block(joint)));
        assert_still(&format!("{name}, all joints"), pair);
    });
}

#[test]
fn a_still_arm_stays_still_in_the_stiffest_grip() {
    for_each_arm(0, |name, pair| {
        for stiffness in [1e5, 1e6, 1e8] {
            let pull = Touch::spring(end_effector(pair), stiffness);
            let here = end_effector(pair);
            for touch in [
                Touch::hold().stiffness(stiffness),
                pull,
                Touch::carry(move |_| here, stiffness),
            ] {
                let name = format!("{name}, {touch:?}, {stiffness} N/m");
                pair.robot.touch(touch);
                assert_still(&name, pair);
                pair.robot.let_go();
            }
        }
    });
}

#[test]
fn grip_yields_by_force_over_stiffness_until_released() {
    for_each_arm(0, |name, pair| {
        assert!(pair.robot.guide(true));
        let grip = pair.robot.touch(Touch::hold());
        pair.idle(500);
        let before = end_effector(pair);
        let force = Vector3::new(0.0, 20.0, 0.0);
        let push = pair.robot.touch(Touch::force(force));
        pair.idle(1000);
        let moved = end_effector(pair) - before;
        // The joints' friction and damping also hold the arm.
        assert!((moved.y - 1e-3).abs() < 4e-4, "{name}: {moved}");
        assert!(pair.robot.dq().amax() < 0.01, "{name}");
        assert!(pair.robot.release(push) && pair.robot.release(grip));
        pair.robot.guide(false);
        pair.idle(200);
        assert_serves(name, pair);
    });
}

/// Moves joint 1 slightly, and checks that the robot reports the end of the motion.
fn assert_serves(name: &str, pair: &mut Pair) {
    let id = pair.start_joints();
    let mut q_c = pair.q_d();
    let start = q_c[0];
    for cycle in 0..600 {
        q_c[0] = start + 0.05 * ramp(f64::from(cycle) * 1e-3, 0.5);
        pair.tick(Some(positions(&q_c)));
    }
    pair.tick(Some(RobotCommand {
        motion_generation_finished: true,
        ..positions(&q_c)
    }));
    pair.idle(100);
    assert_eq!(pair.outcome(id), MoveStatus::Success, "{name}");
    assert_fine(name, pair);
    let off = (pair.robot.q()[0] - q_c[0]).abs();
    assert!(off < 3e-3, "{name}: {off} rad off");
}

#[test]
fn a_wall_stops_an_arm_that_is_pushed_into_it_and_does_not_pull() {
    for_each_arm(0, |name, pair| {
        assert!(pair.robot.guide(true));
        let wall = end_effector(pair) - Vector3::new(0.0, 0.0, 0.02);
        let wall = (pair.robot.touch(Touch::wall(wall, Vector3::z())), wall);
        let push = Touch::force(Vector3::new(0.0, 0.0, -40.0));
        let push = pair.robot.touch(push);
        let mut felt = Wrench::zeros();
        for _ in 0..3000 {
            pair.tick(None);
            felt = pair.robot.felt(wall.0).expect("it stands");
            assert!(felt.z >= -0.1, "{name}: {felt}");
        }
        let deep = (wall.1 - end_effector(pair)).z;
        assert!((deep - 2e-3).abs() < 1e-3, "{name}: {deep} m deep");
        let off = felt.z - deep * 20_000.0;
        assert!(off.abs() < 1.0, "{name}: {felt}, {deep} m deep");
        pair.robot.release(push);
        for _ in 0..500 {
            // A sudden pull moves the arm away fast; the wall follows for one step.
            let lift = Touch::force(Vector3::new(0.0, 0.0, 40.0)).lasting(1);
            pair.robot.touch(lift);
            pair.tick(None);
            felt = pair.robot.felt(wall.0).expect("it stands");
            assert!(felt.z >= -0.5, "{name}: {felt}");
        }
    });
}
