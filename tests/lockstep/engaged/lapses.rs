//! Goals that are given up: their stream is silent, or the deadman is.

use std::time::Duration;

use super::{assert_stays, turned};
use franka_model::READY;
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{Deadman, Goal, GoalId, Guard, Lapse, Stale, Then, Watchdog};
use franka_tests::lockstep::{Lockstep, for_each_robot};

/// A session that follows a stream which falls silent, and how that ends.
fn silent_stream(ready: &dyn Fn() -> Lockstep, stale: Stale) -> (Lockstep, GoalId, MotionError) {
    let mut lockstep = ready();
    let engaged = lockstep.engage();
    let goal = Goal {
        watchdog: Some(Watchdog {
            silence: Duration::from_millis(100),
            stale,
        }),
        ..lockstep.goal(turned(0.01), Then::Hold)
    };
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
fn a_stream_that_falls_silent_is_held_or_braked_and_the_outcome_says_which() {
    for_each_robot(|ready| {
        let silence = Duration::from_millis(100);
        let lapse = Lapse::Silent { silence };
        let last = READY[0] + 0.66;

        let (mut lockstep, engaged, error) = silent_stream(ready, Stale::Hold);
        assert_eq!(error, MotionError::Held(lapse));
        assert!(
            (lockstep.robot.q()[0] - last).abs() < 2e-3,
            "at the last target"
        );
        assert_stays(&mut lockstep, engaged);

        let (mut lockstep, engaged, error) = silent_stream(ready, Stale::Brake);
        assert_eq!(error, MotionError::Braked(lapse));
        assert!((lockstep.robot.q()[0] - last).abs() > 0.02, "short of it");
        assert_stays(&mut lockstep, engaged);
        // The session is as good as before.
        let goal = lockstep.within(engaged, turned(0.0), Then::Stay).unwrap();
        lockstep.until_resolved(goal, 5000).unwrap();
    });
}

#[test]
fn a_silent_deadman_holds_the_arm_until_it_lives_again() {
    for_each_robot(|ready| {
        let (token, grip) = Deadman::new(Duration::from_millis(50));
        let mut lockstep = ready();
        let engaged = lockstep.engage_with(Engagement {
            deadman: Some(grip),
            ..Engagement::default()
        });
        let goal = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        for _ in 0..10 {
            lockstep.run(40);
            token.keep_alive();
        }
        let held = Err(MotionError::Held(Lapse::Deadman));
        assert_eq!(lockstep.until_resolved(goal, 1000), held);
        assert!(lockstep.client.record.bindings.contains(Guard::Deadman));
        assert!(lockstep.robot.q()[0] < READY[0] + 0.25, "short of the goal");
        let another = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        assert_eq!(lockstep.until_resolved(another, 1000), held);
        assert_stays(&mut lockstep, engaged);

        let goal = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        for _ in 0..200 {
            token.keep_alive();
            lockstep.run(20);
        }
        lockstep.until_resolved(goal, 1).unwrap();

        drop(token);
        let goal = lockstep.within(engaged, turned(0.0), Then::Stay).unwrap();
        assert_eq!(lockstep.until_resolved(goal, 1000), held);
    });
}
