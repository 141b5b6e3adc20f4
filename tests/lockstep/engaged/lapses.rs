//! Goals aborted because their stream or the deadman timed out.

use std::time::Duration;

use super::{assert_stays, guarded, turned, turned_q, watched};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::{READY, Wrench};
use franka_rt::lifecycle::{MotionError, Tuning};
use franka_rt::session::{Chunk, Free, GoalId, Guard, Lapse, OnArrival, OnTimeout, Target};

/// Runs a session whose stream times out, and returns it with the stream's outcome.
fn silent_stream(
    ready: &dyn Fn() -> Lockstep,
    on_timeout: OnTimeout,
) -> (Lockstep, GoalId, MotionError) {
    let mut lockstep = ready();
    let engaged = lockstep.engage();
    let goal = watched(&mut lockstep, turned(0.01), 100, on_timeout);
    let goal = lockstep.submit_within(engaged, goal).unwrap();
    for step in 2..12 {
        lockstep.run(90);
        assert_eq!(lockstep.client.outcome(goal), None);
        let taken = lockstep.update(goal, turned(0.06 * f64::from(step)));
        assert_eq!(taken, Ok(true));
    }
    let error = lockstep.until_resolved(goal, 5000).unwrap_err();
    assert!(lockstep.client.record.bindings.contains(Guard::Watchdog));
    assert_eq!(lockstep.update(goal, turned(0.0)), Ok(false));
    (lockstep, engaged, error)
}

#[test]
fn stream_timeout_holds_or_brakes_as_the_outcome_says() {
    for_each_robot(|ready| {
        let silence = Duration::from_millis(100);
        let lapse = Lapse::Silent { silence };
        let last = READY[0] + 0.66;

        let (mut lockstep, engaged, error) = silent_stream(ready, OnTimeout::Hold);
        assert_eq!(error, MotionError::Held(lapse));
        assert!(
            (lockstep.robot.q()[0] - last).abs() < 2e-3,
            "at the last target"
        );
        assert_stays(&mut lockstep, engaged);

        let (mut lockstep, engaged, error) = silent_stream(ready, OnTimeout::Brake);
        assert_eq!(error, MotionError::Braked(lapse));
        assert!((lockstep.robot.q()[0] - last).abs() > 0.02, "short of it");
        assert_stays(&mut lockstep, engaged);
        // The session still accepts goals.
        let goal = lockstep
            .within(engaged, turned(0.0), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.until_resolved(goal, 5000).unwrap();
    });
}

/// A target that equals the previous one counts too, until the arm rests.
#[test]
fn a_repeated_target_resumes_a_stream_that_timed_out() {
    for_each_robot(|ready| {
        for on_timeout in [OnTimeout::Hold, OnTimeout::Brake] {
            for wait in (102..160).step_by(10) {
                let mut lockstep = ready();
                let engaged = lockstep.engage();
                let target = turned(0.3);
                let goal = watched(&mut lockstep, target, 100, on_timeout);
                let goal = lockstep.submit_within(engaged, goal).unwrap();
                let what = format!("{on_timeout:?}, repeated after {wait} ms");
                lockstep.run(wait);
                let bindings = lockstep.client.record.bindings;
                assert!(bindings.contains(Guard::Watchdog), "{what}");
                for _ in 0..50 {
                    assert_eq!(lockstep.update(goal, target), Ok(true), "{what}");
                    lockstep.run(50);
                    let bindings = lockstep.client.record.bindings;
                    assert!(!bindings.contains(Guard::Watchdog), "{what}");
                }
                let short = (READY[0] + 0.3 - lockstep.robot.q()[0]).abs();
                assert!(short < 2e-3, "{what}: {short} rad short of the target");
            }
        }
    });
}

#[test]
fn deadman_timeout_holds_the_arm_until_kept_alive_again() {
    for_each_robot(|ready| {
        let (mut lockstep, engaged, token) = guarded(ready, 50);
        let goal = lockstep
            .within(engaged, turned(0.3), OnArrival::ReportAndHold)
            .unwrap();
        for _ in 0..10 {
            lockstep.run(40);
            token.keep_alive();
        }
        let held = MotionError::Held(Lapse::Deadman);
        assert_eq!(lockstep.until_resolved(goal, 1000), Err(held.clone()));
        assert!(lockstep.client.record.bindings.contains(Guard::Deadman));
        assert!(lockstep.robot.q()[0] < READY[0] + 0.25, "short of the goal");
        assert_refused(&mut lockstep, engaged, &held);
        assert_stays(&mut lockstep, engaged);

        token.keep_alive();
        let goal = lockstep
            .within(engaged, turned(0.3), OnArrival::ReportAndHold)
            .unwrap();
        for _ in 0..200 {
            token.keep_alive();
            lockstep.run(20);
        }
        lockstep.until_resolved(goal, 1).unwrap();

        drop(token);
        let goal = lockstep
            .within(engaged, turned(0.0), OnArrival::ReportAndHold)
            .unwrap();
        assert_eq!(lockstep.until_resolved(goal, 1000), Err(held.clone()));
        assert_refused(&mut lockstep, engaged, &held);
        let rest = lockstep
            .within(engaged, Target::Rest, OnArrival::ReportAndHold)
            .unwrap();
        lockstep.until_resolved(rest, 1000).unwrap();
    });
}

/// Asserts that motions are refused, a goal as well as a chunk.
fn assert_refused(lockstep: &mut Lockstep, engaged: GoalId, held: &MotionError) {
    let goal = lockstep.within(engaged, turned(0.3), OnArrival::ReportAndHold);
    assert_eq!(goal.as_ref(), Err(held));
    let chunk = Chunk::joints([(Duration::from_secs(1), turned_q(0.3))]).unwrap();
    assert_eq!(lockstep.chunk(engaged, chunk).as_ref(), Err(held));
}

#[test]
fn a_deadman_timeout_ends_a_stream_with_targets_at_any_rate() {
    for_each_robot(|ready| {
        for period in [1, 20, 90] {
            let (mut lockstep, engaged, token) = guarded(ready, 50);
            let goal = lockstep
                .within(engaged, turned(0.3), OnArrival::Hold)
                .unwrap();
            for _ in 0..10 {
                token.keep_alive();
                lockstep.run(40);
            }
            let mut updates = 0_u32;
            while lockstep.client.outcome(goal).is_none() {
                lockstep.run(period);
                updates += 1;
                let target = turned(0.3 + 1e-3 * f64::from(updates % 2));
                lockstep.update(goal, target).expect("near the ready pose");
                let waited = period * u64::from(updates);
                assert!(waited < 2000, "{period} ms: it goes on");
            }
            let outcome = lockstep.until_resolved(goal, 1);
            assert_eq!(outcome, Err(MotionError::Held(Lapse::Deadman)));
            token.keep_alive();
            assert_eq!(lockstep.update(goal, turned(0.3)), Ok(false));
            assert_stays(&mut lockstep, engaged);
        }
    });
}

/// Tunes the session to its present gains and budget, as a program does that tunes all the time.
fn same_again(lockstep: &mut Lockstep, engaged: GoalId, budget: f64) {
    let goal = lockstep.goal(turned(0.0), OnArrival::Hold);
    let tuning = Tuning {
        gains: Some(goal.gains),
        budget: Some(goal.budget.scaled(budget)),
        ..Tuning::default()
    };
    lockstep.tune(engaged, tuning).expect("within its bounds");
}

#[test]
fn tuning_does_not_keep_a_silent_stream_alive() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let silence = Duration::from_millis(100);
        let goal = watched(&mut lockstep, turned(0.8), 100, OnTimeout::Brake);
        let goal = lockstep.submit_within(engaged, goal).unwrap();
        let mut tuned = 0;
        // Also while the arm brakes, after the stream is aborted.
        while lockstep.client.outcome(goal).is_none() {
            lockstep.run(20);
            tuned += 1;
            same_again(&mut lockstep, engaged, [1.0, 0.9][tuned % 2]);
            assert!(tuned < 50, "it goes on");
        }
        let outcome = lockstep.until_resolved(goal, 1);
        let braked = MotionError::Braked(Lapse::Silent { silence });
        assert_eq!(outcome, Err(braked));
    });
}

/// Tuning rewrites the target that holds the arm.
#[test]
fn a_stream_that_was_closed_is_watched_no_more() {
    let mut lockstep = Lockstep::ready();
    let engaged = lockstep.engage();
    let stream = watched(&mut lockstep, turned(0.05), 3000, OnTimeout::Brake);
    let stream = lockstep.submit_within(engaged, stream).unwrap();
    lockstep.run(20);
    lockstep.client.lifecycle.close(stream);
    lockstep.until_resolved(stream, 3000).unwrap();
    lockstep.tune(engaged, Tuning::default()).unwrap();
    for _ in 0..5000 {
        lockstep.tick();
        let bindings = lockstep.client.record.bindings;
        assert!(!bindings.contains(Guard::Watchdog), "{bindings:?}");
    }
    assert_stays(&mut lockstep, engaged);
}

#[test]
fn tuning_does_not_resume_an_aborted_goal() {
    for_each_robot(|ready| {
        let (mut lockstep, engaged, error) = silent_stream(ready, OnTimeout::Brake);
        assert!(matches!(error, MotionError::Braked(_)));
        lockstep.run(100);
        let at = lockstep.robot.q()[0];
        assert!((READY[0] + 0.66 - at).abs() > 0.02, "short of it");
        same_again(&mut lockstep, engaged, 0.5);
        lockstep.run(2000);
        let now = lockstep.robot.q()[0];
        assert!((now - at).abs() < 1e-3, "from {at} to {now}");
    });
}

/// Asserts that the arm resists a push of 8 N, which the light damping of a guided arm does not.
fn assert_firm(lockstep: &mut Lockstep) {
    let before = lockstep.arm_pose();
    let push = Wrench::new(0.0, 8.0, 0.0, 0.0, 0.0, 0.0);
    lockstep.robot.push_end_effector(push, 1500);
    lockstep.run(1500);
    let moved = lockstep.arm_pose().translation.y - before.translation.y;
    assert!(moved < 0.012, "{moved} m");
}

#[test]
fn a_guided_arm_is_held_firmly_once_its_deadman_is_dropped() {
    for_each_robot(|ready| {
        let (mut lockstep, engaged, token) = guarded(ready, 5000);
        let guided = Target::Guide(Free::ALL);
        let goal = lockstep.within(engaged, guided, OnArrival::Hold).unwrap();
        lockstep.run(1000);
        drop(token);
        let held = Err(MotionError::Held(Lapse::Deadman));
        assert_eq!(lockstep.until_resolved(goal, 1000), held);
        lockstep.run(500);
        assert_firm(&mut lockstep);
    });
}

#[test]
fn guiding_stream_leaves_the_hold_of_a_deadman_firm() {
    for_each_robot(|ready| {
        let (mut lockstep, engaged, token) = guarded(ready, 50);
        let guided = Target::Guide(Free::ALL);
        let goal = lockstep.within(engaged, guided, OnArrival::Hold).unwrap();
        for _ in 0..20 {
            token.keep_alive();
            lockstep.run(40);
        }
        while lockstep.client.outcome(goal).is_none() {
            lockstep.run(10);
            lockstep
                .update(goal, guided)
                .expect("any arm can be guided");
        }
        let outcome = lockstep.until_resolved(goal, 1);
        assert_eq!(outcome, Err(MotionError::Held(Lapse::Deadman)));
        lockstep.run(500);
        assert_firm(&mut lockstep);
    });
}

#[test]
fn tuning_does_not_soften_the_hold_after_guiding_timed_out() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = watched(
            &mut lockstep,
            Target::Guide(Free::ALL),
            100,
            OnTimeout::Brake,
        );
        let goal = lockstep.submit_within(engaged, goal).unwrap();
        let silence = Duration::from_millis(100);
        let braked = Err(MotionError::Braked(Lapse::Silent { silence }));
        lockstep.run(150);
        assert_eq!(lockstep.client.outcome(goal), None, "it brakes");
        same_again(&mut lockstep, engaged, 0.9);
        assert_eq!(lockstep.until_resolved(goal, 1000), braked);
        lockstep.run(500);
        assert_firm(&mut lockstep);
    });
}
