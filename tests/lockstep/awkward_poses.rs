//! Poses with a straight path through singular postures or out of the joints' ranges.

use std::time::Duration;

use franka_lockstep::{Lockstep, self_distance};
use franka_model::limits::JointLimits;
use franka_model::{READY, RobotKind, Wrench};
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalError, Guard, OnArrival, SELF_STOP, STALL_TIMEOUT, Settling, Target};
use franka_sim::Config;
use franka_sim::arm::{Arm, SystemLimits};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Reversals allowed per joint on one path. A law that chatters reverses a joint tens of times a
/// second.
const MOST_TURNS: u32 = 15;

#[test]
fn pose_through_stretched_elbow_or_wrist_is_smooth() {
    let start = Lockstep::ready().arm_pose();
    let turned = |x, z, angle| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
        Isometry3::from_parts(
            Translation3::from(start.translation.vector + Vector3::new(x, 0.0, z)),
            turn * start.rotation,
        )
    };
    let targets = [
        // Tilted upwards in place, and a little further away.
        turned(0.0, 0.0, -1.4),
        turned(0.1, 0.2, -1.2),
        // Nearly stretched.
        turned(0.42, -0.05, 0.0),
        turned(0.45, 0.05, -0.6),
        // A straight path through the axis of the base.
        turned(-0.6, 0.0, 0.0),
    ];
    for limits in [SystemLimits::From5_9, SystemLimits::Before5_9] {
        let mut arm = Arm::ideal(RobotKind::Fr3);
        arm.limits = limits;
        let config = Config {
            arm: Some(arm),
            ..Lockstep::config_of(RobotKind::Fr3)
        };
        let reached = targets
            .iter()
            .enumerate()
            .filter(|&(case, &target)| {
                is_reached_smoothly(Lockstep::new(config.clone()), case, target)
            })
            .count();
        assert!(reached >= 3, "{limits:?}: {reached}");
    }
}

/// True if the pose is reached, and not refused because the arm cannot follow the line.
fn is_reached_smoothly(mut lockstep: Lockstep, case: usize, target: Isometry3<f64>) -> bool {
    let goal = lockstep.goal(Target::Pose(target), OnArrival::ReportAndFinish);
    let goal = match lockstep.submit(goal) {
        Ok(goal) => goal,
        Err(MotionError::Goal(GoalError::NoLine { .. })) => return false,
        Err(error) => panic!("case {case}: {error}"),
    };
    let (mut turns, mut last) = ([0; 7], [0.0; 7]);
    while lockstep.client.outcome(goal).is_none() {
        lockstep.tick();
        assert!(lockstep.now() < 30_000, "case {case}");
        for (i, dq) in lockstep.client.record.dq_ref.into_iter().enumerate() {
            if dq.abs() > 0.02 {
                turns[i] += u32::from(dq * last[i] < 0.0);
                last[i] = dq;
            }
        }
    }
    assert!(
        turns.iter().all(|&turns| turns <= MOST_TURNS),
        "case {case}: {turns:?}"
    );
    let outcome = lockstep.client.outcome(goal).unwrap();
    assert!(outcome.is_ok(), "case {case}: {outcome:?}");
    true
}

/// A robot that tolerates contact, the height of a soft ceiling 5 cm above its hand, and a target
/// 20 cm above the hand.
fn below_a_ceiling() -> (Lockstep, f64, Target) {
    let mut lockstep = Lockstep::ready();
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
    let start = lockstep.arm_pose();
    let target = Translation3::new(0.0, 0.0, 0.2) * start;
    (lockstep, start.translation.z + 0.05, target.into())
}

/// A cycle below the ceiling.
fn press(lockstep: &mut Lockstep, ceiling: f64) {
    let pressed = (lockstep.arm_pose().translation.z - ceiling).max(0.0);
    lockstep.robot.let_go();
    lockstep
        .robot
        .push_end_effector(Wrench::new(0.0, 0.0, -3000.0 * pressed, 0.0, 0.0, 0.0), 2);
    lockstep.tick();
}

#[test]
fn a_goal_whose_leash_stays_bound_is_aborted_in_time() {
    let (mut lockstep, ceiling, target) = below_a_ceiling();
    let goal = lockstep.begin(target);
    let mut leashed = 0;
    while lockstep.client.outcome(goal).is_none() {
        press(&mut lockstep, ceiling);
        leashed += u64::from(lockstep.client.record.bindings.contains(Guard::Leash));
        let most = STALL_TIMEOUT + Settling::default().timeout + Duration::from_secs(3);
        assert!(lockstep.now() < most.as_millis() as u64, "{leashed}");
    }
    assert!(leashed > 3000, "{leashed}");
    let error = lockstep.client.outcome(goal).unwrap().clone().unwrap_err();
    assert!(
        matches!(error, MotionError::TargetNotReached(_)),
        "{error:?}"
    );
    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
}

/// The session continues to hold the arm, but the goal has ended.
#[test]
fn stalled_goal_does_not_resume_once_the_arm_is_free() {
    let (mut lockstep, ceiling, target) = below_a_ceiling();
    let engaged = lockstep.engage();
    let goal = lockstep.within(engaged, target, OnArrival::ReportAndHold);
    let goal = goal.expect("within reach");
    while lockstep.client.outcome(goal).is_none() {
        press(&mut lockstep, ceiling);
        assert!(lockstep.now() < 20_000, "it is resolved");
    }
    let error = lockstep.until_resolved(goal, 1).unwrap_err();
    let not_reached = matches!(error, MotionError::TargetNotReached(_));
    assert!(not_reached, "{error:?}");
    lockstep.robot.let_go();
    lockstep.run(3000);
    let risen = lockstep.arm_pose().translation.z - ceiling;
    println!("{risen:.4} m above the ceiling");
    assert!(risen < 0.05, "{risen} m");
}

/// The closer a joint is to the end of its range, the less velocity the robot allows. A plan has to
/// stay within that velocity envelope.
#[test]
fn joints_reach_the_ends_of_their_ranges_at_any_speed() {
    let limits = JointLimits::fr3_system_5_9();
    let speeds: &[f64] = match franka_tests::thorough() {
        true => &[0.5, 1.0, 1.5],
        false => &[0.5, 1.5],
    };
    for &speed in speeds {
        for joint in 0..7 {
            for upper in [false, true] {
                let mut lockstep = Lockstep::ready();
                let mut q: [f64; 7] = READY.into();
                q[joint] = if upper {
                    limits.upper[joint]
                } else {
                    limits.lower[joint]
                };
                if joint == 3 && self_distance(&q.into()) < SELF_STOP {
                    continue; // Folded that far, the hand is at the shoulder.
                }
                if self_distance(&q.into()) < SELF_STOP {
                    q[3] = -0.5; // With the elbow bent, the hand would be in the base.
                }
                let mut goal = lockstep.goal(Target::Joints(q), OnArrival::ReportAndFinish);
                goal.budget = goal.budget.scaled(speed);
                // The end itself is refused, and the error names the permitted range of the joint.
                let error = lockstep.submit(goal).unwrap_err();
                let MotionError::Goal(GoalError::OutOfRange {
                    lower: least,
                    upper: most,
                    ..
                }) = error
                else {
                    panic!("{error:?}");
                };
                q[joint] = if upper { most } else { least };
                goal.target = Target::Joints(q);
                let goal = lockstep.submit(goal).expect("as far as the refusal says");
                let outcome = lockstep.until_resolved(goal, 30_000);
                assert!(
                    outcome.is_ok(),
                    "joint {}, upper {upper}, speed {speed}: {outcome:?}",
                    joint + 1
                );
            }
        }
    }
}
