//! Goals without faults.

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot, pose_of, self_distance};
use franka_model::limits::JointLimits;
use franka_model::{EndEffector, READY, RobotKind};
use franka_rt::driver::Activity;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{
    Free, Goal, GoalError, OnArrival, OnTimeout, PoseError, SELF_STOP, Target, Watchdog,
};
use franka_sim::Config;
use franka_sim::arm::{Arm, SystemLimits};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

fn assert_near(lockstep: &Lockstep, target: &Isometry3<f64>) {
    let error = PoseError::between(&lockstep.arm_pose(), target);
    assert!(
        error.translation < 1e-3 && error.rotation < 2e-3,
        "{error:?}"
    );
}

fn hand() -> EndEffector {
    EndEffector {
        f_t_ee: franka_sim::Tool::hand().f_t_ne,
        ..EndEffector::default()
    }
}

#[test]
fn a_pose_is_reached_and_the_arm_rests_there() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let target = Translation3::new(0.0, 0.0, 0.05) * lockstep.arm_pose();
        let goal = lockstep.begin(Target::Pose(target));
        let report = lockstep.until_resolved(goal, 6000).unwrap();
        assert_near(&lockstep, &target);
        assert!(lockstep.robot.dq().amax() < 0.01);
        assert_eq!(report.lost_states, 0);
        assert_eq!(report.success_rate_min, 1.0);
        assert!(report.duration.as_secs_f64() < 1.5, "{report:?}");
        assert!(lockstep.client.lifecycle.is_idle() && lockstep.client.driver.is_watching());
    });
}

/// No plan delays a command: it is made after the command, for the next one.
#[test]
fn new_target_moves_the_reference_one_cycle_after_reading() {
    for_each_robot(|ready| {
        let turned = |by: f64| {
            let mut q = READY;
            q[0] += by;
            Target::Joints(q.into())
        };
        let [mut changed, mut kept] = [(); 2].map(|()| {
            let mut lockstep = ready();
            let there = lockstep.goal(turned(0.3), OnArrival::Hold);
            let goal = lockstep.submit(there).unwrap();
            lockstep.run(300);
            (lockstep, goal)
        });
        assert!(changed.0.client.record.dq_ref[0] > 0.1, "under way");
        changed.0.update(changed.1, turned(-0.3)).unwrap();
        let mut references = || {
            [&mut changed.0, &mut kept.0].map(|lockstep| {
                lockstep.tick();
                lockstep.client.record.q_ref
            })
        };
        let [of_changed, of_kept] = references();
        assert_eq!(of_changed, of_kept, "the plan before");
        let [of_changed, of_kept] = references();
        assert_ne!(of_changed, of_kept, "the new plan");
    });
}

#[test]
fn the_record_has_the_target_where_it_is_in_its_cycle() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let turned = Target::Joints(core::array::from_fn(|i| READY[i] + 0.1));
        let pose = Translation3::new(0.0, 0.0, 0.05) * lockstep.arm_pose();
        let (q, dq) = (READY.into(), [0.01; 7]);
        let moving = Target::MovingJoints { q, dq };
        let mut recorded = |target| {
            let goal = lockstep.goal(target, OnArrival::Hold);
            lockstep.submit(goal).expect("within reach");
            lockstep.run(50);
            let record = lockstep.client.record;
            (record.q_target.map(Target::Joints), record.pose_target)
        };
        assert_eq!(recorded(turned), (Some(turned), None));
        assert_eq!(recorded(Target::Pose(pose)), (None, Some(pose)));
        let (Some(Target::Joints(moved)), None) = recorded(moving) else {
            panic!("it heads for joint positions");
        };
        let way = moved[0] - READY[0];
        assert!(way > 0.01 * 0.04 && way < 0.01 * 0.06, "{way} after 50 ms");
        assert_eq!(recorded(Target::Rest), (None, None));
    });
}

#[test]
fn the_hand_moves_on_a_straight_line() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let way = Vector3::new(0.06, -0.09, 0.04);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.1, 0.2, -0.3));
        let target = Isometry3::from_parts(
            Translation3::from(start.translation.vector + way),
            turn * start.rotation,
        );
        let goal = lockstep.begin(Target::Pose(target));
        let aside = |pose: &Isometry3<f64>| {
            let passed = pose.translation.vector - start.translation.vector;
            (passed - way * (passed.dot(&way) / way.norm_squared())).norm()
        };
        let (mut reference, mut arm): (f64, f64) = (0.0, 0.0);
        while lockstep.client.outcome(goal).is_none() {
            lockstep.tick();
            // After the end the reference follows the arm.
            if lockstep.client.record.dq_ref != [0.0; 7] {
                reference = reference.max(aside(&pose_of(
                    &lockstep.client.record.q_ref.into(),
                    &hand(),
                )));
            }
            arm = arm.max(aside(&lockstep.arm_pose()));
        }
        assert!(lockstep.client.outcome(goal).unwrap().is_ok());
        assert_near(&lockstep, &target);
        assert!(
            reference < 2e-5,
            "the reference is {:.4} mm off the line",
            reference * 1e3
        );
        // The arm is compliant: on a path of 117 mm at 0.3 m/s it deviates to the side by a few
        // millimetres.
        assert!(arm < 4e-3, "the arm is {:.2} mm off the line", arm * 1e3);
    });
}

#[test]
fn joints_arrive_at_the_same_time() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let mut q: [f64; 7] = READY.into();
        q[0] += 0.3;
        q[3] += 0.2;
        q[6] -= 0.4;
        let goal = lockstep.begin(Target::Joints(q));
        lockstep.until_resolved(goal, 8000).unwrap();
        assert_near(&lockstep, &pose_of(&q.into(), &hand()));
    });
}

#[test]
fn a_newer_goal_takes_over_without_a_stop() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let first = lockstep.begin(Target::Pose(Translation3::new(0.0, 0.0, 0.1) * start));
        lockstep.run(400);
        let second = lockstep.begin(Target::Pose(Translation3::new(0.0, 0.1, 0.05) * start));
        assert_eq!(
            lockstep.client.outcome(first),
            Some(&Err(MotionError::Superseded))
        );
        let mut slowest: f64 = f64::MAX;
        for _ in 0..100 {
            lockstep.tick();
            slowest = slowest.min(lockstep.robot.dq().norm());
        }
        assert!(slowest > 0.02, "the arm keeps moving: {slowest} rad/s");
        lockstep.until_resolved(second, 8000).unwrap();
        assert_near(&lockstep, &(Translation3::new(0.0, 0.1, 0.05) * start));
    });
}

#[test]
fn the_kind_of_goal_changes_in_mid_motion() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        lockstep.begin(Target::Pose(Translation3::new(0.1, 0.0, 0.0) * start));
        lockstep.run(500);
        let mut q: [f64; 7] = READY.into();
        q[0] -= 0.2;
        lockstep.begin(Target::Joints(q));
        lockstep.run(300);
        let last = lockstep.begin(Target::Pose(start));
        lockstep.until_resolved(last, 8000).unwrap();
        assert_near(&lockstep, &start);
    });
}

#[test]
fn a_goal_submitted_while_a_motion_ends_gets_its_own_motion() {
    for_each_robot(|ready| {
        // Client and robot take some ten milliseconds to end a motion. Each of them is tried.
        for after in 0..40 {
            let mut lockstep = ready();
            let start = lockstep.arm_pose();
            let target = Translation3::new(0.0, 0.0, 0.01) * start;
            let first = lockstep.begin(Target::Pose(target));
            while lockstep.client.record.activity != Activity::Finishing {
                lockstep.tick();
                assert!(lockstep.now() < 4000, "the motion comes to its end");
            }
            lockstep.run(after);
            let second = lockstep.begin(Target::Pose(start));
            let outcome = lockstep.until_resolved(second, 8000);
            assert!(outcome.is_ok(), "{after} ms after the finish: {outcome:?}");
            assert!(
                lockstep.client.outcome(first).unwrap().is_ok(),
                "{after} ms: it had arrived"
            );
            assert_near(&lockstep, &start);
        }
    });
}

#[test]
fn a_followed_target_may_step_arbitrarily() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let goal = lockstep.goal(Target::Pose(start), OnArrival::Hold);
        let id = lockstep.submit(goal).unwrap();
        let mut last = start;
        for step in 0..40_u32 {
            let angle = f64::from(step) * 0.9;
            last = Translation3::new(0.04 * angle.cos() - 0.04, 0.08 * angle.sin(), 0.0) * start;
            let state = lockstep.client.state;
            assert_eq!(
                lockstep
                    .client
                    .lifecycle
                    .update(id, Target::Pose(last), &state),
                Ok(true)
            );
            lockstep.run(100);
            assert_eq!(
                lockstep.client.outcome(id),
                None,
                "a held goal does not end by itself"
            );
        }
        lockstep.client.lifecycle.close(id);
        lockstep.until_resolved(id, 8000).unwrap();
        assert_near(&lockstep, &last);
    });
}

#[test]
fn joints_are_reached_close_to_the_ends_of_their_ranges() {
    // Closer than about 0.01 rad, the robot's velocity envelope allows no outward motion.
    let limits = JointLimits::of(RobotKind::Fr3);
    for i in 0..7 {
        for end in [limits.lower[i] + 0.02, limits.upper[i] - 0.02] {
            let mut q: [f64; 7] = READY.into();
            q[i] = end;
            if i == 3 && self_distance(&q.into()) < SELF_STOP {
                continue; // Folded that far, the hand is at the shoulder.
            }
            if self_distance(&q.into()) < SELF_STOP {
                q[3] = -0.5; // With the elbow bent, the hand would be in the base.
            }
            let mut lockstep = Lockstep::ready();
            let goal = lockstep.begin(Target::Joints(q));
            let outcome = lockstep.until_resolved(goal, 20_000);
            assert!(outcome.is_ok(), "joint {} to {end}: {outcome:?}", i + 1);
        }
    }
}

/// A Franka Research 3 with a hand and with the joint limits of this system.
fn under(limits: SystemLimits) -> Lockstep {
    let mut arm = Arm::ideal(RobotKind::Fr3);
    arm.limits = limits;
    Lockstep::new(Config {
        arm: Some(arm),
        ..Lockstep::config_of(RobotKind::Fr3)
    })
}

/// Joint targets at 99 % of the range of system 5.9, to either side of its middle.
///
/// The envelope of joints 1 and 6 allows no speed beyond 98.97 and 99.9 % of the documented range.
/// Their targets are therefore at 99 % of the remaining range.
fn near_the_ends_of_5_9() -> Vec<(usize, [f64; 7])> {
    let limits = JointLimits::fr3_system_5_9();
    let envelope = limits.envelope.expect("an FR3 has one");
    let mut targets = Vec::new();
    for i in 0..7 {
        let (middle, half) = (
            0.5 * (limits.hard_upper[i] + limits.hard_lower[i]),
            0.5 * (limits.hard_upper[i] - limits.hard_lower[i]),
        );
        // With the 0.02 rad/s that the driver keeps from the envelope.
        let still = 0.5 * (envelope.offset[i] + 0.02).powi(2) / (envelope.deceleration[i] - 0.3);
        let half = (limits.upper[i] - middle).min(half - still);
        for side in [-1.0, 1.0] {
            let mut q: [f64; 7] = READY.into();
            q[i] = middle + side * 0.99 * half;
            if i == 3 && self_distance(&q.into()) < SELF_STOP {
                continue; // Folded that far, the hand is at the shoulder.
            }
            if self_distance(&q.into()) < SELF_STOP {
                q[3] = -0.5; // With the elbow bent, the hand would be in the base.
            }
            targets.push((i, q));
        }
    }
    targets
}

#[test]
fn targets_at_99_percent_of_range_need_system_5_9() {
    let targets = near_the_ends_of_5_9();
    assert!(targets.len() >= 12);
    for (i, q) in targets {
        let mut lockstep = under(SystemLimits::From5_9);
        let goal = lockstep.begin(Target::Joints(q));
        let outcome = lockstep.until_resolved(goal, 20_000);
        assert!(outcome.is_ok(), "joint {} to {}: {outcome:?}", i + 1, q[i]);
        assert!((lockstep.client.state.q[i] - q[i]).abs() < 5e-3);
        if i == 2 {
            continue; // Its range is the same under every system.
        }
        let mut earlier = under(SystemLimits::Before5_9);
        let goal = Goal::new(
            earlier.client.next_goal(),
            Target::Joints(q),
            OnArrival::ReportAndFinish,
            JointLimits::of(RobotKind::Fr3),
        );
        let refused = earlier.submit(goal);
        assert!(
            matches!(
                &refused,
                Err(MotionError::Goal(GoalError::OutOfRange { joint, .. })) if *joint == i + 1
            ),
            "joint {} to {}: {refused:?}",
            i + 1,
            q[i]
        );
    }
}

#[test]
fn goals_are_checked_against_the_ranges_of_the_connected_robot() {
    // Joint 6 of a Panda folds in that far, joint 6 of a Research 3 does not.
    let mut q: [f64; 7] = READY.into();
    q[5] = 0.45;
    let mut fer = Lockstep::ready_of(RobotKind::Fer);
    let goal = fer.begin(Target::Joints(q));
    fer.until_resolved(goal, 10_000).unwrap();
    assert_near(&fer, &pose_of(&q.into(), &hand()));

    let mut fr3 = Lockstep::ready_of(RobotKind::Fr3);
    let goal = fr3.goal(Target::Joints(q), OnArrival::ReportAndFinish);
    let error = fr3.submit(goal).unwrap_err();
    assert!(
        matches!(
            error,
            MotionError::Goal(GoalError::OutOfRange { joint: 6, .. })
        ),
        "{error:?}"
    );
}

#[test]
fn a_goal_of_any_speed_is_planned_or_refused() {
    for_each_robot(|ready| {
        for pace in [1e-2, 1e-3, 1e-4, 1e-6, 1e-12, 1e-60] {
            let mut lockstep = ready();
            let up = Translation3::new(0.0, 0.0, 0.05) * lockstep.arm_pose();
            let mut q: [f64; 7] = READY.into();
            q[0] += 0.1;
            for target in [Target::Pose(up), Target::Joints(q)] {
                let mut goal = lockstep.goal(target, OnArrival::Hold);
                goal.budget = goal.budget.scaled(pace);
                match lockstep.submit(goal) {
                    Ok(_) => lockstep.run(300),
                    Err(error) => assert!(matches!(error, MotionError::Goal(_)), "{error}"),
                }
            }
            if let Some(stop) = lockstep.stop() {
                lockstep.until_resolved(stop, 1000).expect("it rests");
            }
        }
    });
}

#[test]
fn a_stream_that_ends_while_guiding_comes_to_rest() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let goal = lockstep.goal(Target::Guide(Free::ALL), OnArrival::Hold);
        let goal = lockstep.submit(goal).expect("nothing moves");
        lockstep.run(500);
        lockstep.client.lifecycle.close(goal);
        lockstep.until_resolved(goal, 3000).expect("it rests");
    });
}

#[test]
fn a_goal_that_still_moves_is_not_reported_as_held() {
    for_each_robot(|ready| {
        let (mut gone_on, mut held) = (0, 0);
        for wait in (0..400).step_by(10) {
            let mut lockstep = ready();
            let mut q: [f64; 7] = READY.into();
            let goal = Goal {
                watchdog: Some(Watchdog {
                    silence: Duration::from_millis(50),
                    on_timeout: OnTimeout::Hold,
                }),
                ..lockstep.goal(Target::Joints(q), OnArrival::Hold)
            };
            let goal = lockstep.submit(goal).expect("it is there already");
            lockstep.run(50 + wait);
            q[0] += 0.2;
            if lockstep.update(goal, Target::Joints(q)) != Ok(true) {
                continue;
            }
            lockstep.run(100);
            let moves = lockstep.client.record.dq_ref[0] > 0.01;
            if let Some(stop) = lockstep.stop() {
                lockstep.until_resolved(stop, 2000).expect("it rests");
            }
            let outcome = lockstep.until_resolved(goal, 2000);
            let was_held = matches!(outcome, Err(MotionError::Held(_)));
            assert!(!(moves && was_held), "{wait} ms: {outcome:?}");
            gone_on += u32::from(moves);
            held += u32::from(was_held);
        }
        assert!(gone_on > 5 && held > 5, "{gone_on}, {held}");
    });
}
