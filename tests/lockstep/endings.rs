//! Ends of interrupted motions.

use std::sync::mpsc;

use franka_lockstep::{Link, Lockstep, for_each_robot};
use franka_model::{READY, Twist, Wrench};
use franka_proto::{CollisionBehavior, MoveStatus, Request, RobotError, RobotMode, Status};
use franka_rt::control::{Callback, Torques};
use franka_rt::driver::LINK_TIMEOUT;
use franka_rt::lifecycle::{CloseReason, MotionError};
use franka_rt::session::{GoalError, Guard, OnArrival, Target};
use nalgebra::Translation3;

fn moving(ready: &dyn Fn() -> Lockstep) -> (Lockstep, franka_rt::session::GoalId) {
    let mut lockstep = ready();
    let target = Translation3::new(0.0, 0.0, 0.12) * lockstep.arm_pose();
    let goal = lockstep.begin(Target::Pose(target));
    lockstep.run(500);
    assert!(lockstep.robot.dq().norm() > 0.05, "under way");
    (lockstep, goal)
}

#[test]
fn a_stop_brakes_and_resolves_itself_and_the_goal() {
    for_each_robot(|ready| {
        let (mut lockstep, goal) = moving(ready);
        let stop = lockstep.stop().expect("something moves");
        assert_eq!(
            lockstep.client.outcome(goal),
            Some(&Err(MotionError::Stopped))
        );
        // The goal has ended while the arm brakes; the stop ends when it rests.
        assert!(lockstep.robot.dq().norm() > 0.05);
        let report = lockstep.until_resolved(stop, 3000).unwrap();
        assert_eq!(report.final_error, None);
        assert!(lockstep.robot.dq().amax() < 0.01);
        assert_eq!(lockstep.robot.state().robot_mode, RobotMode::Idle);
        assert_eq!(lockstep.stop(), None, "nothing moves any more");
    });
}

/// Stops by two callers, under goals and under a control function.
#[test]
fn stops_at_the_same_time_resolve_with_the_same_rest() {
    for_each_robot(|ready| {
        for (after, function) in [(0, false), (3, false), (120, false), (0, true)] {
            let mut lockstep = if function {
                let mut lockstep = ready();
                let version = lockstep.client.version();
                let idle = Callback::torques(version, |_, _| Torques([0.0; 7]));
                lockstep.control_function(idle).expect("nothing else moves");
                lockstep.run(500);
                lockstep
            } else {
                moving(ready).0
            };
            let first = lockstep.stop().expect("something moves");
            lockstep.run(after);
            let second = lockstep.stop().expect("it has not ended");
            for stop in [first, second] {
                let stopped = lockstep.until_resolved(stop, 3000);
                assert!(stopped.is_ok(), "after {after} ms: {stopped:?}");
                assert!(lockstep.robot.dq().amax() < 0.01);
                assert_eq!(lockstep.robot.state().robot_mode, RobotMode::Idle);
            }
        }
    });
}

#[test]
fn a_cancelled_goal_brakes_at_any_moment_of_its_life() {
    for_each_robot(|ready| {
        for after in (0..1600).step_by(37) {
            let mut lockstep = ready();
            let target = Translation3::new(0.05, 0.0, 0.05) * lockstep.arm_pose();
            let goal = lockstep.begin(Target::Pose(target));
            lockstep.run(after);
            if lockstep.client.outcome(goal).is_some() {
                break;
            }
            lockstep.cancel(goal);
            let outcome = lockstep.until_resolved(goal, 4000);
            // A goal that has settled can no longer be cancelled.
            assert!(
                matches!(outcome, Err(MotionError::Stopped) | Ok(_)),
                "after {after} ms: {outcome:?}"
            );
            assert!(lockstep.robot.dq().amax() < 0.01);
            assert!(lockstep.client.lifecycle.is_idle());
        }
    });
}

#[test]
fn reflex_ends_the_motion_by_name_until_recovery() {
    for_each_robot(|ready| {
        let (mut lockstep, goal) = moving(ready);
        lockstep.robot.trip(RobotError::CartesianReflex);
        let error = lockstep.until_resolved(goal, 3000).unwrap_err();
        let MotionError::Control(reflex) = &error else {
            panic!("{error:?}")
        };
        assert!(
            reflex
                .failure
                .reflex_reason
                .contains(RobotError::CartesianReflex)
        );
        let text = error.to_string();
        assert!(
            text.starts_with(
                r#"libfranka: Move command aborted: motion aborted by reflex! ["cartesian_reflex"]"#
            ),
            "{text}"
        );
        assert!(text.contains("\ncontrol_command_success_rate: 1"), "{text}");

        // Until recovery the robot refuses.
        let refused = lockstep.begin(Target::Joints(READY.into()));
        let error = lockstep.until_resolved(refused, 3000).unwrap_err();
        let MotionError::Rejected(refusal) = &error else {
            panic!("{error:?}")
        };
        assert_eq!(
            refusal.status(),
            Status::Move(MoveStatus::CommandNotPossibleRejected)
        );
        assert_eq!(
            error.to_string(),
            r#"libfranka: Move command rejected: command not possible in the current mode ("Reflex")! (call `recover` first)"#
        );

        lockstep.run(500);
        lockstep.request(&Request::AutomaticErrorRecovery);
        lockstep.run(1500);
        assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
        let again = lockstep.begin(Target::Joints(READY.into()));
        lockstep.until_resolved(again, 8000).unwrap();
    });
}

#[test]
fn the_user_stop_ends_the_motion() {
    for_each_robot(|ready| {
        let (mut lockstep, goal) = moving(ready);
        lockstep.robot.press_user_stop(true);
        let error = lockstep.until_resolved(goal, 3000).unwrap_err();
        assert!(
            matches!(&error, MotionError::Control(error) if !error.is_reflex()),
            "{error:?}"
        );
        assert_eq!(
            error.to_string(),
            "libfranka: Move command aborted: User Stop pressed!"
        );
    });
}

#[test]
fn the_link_is_lost_at_the_timeout_and_not_before() {
    for_each_robot(|ready| {
        let (mut lockstep, goal) = moving(ready);
        let timeout = LINK_TIMEOUT.as_millis() as u64;
        lockstep.link.drop_states(timeout + 200);
        lockstep.run(timeout - 1);
        assert_eq!(lockstep.client.outcome(goal), None);
        lockstep.run(3);
        let outcome = lockstep
            .client
            .outcome(goal)
            .expect("resolved at the timeout")
            .clone();
        let error = outcome.unwrap_err();
        assert!(matches!(error, MotionError::LinkLost { .. }), "{error:?}");
        assert!(
            error
                .to_string()
                .starts_with("libfranka: UDP receive: Timeout")
        );

        // The robot has stopped itself meanwhile. Once the link is back, it can recover and move.
        lockstep.run(1000);
        assert!(
            lockstep
                .client
                .state
                .errors
                .contains(RobotError::CommunicationConstraintsViolation)
        );
        lockstep.request(&Request::AutomaticErrorRecovery);
        lockstep.run(1500);
        let again = lockstep.begin(Target::Joints(READY.into()));
        lockstep.until_resolved(again, 8000).unwrap();
    });
}

#[test]
fn a_lost_connection_resolves_everything_and_refuses_new_goals() {
    let (mut lockstep, goal) = moving(&Lockstep::ready);
    lockstep.client.close(CloseReason::ClosedByPeer);
    lockstep.tick();
    let error = lockstep
        .client
        .outcome(goal)
        .expect("resolved")
        .clone()
        .unwrap_err();
    assert_eq!(error.to_string(), "libfranka: server closed connection");
    let goal = lockstep.goal(Target::Joints(READY.into()), OnArrival::ReportAndFinish);
    let error = lockstep.submit(goal).unwrap_err();
    assert!(
        matches!(error, MotionError::ConnectionClosed { .. }),
        "{error:?}"
    );
}

#[test]
fn losses_that_the_robot_tolerates_do_not_end_a_motion() {
    for_each_robot(|ready| {
        for seed in 1..=10 {
            let mut lockstep = ready();
            lockstep.link = Link::lossy(seed, 0.02, 0.02);
            let target = Translation3::new(0.05, 0.05, -0.05) * lockstep.arm_pose();
            let goal = lockstep.begin(Target::Pose(target));
            let report = lockstep
                .until_resolved(goal, 8000)
                .unwrap_or_else(|error| panic!("seed {seed}: {error}"));
            assert!(report.lost_states > 0, "seed {seed}");
            // Before a hundred cycles have passed, one loss counts more than one per cent.
            assert!(report.success_rate_min < 1.0, "seed {seed}: {report:?}");
            assert!(report.success_rate_avg > 0.9, "seed {seed}: {report:?}");
        }
    });
}

/// A robot whose collision thresholds permit a hand to push.
fn tolerant(ready: &dyn Fn() -> Lockstep) -> Lockstep {
    let mut lockstep = ready();
    let behavior = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(behavior));
    lockstep.run(5);
    lockstep
}

fn downward(newtons: f64) -> Wrench {
    Wrench::new(0.0, 0.0, -newtons, 0.0, 0.0, 0.0)
}

#[test]
fn blocked_arm_is_reported_and_released_without_reflex() {
    for_each_robot(|ready| {
        let mut lockstep = tolerant(ready);
        let target = Translation3::new(0.0, 0.0, 0.08) * lockstep.arm_pose();
        let goal = lockstep.begin(Target::Pose(target));
        // More than friction and bias are compensated by.
        lockstep.robot.push_end_effector(downward(22.0), 1_000_000);
        let error = lockstep.until_resolved(goal, 3000).unwrap_err();
        let MotionError::TargetNotReached(short) = &error else {
            panic!("{error:?}")
        };
        assert_eq!(short.limited, None, "no torque limit binds");
        assert!(
            error
                .to_string()
                .contains("something holds or moves the arm"),
            "{error}"
        );
        let error = short.error;
        // 22 N against 750 N/m and the additional stiffness of the joint springs.
        assert!((0.012..0.024).contains(&error.translation), "{error:?}");
        let pull = short.pull.expect("of its own law");
        let aside = pull[0].hypot(pull[1]);
        assert!((pull[2] - 22.0).abs() < 1.0 && aside < 1.0, "{pull:?}");
        assert_eq!(
            lockstep.client.state.robot_mode,
            RobotMode::Idle,
            "ended without a reflex"
        );
    });
}

#[test]
fn a_pushed_arm_keeps_its_reference_on_the_leash_and_returns() {
    for_each_robot(|ready| {
        let mut lockstep = tolerant(ready);
        let target = Translation3::new(0.0, 0.0, 0.08) * lockstep.arm_pose();
        let goal = lockstep.begin(Target::Pose(target));
        lockstep.run(300);
        lockstep.robot.push_end_effector(downward(40.0), 250);
        let mut bound = 0;
        for _ in 0..250 {
            lockstep.tick();
            bound += u32::from(lockstep.client.record.bindings.contains(Guard::Leash));
        }
        assert!(bound > 100, "the leash bound in {bound} of 250 cycles");
        lockstep.until_resolved(goal, 8000).unwrap();
    });
}

#[test]
fn arm_pushed_away_after_its_arrival_returns() {
    for_each_robot(|ready| {
        let mut lockstep = tolerant(ready);
        let target = Translation3::new(0.0, 0.0, 0.08) * lockstep.arm_pose();
        let engaged = lockstep.engage();
        let goal = lockstep.within(engaged, target.into(), OnArrival::ReportAndHold);
        let goal = goal.expect("within reach");
        lockstep.until_resolved(goal, 8000).expect("it arrives");
        lockstep.robot.push_end_effector(downward(40.0), 250);
        let off = |lockstep: &Lockstep| {
            let arm = lockstep.arm_pose().translation.vector;
            (arm - target.translation.vector).norm()
        };
        lockstep.run(250);
        let pushed = off(&lockstep);
        assert!(pushed > 0.05, "{pushed} m");
        lockstep.run(5000);
        let left = off(&lockstep);
        println!("{pushed:.5} m, then {left:.5} m off");
        assert!(left < 3e-3, "{left} m");
    });
}

#[test]
fn bad_goals_are_named_and_change_nothing() {
    let (mut lockstep, goal) = moving(&Lockstep::ready);
    let mut beyond: [f64; 7] = READY.into();
    beyond[3] = 0.5;
    let mut degrees: [f64; 7] = READY.into();
    degrees[1] = -45.0;
    let mut nan: [f64; 7] = READY.into();
    nan[2] = f64::NAN;
    let far = Translation3::new(2.0, 0.0, 0.0) * lockstep.arm_pose();
    for (target, expected) in [
        (
            Target::Joints(beyond),
            "the target of joint 4 is 0.5 rad, expected between -3.0642 and -0.1297 rad",
        ),
        (
            Target::Joints(degrees),
            "the target of joint 2 is -45 rad, expected between -1.8280 and 1.8280 rad (are these degrees?)",
        ),
        (
            Target::Joints(nan),
            "got a number that is not finite in the target's joint positions",
        ),
        (Target::Pose(far), "the pose at (2."),
        (
            Target::Pose(Translation3::new(1e300, 0.0, 0.0) * lockstep.arm_pose()),
            "the pose at (1e300,",
        ),
    ] {
        let bad = lockstep.goal(target, OnArrival::ReportAndFinish);
        let error = lockstep.submit(bad).unwrap_err();
        assert!(error.to_string().starts_with(expected), "{error}");
    }
    // Millimetres per second.
    let twist = Twist::new(0.0, 300.0, 0.0, 0.0, 0.0, 0.0);
    let pose = lockstep.arm_pose();
    let moving = Target::MovingPose { pose, twist };
    let fast = lockstep.goal(moving, OnArrival::Hold);
    let error = lockstep.submit(fast).unwrap_err();
    assert_eq!(
        error.to_string(),
        "speed of the target is 300 m/s, expected between 0 and 3 m/s"
    );
    let mut fast = lockstep.goal(Target::Joints(READY.into()), OnArrival::ReportAndFinish);
    fast.budget.joints[1].velocity = 3.0;
    let error = lockstep.submit(fast).unwrap_err();
    assert_eq!(
        error,
        MotionError::Goal(GoalError::Budget {
            what: "joint velocity [rad/s]",
            got: 3.0,
            least: 1e-6,
            most: 2.62
        })
    );
    assert!(
        lockstep.until_resolved(goal, 8000).is_ok(),
        "the active motion continued"
    );
}

/// The state of the motion is unknown, so the control function gets no more states, and the robot
/// receives a stop.
#[test]
fn unreadable_reply_ends_the_states_of_a_control_function() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let version = lockstep.client.version();
        let (calls, called) = mpsc::channel();
        let callback = Callback::torques(version, move |_, _| {
            calls.send(()).expect("the test listens");
            Torques([0.0; 7])
        });
        let work = lockstep.control_function(callback).expect("nothing moves");
        lockstep.run(50);
        assert!(called.try_iter().count() > 10);
        lockstep.client.violate();
        let error = lockstep.until_resolved(work, 1).unwrap_err();
        assert!(matches!(error, MotionError::Violation(_)), "{error:?}");
        lockstep.run(1500);
        assert_eq!(called.try_iter().count(), 0);
        assert!(lockstep.client.driver.is_watching());
        assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
        let again = lockstep.begin(Target::Joints(READY.into()));
        lockstep.until_resolved(again, 8000).unwrap();
    });
}
