//! Sessions that go from goal to goal.
//!
//! * `geometry`: robots that compute their poses with another geometry.
//! * `lapses`: timeouts of streams and deadmen.
//! * `leases`: sessions of clients that hold the lease of the arm.
//! * `options`: gains, force cap and regions.
//! * `backends`: the robot's own controller, and observers.
//! * `chunks`: the end of chunks.
//! * `controllers`: every controller of the robot with every kind of setpoint, on arms that stick.
//! * `corners`: orders that meet a cancelled goal, and sessions without their deadman.
//! * `speed_cap`: the arm no faster than its cap.
//! * `waiting`: sessions that are requested while the previous motion ends.

mod backends;
mod chunks;
mod controllers;
mod corners;
mod geometry;
mod lapses;
mod leases;
mod options;
mod speed_cap;
mod waiting;

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::{READY, Wrench};
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{
    Chunk, Deadman, Free, Goal, GoalError, GoalId, OnArrival, OnTimeout, PoseError, Target,
    Watchdog,
};
use nalgebra::{Isometry3, Translation3};

fn up(lockstep: &Lockstep, metres: f64) -> Isometry3<f64> {
    Translation3::new(0.0, 0.0, metres) * lockstep.arm_pose()
}

fn turned(by: f64) -> Target {
    Target::Joints(turned_q(by))
}

/// The ready posture with joint 1 turned.
fn turned_q(by: f64) -> [f64; 7] {
    let mut q: [f64; 7] = READY.into();
    q[0] += by;
    q
}

/// Eleven points between two angles of joint 1, in half a second.
fn chunk(from: f64, to: f64) -> Chunk {
    let point = |k: u32| {
        let way = from + (to - from) * f64::from(k) / 10.0;
        (Duration::from_millis(50) * k, turned_q(way))
    };
    Chunk::joints((0..=10).map(point)).expect("points 50 ms apart")
}

/// Submits a held goal whose stream times out after this many milliseconds.
fn watched(
    lockstep: &mut Lockstep,
    target: Target,
    milliseconds: u64,
    on_timeout: OnTimeout,
) -> Goal {
    Goal {
        watchdog: Some(Watchdog {
            silence: Duration::from_millis(milliseconds),
            on_timeout,
        }),
        ..lockstep.goal(target, OnArrival::Hold)
    }
}

/// Returns an arm with a session bound to a deadman that times out after this many milliseconds.
fn guarded(ready: &dyn Fn() -> Lockstep, milliseconds: u64) -> (Lockstep, GoalId, Deadman) {
    let (token, monitor) = Deadman::new(Duration::from_millis(milliseconds));
    let mut lockstep = ready();
    let engaged = lockstep.engage_with(Engagement {
        deadman: Some(monitor),
        ..Engagement::default()
    });
    (lockstep, engaged, token)
}

fn assert_stays(lockstep: &mut Lockstep, engaged: GoalId) {
    let before = lockstep.arm_pose();
    lockstep.run(500);
    let moved = PoseError::between(&lockstep.arm_pose(), &before);
    assert!(moved.translation < 1e-3, "{moved:?}");
    assert_eq!(lockstep.client.outcome(engaged), None, "it goes on");
}

#[test]
fn goals_resolve_and_the_session_continues_until_it_is_ended() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let pose = up(&lockstep, 0.05);
        for target in [Target::Pose(pose), turned(0.1), Target::Rest] {
            let goal = lockstep
                .within(engaged, target, OnArrival::ReportAndHold)
                .unwrap();
            let report = lockstep.until_resolved(goal, 6000).unwrap();
            assert_eq!(report.final_error.is_none(), target == Target::Rest);
            assert_stays(&mut lockstep, engaged);
        }
        lockstep.disengage(engaged);
        // A motion requested meanwhile waits for the session to end.
        let next = lockstep.begin(turned(0.05));
        lockstep.until_resolved(engaged, 1000).unwrap();
        lockstep.until_resolved(next, 6000).unwrap();
        assert!(lockstep.client.lifecycle.is_idle());
        let late = lockstep.within(engaged, turned(0.0), OnArrival::ReportAndHold);
        assert_eq!(late, Err(MotionError::Disengaged));
    });
}

#[test]
fn a_goal_of_another_kind_supersedes_in_mid_motion() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let pose = up(&lockstep, 0.1);
        let mut before = None;
        for target in [
            Target::Pose(pose),
            turned(0.3),
            Target::Pose(pose),
            turned(0.0),
        ] {
            let goal = lockstep
                .within(engaged, target, OnArrival::ReportAndHold)
                .unwrap();
            if let Some(before) = before.replace(goal) {
                let superseded = lockstep.until_resolved(before, 1);
                assert_eq!(superseded, Err(MotionError::Superseded));
            }
            lockstep.run(400);
        }
        let last = before.expect("there were goals");
        lockstep.until_resolved(last, 6000).unwrap();
        assert_stays(&mut lockstep, engaged);
    });
}

#[test]
fn a_session_excludes_other_motions_but_any_handle_can_stop_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep.goal(turned(0.1), OnArrival::ReportAndFinish);
        assert_eq!(lockstep.submit(goal), Err(MotionError::Busy));
        let goal = lockstep
            .within(engaged, turned(0.3), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.run(300);
        let stop = lockstep.stop().expect("it moves");
        lockstep.until_resolved(stop, 2000).unwrap();
        for ended in [goal, engaged] {
            let outcome = lockstep.until_resolved(ended, 1);
            assert_eq!(outcome, Err(MotionError::Stopped));
        }
        let late = lockstep.within(engaged, turned(0.0), OnArrival::ReportAndHold);
        assert_eq!(late, Err(MotionError::Stopped));
    });
}

#[test]
fn a_cancelled_goal_leaves_the_arm_held() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep
            .within(engaged, turned(0.3), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.run(300);
        lockstep.cancel(goal);
        let outcome = lockstep.until_resolved(goal, 2000);
        assert_eq!(outcome, Err(MotionError::Stopped));
        assert_stays(&mut lockstep, engaged);
        // Dropping the session itself ends the motion.
        lockstep.cancel(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}

#[test]
fn every_goal_after_a_reflex_fails_with_that_reflex() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep
            .within(engaged, turned(0.3), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.run(300);
        lockstep.robot.press_user_stop(true);
        let outcome = lockstep.until_resolved(goal, 2000);
        let Err(MotionError::Control(error)) = &outcome else {
            panic!("{outcome:?}");
        };
        assert_eq!(lockstep.until_resolved(engaged, 1), outcome);
        let late = lockstep.within(engaged, turned(0.0), OnArrival::ReportAndHold);
        assert_eq!(late, Err(MotionError::Control(error.clone())));
    });
}

#[test]
fn late_goal_ends_superseded_or_like_its_session() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        lockstep.robot.press_user_stop(true);
        let mut late = Vec::new();
        while lockstep.client.outcome(engaged).is_none() {
            lockstep.tick();
            late.extend(lockstep.within(engaged, turned(0.1), OnArrival::ReportAndHold));
        }
        let outcome = lockstep.until_resolved(engaged, 1);
        assert!(matches!(outcome, Err(MotionError::Control(_))));
        for (i, goal) in late.iter().enumerate() {
            let heard = lockstep.until_resolved(*goal, 1);
            let superseded = heard == Err(MotionError::Superseded);
            assert!(superseded || heard == outcome, "{i}: {heard:?}");
        }
    });
}

#[test]
fn a_hand_guides_the_arm_along_the_axes_that_are_free() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let free = Free {
            axes: [false, true, false, false, false, false],
            elbow: false,
        };
        lockstep
            .within(engaged, Target::Guide(free), OnArrival::Hold)
            .unwrap();
        lockstep.run(400);
        let start = lockstep.arm_pose();
        let push = Wrench::new(4.0, 4.0, 4.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(push, 1500);
        lockstep.run(1500);
        let moved = lockstep.arm_pose().translation.vector - start.translation.vector;
        assert!(moved.y > 0.05, "{moved}");
        assert!(moved.x.abs() < 0.01 && moved.z.abs() < 0.01, "{moved}");
        let turned = PoseError::between(&lockstep.arm_pose(), &start).rotation;
        assert!(turned < 0.05, "{turned} rad");
        // Superseded while the hand still moves the arm.
        let hold = lockstep
            .within(engaged, Target::Rest, OnArrival::ReportAndHold)
            .unwrap();
        lockstep.until_resolved(hold, 5000).unwrap();
        assert_stays(&mut lockstep, engaged);
    });
}

/// A policy that predicts a sine of joint 1 ten times a second, from observations 150 ms old. It
/// predicts 16 points, 50 ms apart.
#[test]
fn chunks_of_a_slow_policy_become_one_smooth_motion() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let begin = lockstep.client.state.message_id;
        let sine = |time: f64| 0.05 * (1.0 - (2.0 * time).cos());
        let predicted = |time: f64| {
            let mut q = <[f64; 7]>::from(READY);
            q[0] += sine(time);
            q
        };
        let mut worst: f64 = 0.0;
        for call in 0..60 {
            let now = lockstep.client.state.message_id;
            let observed = now.saturating_sub(150).max(begin);
            let since = (observed - begin) as f64 * 1e-3;
            let points = (0..16).map(|i| {
                let offset = Duration::from_millis(50 * i);
                (offset, predicted(since + offset.as_secs_f64()))
            });
            let chunk = Chunk::joints(points).unwrap().observed_at(observed);
            lockstep.chunk(engaged, chunk).unwrap();
            for _ in 0..100 {
                lockstep.tick();
                let time = (lockstep.client.record.time - begin) as f64 * 1e-3;
                if call >= 10 {
                    worst = worst.max((lockstep.robot.q()[0] - READY[0] - sine(time)).abs());
                }
            }
        }
        println!("off by {worst} rad at most");
        assert!(worst < 4e-3, "{worst} rad");
        // A pose supersedes the last chunk.
        let pose = up(&lockstep, 0.05);
        let goal = lockstep
            .within(engaged, Target::Pose(pose), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.until_resolved(goal, 6000).unwrap();
        let stale = Chunk::joints([(Duration::ZERO, predicted(0.0))]).unwrap();
        let late = lockstep.chunk(engaged, stale.observed_at(begin));
        assert!(
            matches!(late, Err(MotionError::Goal(GoalError::Late { .. }))),
            "{late:?}"
        );
    });
}

#[test]
fn chunk_of_another_clock_or_an_older_origin_is_refused() {
    let mut lockstep = Lockstep::ready();
    let engaged = lockstep.engage();
    lockstep.run(500);
    let now = lockstep.client.state.message_id;
    let chunk = |rad| Chunk::joints([(Duration::from_secs(2), turned_q(rad))]).unwrap();
    let mut refused = |observed_at, rad| {
        let sent = lockstep.chunk(engaged, chunk(rad).observed_at(observed_at));
        lockstep.run(1);
        sent.err().map(|error| error.to_string())
    };
    let ahead = "the chunk's time origin is 60001 ms after the robot's newest state, \
                 expected 60000 ms at most: pass times of the robot's clock";
    assert_eq!(refused(now + 60_001, 0.3).as_deref(), Some(ahead));
    assert_eq!(refused(now, 0.2), None);
    let outdated = "the chunk's observation is 250 ms older than the observation of the active \
        chunk, expected a newer observation";
    assert_eq!(refused(now - 250, 0.3).as_deref(), Some(outdated));
    assert_eq!(refused(now, 0.1), None, "the same observation");
    lockstep.run(4000);
    assert!((lockstep.robot.q()[0] - turned_q(0.1)[0]).abs() < 1e-3);
    // The chunks after another goal have none before them.
    let goal = lockstep
        .within(engaged, turned(0.0), OnArrival::ReportAndHold)
        .unwrap();
    lockstep.until_resolved(goal, 5000).unwrap();
    let late = Chunk::joints([(Duration::from_secs(60), turned_q(0.1))]).unwrap();
    lockstep
        .chunk(engaged, late.observed_at(now - 250))
        .unwrap();
}

#[test]
fn velocities_that_no_robot_allows_are_refused() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let at = |k: u32| Duration::from_millis(100) * k;
        let dq = [0.0, 0.0, -50.0, 0.0, 0.0, 0.0, 0.0];
        let joints = Chunk::joints_with_velocities((1..9).map(|k| (at(k), READY.into(), dq)));
        let error = lockstep.chunk(engaged, joints.unwrap()).unwrap_err();
        let text = error.to_string();
        assert!(
            text.starts_with("joint speed of the target is 50 rad/s, expected between 0 and 2."),
            "{text}"
        );
        let pose = lockstep.arm_pose();
        for (twist, expected) in [
            (
                [0.0, -50.0, 0.0, 0.0, 0.0, 0.0],
                "speed of the target is 50 m/s, expected between 0 and ",
            ),
            (
                [0.0, 0.0, 0.0, 0.0, 0.0, 50.0],
                "angular speed of the target is 50 rad/s, expected between 0 and ",
            ),
        ] {
            let poses = Chunk::poses_with_twists((1..9).map(|k| (at(k), pose, twist)));
            let error = lockstep.chunk(engaged, poses.unwrap()).unwrap_err();
            assert!(error.to_string().starts_with(expected), "{error}");
        }
    });
}
