//! Corner cases of sessions: orders that meet a cancelled goal, and the end of a session without
//! its deadman.

use std::time::Duration;

use super::{chunk, guarded, turned, turned_q, watched};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_rt::law::Gains;
use franka_rt::lifecycle::{MotionError, Tuning};
use franka_rt::session::{Budget, Free, GoalId, Lapse, OnArrival, OnTimeout, Target};

fn give_chunk(lockstep: &mut Lockstep, engaged: GoalId, from: f64, to: f64) -> GoalId {
    let goal = lockstep.goal(Target::Rest, OnArrival::Hold);
    lockstep
        .submit_chunk(engaged, goal, chunk(from, to))
        .expect("near the ready pose")
}

#[test]
fn a_chunk_after_cancelled_chunks_is_a_new_goal() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let first = give_chunk(&mut lockstep, engaged, 0.0, 0.2);
        lockstep.run(200);
        lockstep.cancel(first);
        lockstep.run(10);
        let second = give_chunk(&mut lockstep, engaged, 0.0, 0.1);
        let superseded = lockstep.until_resolved(first, 1);
        assert_eq!(superseded, Err(MotionError::Superseded));
        lockstep.run(2000);
        assert_eq!(lockstep.client.outcome(second), None);
        assert!((lockstep.robot.q()[0] - turned_q(0.1)[0]).abs() < 2e-3);
    });
}

#[test]
fn a_session_can_be_tuned_while_a_goal_is_cancelled() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep
            .within(engaged, turned(0.3), OnArrival::ReportAndHold)
            .expect("near the ready pose");
        lockstep.run(300);
        lockstep.cancel(goal);
        let gains = Gains {
            feedforward_cutoff: 50.0,
            ..Gains::joint()
        };
        let tuning = Tuning {
            gains: Some(gains),
            budget: None,
            ..Tuning::default()
        };
        assert_eq!(lockstep.tune(engaged, tuning), Ok(()));
        let outcome = lockstep.until_resolved(goal, 2000);
        assert_eq!(outcome, Err(MotionError::Stopped));
    });
}

#[test]
fn session_outlives_a_stream_that_would_end_a_motion() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = watched(&mut lockstep, turned(0.2), 50, OnTimeout::Brake);
        let goal = lockstep.submit_within(engaged, goal).expect("it is near");
        let outcome = lockstep.until_resolved(goal, 3000);
        assert!(
            matches!(outcome, Err(MotionError::Braked(Lapse::Silent { .. }))),
            "{outcome:?}"
        );
        lockstep.run(1000);
        assert_eq!(lockstep.client.outcome(engaged), None);
        let back = lockstep
            .within(engaged, turned(0.0), OnArrival::ReportAndHold)
            .expect("the session goes on");
        lockstep
            .until_resolved(back, 5000)
            .expect("nothing stops it");
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).expect("as asked");
    });
}

#[test]
fn a_session_can_be_stopped_and_ended_without_its_deadman() {
    for_each_robot(|ready| {
        for stops in [true, false] {
            let (mut lockstep, engaged, token) = guarded(ready, 50);
            drop(token);
            lockstep.run(500);
            if stops {
                let stop = lockstep.stop().expect("a session runs");
                lockstep.until_resolved(stop, 1000).expect("it rests");
                let stopped = lockstep.until_resolved(engaged, 1);
                assert_eq!(stopped, Err(MotionError::Stopped));
            } else {
                lockstep.disengage(engaged);
                lockstep.until_resolved(engaged, 1000).expect("as asked");
            }
        }
    });
}

#[test]
fn a_session_ends_as_asked_even_if_its_last_goal_is_cancelled() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let last = lockstep
            .within(engaged, turned(0.2), OnArrival::ReportAndFinish)
            .expect("near the ready pose");
        lockstep.run(100);
        let more = lockstep.within(engaged, Target::Rest, OnArrival::ReportAndHold);
        assert_eq!(more, Err(MotionError::Disengaged));
        lockstep.cancel(last);
        lockstep.client.lifecycle.close(last);
        let more = lockstep.within(engaged, Target::Rest, OnArrival::ReportAndHold);
        assert_eq!(more, Err(MotionError::Disengaged), "as it was told before");
        for ended in [last, engaged] {
            let outcome = lockstep.until_resolved(ended, 1500);
            assert_eq!(outcome, Err(MotionError::Stopped));
        }
    });
}

#[test]
fn stop_during_the_end_of_a_session_resolves_everything() {
    for_each_robot(|ready| {
        let mut late = 0;
        // While the motion ends: its states are lost, so that the stop is not seen before the end.
        for wait in 0..150 {
            let mut lockstep = ready();
            let engaged = lockstep.engage();
            let goal = lockstep
                .within(engaged, Target::Rest, OnArrival::ReportAndFinish)
                .expect("there is nothing to it");
            lockstep.run(100 + wait);
            let before = lockstep.client.outcome(goal).is_some();
            let Some(stop) = lockstep.stop() else {
                continue;
            };
            late += u64::from(!before);
            lockstep.until_resolved(stop, 2000).expect("it rests");
            for ended in [goal, engaged] {
                let outcome = lockstep.client.outcome(ended);
                assert!(outcome.is_some(), "{wait}: {ended:?} is resolved");
            }
        }
        assert!(late > 10, "{late}");
    });
}

#[test]
fn a_chunk_goes_on_when_its_budget_is_tuned() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        give_chunk(&mut lockstep, engaged, 0.0, 0.2);
        lockstep.run(200);
        let slow = lockstep
            .goal(Target::Rest, OnArrival::Hold)
            .budget
            .scaled(0.5);
        let budget = |budget: Budget| Tuning {
            budget: Some(budget),
            ..Tuning::default()
        };
        assert_eq!(lockstep.tune(engaged, budget(slow)), Ok(()));
        let most = slow.joints[0].velocity;
        lockstep.run(150);
        let dq = lockstep.client.record.dq_ref[0];
        assert!(dq > 0.9 * most && dq < 1.05 * most, "{dq} of {most} rad/s");
        // The velocity holds, so the last point is reached later.
        lockstep.run(250);
        assert!(lockstep.robot.q()[0] < turned_q(0.19)[0], "it is late");
        assert_eq!(lockstep.tune(engaged, budget(slow.scaled(1.5))), Ok(()));
        lockstep.run(2000);
        assert!((lockstep.robot.q()[0] - turned_q(0.2)[0]).abs() < 2e-3);
    });
}

#[test]
fn an_aborted_goal_at_rest_is_not_resumed() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = watched(&mut lockstep, turned(0.05), 50, OnTimeout::Hold);
        let goal = lockstep.submit_within(engaged, goal).unwrap();
        // The goal settles, and the next target is sent before the lifecycle knows.
        lockstep.client.lifecycle_is_paused = true;
        lockstep.run(2000);
        let next = turned(0.2);
        assert_eq!(lockstep.update(goal, next), Ok(true));
        lockstep.run(500);
        lockstep.client.lifecycle_is_paused = false;
        let outcome = lockstep.until_resolved(goal, 10);
        assert!(matches!(outcome, Err(MotionError::Held(_))), "{outcome:?}");
        assert!((lockstep.robot.q()[0] - turned_q(0.05)[0]).abs() < 2e-3);
    });
}

#[test]
fn guiding_that_times_out_is_braked_and_reported() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let silence = Duration::from_millis(50);
        let goal = watched(&mut lockstep, Target::Guide(Free::ALL), 50, OnTimeout::Hold);
        let goal = lockstep.submit_within(engaged, goal).unwrap();
        let outcome = lockstep.until_resolved(goal, 2000);
        let braked = MotionError::Braked(Lapse::Silent { silence });
        assert_eq!(outcome, Err(braked));
    });
}
