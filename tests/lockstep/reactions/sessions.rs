//! Reactions in a session that continues, and of goals that follow a stream.

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::RobotKind;
use franka_rt::law::Gains;
use franka_rt::lifecycle::{Engagement, MotionError, Tuning};
use franka_rt::session::condition::{Axis, Quantity, contact, elapsed, force_z};
use franka_rt::session::{
    Deadman, Free, Goal, GoalId, Lapse, Lead, OnArrival, OnTimeout, Target, Watchdog,
};
use franka_sim::Touch;
use nalgebra::{Translation3, Vector3};

use super::{MS, above, at, felt, goes_on, reacted, realistic, report, says_so, table};

/// An engaged arm that has met a table 3 cm below and rests on it.
fn on_a_table(seed: u64) -> (Lockstep, GoalId, franka_sim::TouchId) {
    let mut lockstep = realistic(RobotKind::Fr3, seed);
    let engaged = lockstep.engage();
    let table = table(&mut lockstep, 0.03, 5000.0);
    let down = above(&lockstep, -0.1);
    let touched = force_z(8.0).relative();
    let goal = at(0.05, down, touched, OnArrival::ReportAndHold, &mut lockstep);
    let goal = lockstep.submit_within(engaged, goal).expect("within reach");
    reacted(&mut lockstep, goal);
    (lockstep, engaged, table)
}

/// The force continues; its condition belonged to the previous goal.
#[test]
fn arm_after_a_reaction_is_tuned_and_moved_like_a_held_one() {
    let (mut lockstep, engaged, table) = on_a_table(2);
    assert!(felt(&lockstep, table) > 1.0);
    let tuning = Tuning {
        gains: Some(
            Gains::cartesian().with_cartesian_stiffness([500.0, 500.0, 500.0, 30.0, 30.0, 30.0]),
        ),
        ..Tuning::default()
    };
    lockstep.tune(engaged, tuning).expect("sound gains");
    let rests = lockstep.reference_pose().translation.vector;
    for _ in 0..3000 {
        lockstep.tick();
        let moved = lockstep.reference_pose().translation.vector - rests;
        assert!(moved.norm() < 1e-4, "{moved}");
        assert!(felt(&lockstep, table) < 8.0);
    }
    // Along the table, which it still feels.
    let along = (Translation3::new(0.0, 0.03, 0.0) * lockstep.reference_pose()).into();
    let goal = lockstep.within(engaged, along, OnArrival::ReportAndHold);
    let goal = goal.expect("within reach");
    while goes_on(&lockstep, goal) {
        lockstep.tick();
        assert!(!says_so(&lockstep));
    }
    assert!(!matches!(lockstep.client.outcome(goal), Some(Ok(report)) if report.reacted.is_some()));
    lockstep.disengage(engaged);
    lockstep.until_resolved(engaged, 2000).expect("it ends");
}

/// An arm that waits at its other target is tuned there.
#[test]
fn an_engaged_arm_is_held_at_its_other_target() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let home = lockstep.arm_pose();
        let aside = Translation3::new(0.0, 0.05, 0.02) * home;
        let due = elapsed(400 * MS).then(aside);
        let up = above(&lockstep, 0.1);
        let goal = at(0.3, up, due, OnArrival::ReportAndHold, &mut lockstep);
        let goal = lockstep.submit_within(engaged, goal).expect("within reach");
        assert!(report(&mut lockstep, goal).reacted.is_some());
        let tuning = Tuning {
            gains: Some(Gains::cartesian()),
            ..Tuning::default()
        };
        for _ in 0..3 {
            lockstep.tune(engaged, tuning).expect("sound gains");
            lockstep.run(300);
            let off = lockstep.arm_pose().translation.vector - aside.translation.vector;
            assert!(off.norm() < 2e-3, "{off}");
        }
        assert_eq!(lockstep.client.outcome(engaged), None);
    });
}

/// Tuning rewrites the target that holds the arm.
#[test]
fn the_condition_of_a_goal_ends_with_it() {
    for_each_robot(|ready| {
        for cancelled in [false, true] {
            let mut lockstep = ready();
            let engaged = lockstep.engage();
            let home = lockstep.arm_pose();
            let up = above(&lockstep, 0.1);
            let late = elapsed(2500 * MS).then(home);
            let goal = at(0.3, up, late, OnArrival::ReportAndHold, &mut lockstep);
            let goal = lockstep.submit_within(engaged, goal).expect("within reach");
            if cancelled {
                lockstep.run(500);
                lockstep.cancel(goal);
            }
            let outcome = lockstep.until_resolved(goal, 2000);
            assert_eq!(outcome.is_err(), cancelled);
            let rests = lockstep.reference_pose().translation.vector;
            let tuning = Tuning {
                gains: Some(Gains::cartesian()),
                ..Tuning::default()
            };
            lockstep.tune(engaged, tuning).expect("sound gains");
            for _ in 0..3000 {
                lockstep.tick();
                assert!(!says_so(&lockstep));
                let moved = lockstep.reference_pose().translation.vector - rests;
                assert!(moved.norm() < 1e-3, "{moved}");
            }
        }
    });
}

/// The condition of a goal that takes over in mid-motion starts with the goal.
#[test]
fn condition_counts_time_and_changes_from_its_own_goal() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let up = above(&lockstep, 0.1);
        let first = at(0.1, up, contact(), OnArrival::ReportAndHold, &mut lockstep);
        lockstep
            .submit_within(engaged, first)
            .expect("within reach");
        lockstep.run(700);
        let now = lockstep.client.state.message_id;
        let height = lockstep.arm_pose().translation.z;
        let further = Quantity::Position(Axis::Z).above(0.02).relative() & elapsed(50 * MS);
        let goal = at(0.1, up, further, OnArrival::ReportAndHold, &mut lockstep);
        let goal = lockstep.submit_within(engaged, goal).expect("within reach");
        let seen = reacted(&mut lockstep, goal);
        let went = seen.pose.translation.z - height;
        assert!((went - 0.02).abs() < 1e-3, "{went}");
        let after = u64::try_from(seen.after.as_millis()).expect("a short motion");
        assert!((after + now).abs_diff(seen.time) <= 2, "{seen:?}");
    });
}

/// A stream at 100 Hz, to a target that circles.
fn follow(lockstep: &mut Lockstep, goal: GoalId, home: &nalgebra::Isometry3<f64>) {
    if lockstep.now().is_multiple_of(10) {
        let angle = lockstep.now() as f64 * 2e-3;
        let step = Vector3::new(0.0, angle.sin(), 1.0 - angle.cos()) * 0.05;
        let target = Translation3::from(step) * home;
        lockstep.update(goal, target.into()).expect("within reach");
    }
}

#[test]
fn a_stream_ends_at_a_reaction_whatever_comes_after_it() {
    for_each_robot(|ready| {
        for then in [false, true] {
            for own in [false, true] {
                let mut lockstep = ready();
                let engaged = own.then(|| lockstep.engage());
                let home = lockstep.arm_pose();
                let due = elapsed(1500 * MS);
                let aside = Translation3::new(0.0, -0.05, 0.05) * home;
                let reaction = match then {
                    true => due.then(aside),
                    false => due.into(),
                };
                let goal = at(0.3, home.into(), reaction, OnArrival::Hold, &mut lockstep);
                let goal = Goal {
                    lead: Some(Lead {
                        translation: 0.1,
                        rotation: 0.5,
                        joints: 0.5,
                    }),
                    watchdog: Some(Watchdog {
                        silence: 100 * MS,
                        on_timeout: OnTimeout::Brake,
                    }),
                    ..goal
                };
                let goal = match engaged {
                    Some(engaged) => lockstep.submit_within(engaged, goal),
                    None => lockstep.submit(goal),
                };
                let goal = goal.expect("within reach");
                let mut braked = None;
                while goes_on(&lockstep, goal) {
                    follow(&mut lockstep, goal, &home);
                    lockstep.tick();
                    let record = &lockstep.client.record;
                    if says_so(&lockstep) && record.dq_ref == [0.0; 7] {
                        braked.get_or_insert(record.time);
                    }
                }
                let report = report(&mut lockstep, goal);
                let seen = report.reacted.expect("in mid-stream");
                assert_eq!(seen.after, 1500 * MS);
                let braked = braked.expect("it brakes first") - seen.time;
                assert!(braked < 250, "{braked} ms");
                assert_eq!(report.final_error.is_some(), then);
                let rests = match then {
                    true => aside.translation.vector,
                    false => seen.pose.translation.vector,
                };
                let off = lockstep.arm_pose().translation.vector - rests;
                // The arm continued while it braked.
                let most = if then { 2e-3 } else { 0.04 };
                assert!(off.norm() < most, "{off}");
            }
        }
    });
}

/// Once its stream has stopped, the arm still goes to the last target, and a contact counts.
#[test]
fn a_silent_stream_is_watched_on_its_way_to_the_last_target() {
    let mut lockstep = Lockstep::ready();
    let due = elapsed(700 * MS);
    let up = above(&lockstep, 0.15);
    let goal = at(0.2, up, due, OnArrival::Hold, &mut lockstep);
    let goal = Goal {
        watchdog: Some(Watchdog {
            silence: 100 * MS,
            on_timeout: OnTimeout::Hold,
        }),
        ..goal
    };
    let goal = lockstep.submit(goal).expect("within reach");
    let seen = reacted(&mut lockstep, goal);
    assert_eq!(seen.after, 700 * MS);
}

#[test]
fn deadman_silence_brakes_the_arm_after_a_reaction() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let (token, monitor) = Deadman::new(50 * MS);
        let engaged = lockstep.engage_with(Engagement {
            deadman: Some(monitor),
            ..Engagement::default()
        });
        let back = lockstep.arm_pose();
        let up = above(&lockstep, 0.1);
        let due = elapsed(600 * MS).then(back);
        let goal = at(0.2, up, due, OnArrival::ReportAndHold, &mut lockstep);
        let goal = lockstep.submit_within(engaged, goal).expect("within reach");
        for _ in 0..900 {
            token.keep_alive();
            lockstep.tick();
        }
        assert!(says_so(&lockstep));
        let outcome = lockstep.until_resolved(goal, 3000);
        let error = outcome.expect_err("it is held on its way");
        let MotionError::AfterReaction { reacted, error } = &error else {
            panic!("{error}");
        };
        assert_eq!(reacted.after, 600 * MS);
        assert_eq!(**error, MotionError::Held(Lapse::Deadman));
        let off = lockstep.arm_pose().translation.vector - back.translation.vector;
        assert!(off.norm() > 0.01, "{off}");
        assert!(!says_so(&lockstep), "that is not why it rests");
    });
}

/// The gains of guiding would release it.
#[test]
fn a_guided_arm_is_held_where_it_reacts() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let due = elapsed(500 * MS);
        let guide = Target::Guide(Free::ALL);
        let goal = at(0.2, guide, due, OnArrival::Hold, &mut lockstep);
        let goal = lockstep.submit_within(engaged, goal).expect("it is there");
        let push = |lockstep: &mut Lockstep| {
            let push = Touch::force(Vector3::new(0.0, 6.0, 0.0)).lasting(200);
            let before = lockstep.arm_pose().translation.vector;
            lockstep.robot.touch(push);
            lockstep.run(200);
            (lockstep.arm_pose().translation.vector - before).norm()
        };
        lockstep.run(100);
        let free = push(&mut lockstep);
        let report = report(&mut lockstep, goal);
        assert_eq!(report.reacted.expect("in time").after, 500 * MS);
        lockstep.run(1000);
        let held = push(&mut lockstep);
        println!("{free:.4} m, {held:.4} m");
        assert!(free > 0.02 && held < 0.01, "{free} m, {held} m");
    });
}

/// A goal at rest may wait for an event, too.
#[test]
fn an_arm_that_holds_may_wait_for_a_push() {
    let mut lockstep = realistic(RobotKind::Fer, 4);
    let engaged = lockstep.engage();
    let here = lockstep.arm_pose();
    let pushed = Quantity::ForceNorm.above(12.0).relative().held_for(20 * MS);
    let aside = Translation3::new(0.0, 0.05, 0.0) * here;
    let goal = at(
        0.2,
        here.into(),
        pushed.then(aside),
        OnArrival::Hold,
        &mut lockstep,
    );
    let goal = lockstep.submit_within(engaged, goal).expect("it is there");
    lockstep.run(3000);
    assert_eq!(lockstep.client.outcome(goal), None);
    let push = Touch::force(Vector3::new(-20.0, 0.0, 0.0)).lasting(150);
    lockstep.robot.touch(push);
    let report = report(&mut lockstep, goal);
    let seen = report.reacted.expect("the push");
    assert!(seen.after > Duration::from_secs(3));
    assert!(seen.wrench[0] > 8.0, "{seen:?}");
    assert!(report.final_error.is_some());
    assert_eq!(lockstep.client.outcome(engaged), None);
}

/// Nothing moves an arm that is paused, not even its reaction; a stop needs no way.
#[test]
fn paused_motion_reacts_and_resumes_to_its_other_target() {
    for_each_robot(|ready| {
        for then in [false, true] {
            let mut lockstep = ready();
            let home = lockstep.arm_pose();
            let up = above(&lockstep, 0.15);
            let due = elapsed(1000 * MS);
            let reaction = match then {
                true => due.then(home),
                false => due.into(),
            };
            let goal = at(0.2, up, reaction, OnArrival::ReportAndFinish, &mut lockstep);
            let goal = lockstep.submit(goal).expect("within reach");
            lockstep.run(500);
            lockstep.client.lifecycle.pause(goal, true);
            lockstep.run(400);
            let halted = lockstep.reference_pose().translation.z;
            if then {
                lockstep.run(2000);
                assert!(says_so(&lockstep));
                assert_eq!(lockstep.client.outcome(goal), None);
                let moved = lockstep.reference_pose().translation.z - halted;
                assert!(moved.abs() < 1e-4, "{moved} m");
                lockstep.client.lifecycle.pause(goal, false);
            }
            let report = report(&mut lockstep, goal);
            assert_eq!(report.reacted.expect("in the pause").after, 1000 * MS);
            assert_eq!(report.final_error.is_some(), then);
        }
    });
}
