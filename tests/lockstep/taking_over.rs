//! A goal, a stop or a failure that comes while the arm moves, and how motions end.

use franka_lockstep::Lockstep;
use franka_model::READY;
use franka_proto::{RobotError, RobotMode};
use franka_rt::control::{Callback, Finish, Next, Torques};
use franka_rt::driver::{Activity, LINK_TIMEOUT};
use franka_rt::lifecycle::{CloseReason, MotionError, START_TIMEOUT};
use franka_rt::session::{GoalId, OnArrival, PoseError, Target};
use nalgebra::Translation3;

fn ready_turned(joint: usize, by: f64) -> [f64; 7] {
    let mut q: [f64; 7] = READY.into();
    q[joint] += by;
    q
}

/// Submits a goal of this target at `speed` times the default budget.
fn submit_at(lockstep: &mut Lockstep, target: Target, speed: f64) -> GoalId {
    let mut goal = lockstep.goal(target, OnArrival::ReportAndFinish);
    goal.budget = goal.budget.scaled(speed);
    lockstep.submit(goal).expect("the goal is accepted")
}

fn fastest(lockstep: &Lockstep) -> f64 {
    let dq = lockstep.client.record.dq_ref;
    dq.iter().fold(0.0, |most, dq| dq.abs().max(most))
}

#[test]
fn a_goal_that_comes_while_the_motion_ends_may_be_slow() {
    let first_motion = || {
        let mut lockstep = Lockstep::ready();
        let near = Translation3::new(0.0, 0.0, 0.01) * lockstep.arm_pose();
        let goal = lockstep.begin(Target::Pose(near));
        (lockstep, goal)
    };
    let (mut rehearsal, _) = first_motion();
    while rehearsal.client.record.activity != Activity::Finishing {
        rehearsal.tick();
        assert!(rehearsal.now() < 4000, "the motion comes to its end");
    }
    // Torques fade out over the last tenth of a second before the finish.
    let (mut lockstep, first) = first_motion();
    lockstep.run(rehearsal.now() - lockstep.now() - 50);
    let target = Translation3::new(0.0, 0.1, 0.0) * lockstep.arm_pose();
    assert_eq!(lockstep.client.outcome(first), None);
    let slow = submit_at(&mut lockstep, Target::Pose(target), 0.03);
    assert!(lockstep.client.outcome(first).unwrap().is_ok());
    let report = lockstep.until_resolved(slow, 60_000).unwrap();
    assert!(report.duration > 2 * START_TIMEOUT, "{report:?}");
}

#[test]
fn an_arm_brakes_when_its_motion_is_aborted() {
    for how in 0..2 {
        let mut lockstep = Lockstep::ready();
        let target = Translation3::new(0.0, 0.0, 0.3) * lockstep.arm_pose();
        let goal = lockstep.begin(Target::Pose(target));
        lockstep.run(500);
        let here = lockstep.arm_pose();
        if how == 0 {
            lockstep
                .client
                .lifecycle
                .on_connection_closed(CloseReason::ClosedByPeer);
        } else {
            lockstep.client.violate();
        }
        lockstep.run(700);
        assert!(lockstep.client.outcome(goal).unwrap().is_err());
        assert!(lockstep.robot.dq().amax() < 0.02, "way {how}");
        let passed = PoseError::between(&lockstep.arm_pose(), &here).translation;
        assert!(passed < 0.06, "way {how}: {passed} m further");
        lockstep.run(2000);
        assert!(lockstep.client.driver.is_watching(), "way {how}");
    }
}

/// The robot has received a stop for the first motion, and has not ended it yet.
#[test]
fn motion_after_unreadable_reply_waits_for_previous_end() {
    for after in [0, 1, 2, 3, 5, 300] {
        let mut lockstep = Lockstep::ready();
        let first = lockstep.begin(Target::Joints(ready_turned(0, 0.3)));
        lockstep.run(after);
        lockstep.client.violate();
        let outcome = lockstep.client.outcome(first);
        assert!(
            matches!(outcome, Some(Err(MotionError::Violation(_)))),
            "{outcome:?}"
        );
        let next = lockstep.begin(Target::Joints(ready_turned(0, 0.1)));
        let report = lockstep.until_resolved(next, 8000);
        report.unwrap_or_else(|error| panic!("after {after} ms: {error}"));
        let off = lockstep.client.state.q[0] - ready_turned(0, 0.1)[0];
        assert!(off.abs() < 2e-3, "after {after} ms: {off} rad off");
    }
}

/// Has a function command no torques for 100 ms.
fn hold(lockstep: &mut Lockstep) -> Result<GoalId, MotionError> {
    let version = lockstep.client.version();
    let mut calls = 0;
    let function = Callback::torques(version, move |_, _| -> Next<Torques> {
        calls += 1;
        let torques = Torques([0.0; 7]);
        if calls < 100 {
            torques.into()
        } else {
            torques.finish()
        }
    });
    lockstep.control_function(function)
}

#[test]
fn program_after_unreadable_reply_waits_for_previous_end() {
    for after in [0, 1, 2, 3, 5, 50] {
        let mut lockstep = Lockstep::ready();
        hold(&mut lockstep).expect("nothing moves");
        lockstep.run(after);
        lockstep.client.violate();
        let next = hold(&mut lockstep).expect("it waits");
        let report = lockstep.until_resolved(next, 8000);
        report.unwrap_or_else(|error| panic!("after {after} ms: {error}"));
    }
}

#[test]
fn a_program_waits_for_the_end_of_what_was_taken_back() {
    let move_joint = |lockstep: &mut Lockstep| lockstep.begin(Target::Joints(ready_turned(0, 0.3)));
    let program = |lockstep: &mut Lockstep| hold(lockstep).expect("nothing moves");
    let earlier: [&dyn Fn(&mut Lockstep) -> GoalId; 2] = [&program, &move_joint];
    for (before, after) in earlier
        .iter()
        .flat_map(|before| [0, 1, 2, 3, 50].map(|ms| (before, ms)))
    {
        let mut lockstep = Lockstep::ready();
        let first = before(&mut lockstep);
        lockstep.run(after);
        assert_eq!(hold(&mut lockstep), Err(MotionError::Busy));
        lockstep.cancel(first);
        let next = hold(&mut lockstep).expect("it waits");
        let report = lockstep.until_resolved(next, 8000);
        report.unwrap_or_else(|error| panic!("after {after} ms: {error}"));
        assert!(lockstep.client.outcome(first).is_some(), "after {after} ms");
    }
}

#[test]
fn a_slow_joint_goal_supersedes_a_fast_one_without_overrunning() {
    for after in [30, 120, 250, 600, 900] {
        let mut lockstep = Lockstep::ready();
        submit_at(&mut lockstep, Target::Joints(ready_turned(0, 0.6)), 1.5);
        lockstep.run(after);
        let (before, q) = (fastest(&lockstep), lockstep.client.record.q_ref[0]);
        let slow = submit_at(&mut lockstep, Target::Joints(ready_turned(0, 0.3)), 0.05);
        let mut furthest: f64 = 0.0;
        for _ in 0..1500 {
            lockstep.tick();
            assert!(fastest(&lockstep) < before + 0.1, "after {after} ms");
            furthest = furthest.max(lockstep.client.record.q_ref[0] - q);
        }
        assert!(furthest < 0.35, "after {after} ms: {furthest} rad further");
        lockstep.stop();
        lockstep.until_idle(5000);
        assert!(lockstep.client.outcome(slow).is_some());
    }
}

#[test]
fn a_slow_pose_supersedes_any_fast_motion_without_overrunning() {
    for (kind, after) in [(0, 100), (0, 500), (1, 50), (1, 350)] {
        let mut lockstep = Lockstep::ready();
        let start = lockstep.arm_pose();
        let fast = if kind == 0 {
            Target::Pose(Translation3::new(0.0, 0.3, 0.1) * start)
        } else {
            Target::Joints(ready_turned(0, 0.9))
        };
        submit_at(&mut lockstep, fast, 1.4);
        lockstep.run(after);
        let here = lockstep.arm_pose();
        let slow = submit_at(&mut lockstep, Target::Pose(start), 0.05);
        lockstep.run(1500);
        let passed = PoseError::between(&lockstep.arm_pose(), &here).translation;
        assert!(passed < 0.2, "kind {kind}, after {after} ms: {passed} m on");
        lockstep.stop();
        lockstep.until_idle(3000);
        assert!(lockstep.client.outcome(slow).is_some());
    }
}

#[test]
fn a_stop_is_quick_for_any_speed_of_the_goal() {
    for speed in [0.05, 0.3, 1.0, 1.4] {
        for target in [
            Target::Joints(ready_turned(1, 0.5)),
            Target::Pose(Translation3::new(0.1, 0.2, 0.0) * Lockstep::ready().arm_pose()),
        ] {
            let mut lockstep = Lockstep::ready();
            submit_at(&mut lockstep, target, speed);
            lockstep.run(if speed < 0.1 { 6000 } else { 600 });
            assert!(fastest(&lockstep) > 0.005, "under way");
            let stop = lockstep.stop().unwrap();
            let mut braking = 0;
            while fastest(&lockstep) > 0.0 {
                lockstep.tick();
                braking += 1;
                assert!(braking < 350, "speed {speed}, {target:?}");
            }
            lockstep.until_resolved(stop, 2000).unwrap();
        }
    }
}

#[test]
fn pending_updates_of_a_cancelled_goal_move_nothing() {
    let mut lockstep = Lockstep::ready();
    let start = lockstep.arm_pose();
    let goal = lockstep.goal(Target::Pose(start), OnArrival::Hold);
    let id = lockstep.submit(goal).unwrap();
    lockstep.run(100);
    lockstep.cancel(id);
    let late = Target::Pose(Translation3::new(0.0, 0.1, 0.0) * start);
    assert_eq!(lockstep.update(id, late), Ok(false));
    lockstep.client.lifecycle.close(id);
    assert_eq!(lockstep.until_resolved(id, 3000), Err(MotionError::Stopped));
    let moved = PoseError::between(&lockstep.arm_pose(), &start).translation;
    assert!(moved < 1e-3, "{moved}");
}

#[test]
fn a_stop_or_a_cancel_while_a_motion_ends_starts_no_new_one() {
    for after in 0..20 {
        for cancelled in [false, true] {
            let mut lockstep = Lockstep::ready();
            let start = lockstep.arm_pose();
            let first = lockstep.begin(Target::Pose(Translation3::new(0.0, 0.0, 0.01) * start));
            while lockstep.client.record.activity != Activity::Finishing {
                lockstep.tick();
            }
            lockstep.run(after);
            if lockstep.client.lifecycle.is_idle() {
                break;
            }
            let last = if cancelled {
                let second = lockstep.begin(Target::Pose(start));
                lockstep.cancel(second);
                second
            } else {
                lockstep.stop().expect("the motion has not ended")
            };
            let outcome = lockstep.until_resolved(last, 100);
            if cancelled {
                assert_eq!(outcome, Err(MotionError::Stopped), "{after} ms");
            } else {
                assert_eq!(outcome.unwrap().final_error, None, "{after} ms");
            }
            assert!(
                lockstep.client.outcome(first).unwrap().is_ok(),
                "{after} ms"
            );
            for _ in 0..50 {
                lockstep.tick();
                assert_ne!(
                    lockstep.client.record.activity,
                    Activity::Running,
                    "{after} ms"
                );
            }
            assert!(lockstep.client.lifecycle.is_idle(), "{after} ms");
        }
    }
}

#[test]
fn a_reflex_before_the_first_cycle_is_reported_as_one() {
    let mut seen = 0;
    for after in 0..8 {
        let mut lockstep = Lockstep::ready();
        let goal = lockstep.begin(Target::Joints(ready_turned(0, 0.1)));
        lockstep.link.drop_states(10);
        lockstep.run(after);
        lockstep.robot.trip(RobotError::CartesianReflex);
        let error = lockstep.until_resolved(goal, 8000).unwrap_err();
        match error {
            MotionError::Control(error) if error.is_reflex() => seen += 1,
            MotionError::Rejected(_) => {}
            other => panic!("after {after} ms: {other:?}"),
        }
    }
    assert!(seen > 0);
}

#[test]
fn a_link_lost_before_the_first_cycle_leaves_no_motion_behind() {
    let mut lockstep = Lockstep::ready();
    let goal = lockstep.begin(Target::Joints(ready_turned(0, 0.1)));
    lockstep
        .link
        .drop_states(LINK_TIMEOUT.as_millis() as u64 + 50);
    let error = lockstep.until_resolved(goal, 3000).unwrap_err();
    assert!(matches!(error, MotionError::LinkLost { .. }), "{error:?}");
    lockstep.run(500);
    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
    let again = lockstep.begin(Target::Joints(ready_turned(0, 0.1)));
    lockstep.until_resolved(again, 8000).unwrap();
}
