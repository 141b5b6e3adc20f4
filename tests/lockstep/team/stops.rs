//! The stop of a team, and the motions after it.

use std::time::Duration;

use franka_lockstep::turned;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::condition::elapsed;
use franka_rt::session::{Goal, Lapse, OnArrival};
use franka_rt::team::TeamStop;

use super::Pair;

#[test]
fn a_stop_from_outside_brakes_all_and_the_next_motion_begins() {
    let mut pair = Pair::new(false);
    let goals = pair.both([0.6, 0.6]);
    pair.run(500);
    pair.coordinator.stop();
    let stopped = pair.ticks;
    pair.run(2);
    for braked in pair.braked {
        let braked = braked.expect("each brakes");
        assert!(braked <= stopped + 2, "{braked}, {stopped}");
    }
    let requested = Err(MotionError::Braked(Lapse::Team(TeamStop::Requested)));
    let ended = pair.until_resolved(goals, 3000);
    assert_eq!(ended, [requested.clone(), requested]);
    let goals = pair.both([0.1, 0.1]);
    assert_eq!(pair.until_resolved(goals, 20_000), [Ok(()), Ok(())]);
}

/// As by a program that sets goals in a loop, with the stop of a person in between.
#[test]
fn stop_survives_a_round_that_begins_before_arms_look() {
    for swapped in [false, true] {
        let mut pair = Pair::new(swapped);
        let older = pair.both([0.6, 0.6]);
        pair.run(500);
        pair.coordinator.stop();
        let (stopped, at) = (pair.ticks, [0, 1].map(|i| pair.moved(i)));
        let newer = pair.both([-0.6, -0.6]);
        pair.run(2);
        for braked in pair.braked {
            assert!(braked.is_some_and(|braked| braked <= stopped + 2));
        }
        let requested = || Err(MotionError::Braked(Lapse::Team(TeamStop::Requested)));
        assert_eq!(pair.until_resolved(newer, 3000), [requested(), requested()]);
        let superseded = || Err(MotionError::Superseded);
        assert_eq!(pair.until_resolved(older, 1), [superseded(), superseded()]);
        pair.run(1000);
        for member in [0, 1] {
            let further = pair.moved(member) - at[member];
            assert!((0.0..0.2).contains(&further), "member {member}: {further}");
        }
        let goals = pair.both([0.1, 0.1]);
        assert_eq!(pair.until_resolved(goals, 20_000), [Ok(()), Ok(())]);
    }
}

/// A joint motion that is dropped, and the next one immediately after it.
#[test]
fn a_motion_taken_back_does_not_stop_the_motion_that_follows() {
    let mut pair = Pair::new(false);
    let round = pair.coordinator.begin();
    for member in [0, 1] {
        pair.submit(member, Some(round), turned(0.6));
    }
    pair.run(500);
    pair.coordinator.take_back(round);
    let goals = pair.both([0.1, 0.1]);
    assert_eq!(pair.until_resolved(goals, 20_000), [Ok(()), Ok(())]);
}

#[test]
fn no_target_that_comes_after_a_stop_sets_an_arm_in_motion() {
    for after in [0, 1, 50, 1000] {
        let mut pair = Pair::new(false);
        let round = Some(pair.coordinator.begin());
        let streams = [0, 1].map(|i| {
            let goal = pair.robots[i].goal(turned(0.6), OnArrival::Hold);
            pair.submit_goal(i, Goal { round, ..goal })
        });
        pair.run(700);
        pair.coordinator.stop();
        pair.run(after);
        for ms in 0..1500 {
            if ms % 10 == 0 {
                for (robot, stream) in pair.robots.iter_mut().zip(streams) {
                    let further = turned(0.6 + 1e-4 * f64::from(ms));
                    robot.update(stream, further).expect("within reach");
                }
            }
            pair.tick();
        }
        assert!(pair.moved(0) < 0.5 && pair.moved(1) < 0.5, "{after} ms");
        let requested = Err(MotionError::Braked(Lapse::Team(TeamStop::Requested)));
        let ended = pair.until_resolved(streams, 3000);
        assert_eq!(ended, [requested.clone(), requested], "{after} ms");
    }
}

/// Conditions that come true while the arms begin to brake, brake, and are at rest.
#[test]
fn condition_met_after_a_stop_moves_no_arm() {
    for after in [3, 50, 150, 400] {
        let mut pair = Pair::new(false);
        let round = Some(pair.coordinator.begin());
        let due = elapsed(Duration::from_millis(700 + after)).then(turned(-0.3));
        let goals = [0, 1].map(|i| Goal {
            round,
            reaction: Some(due),
            ..pair.robots[i].goal(turned(1.0), OnArrival::ReportAndHold)
        });
        let goals = [0, 1].map(|i| pair.submit_goal(i, goals[i]));
        let goes = |pair: &Pair| {
            let record = |i: usize| &pair.robots[i].client.record;
            let begun = |i: usize| record(i).goal == goals[i].0;
            let elapsed = record(0).elapsed.min(record(1).elapsed);
            begun(0) && begun(1) && elapsed >= Duration::from_millis(700)
        };
        while !goes(&pair) {
            pair.tick();
            assert!(pair.ticks < 5000, "they begin");
        }
        pair.coordinator.stop();
        pair.run(2000);
        let requested = Err(MotionError::Braked(Lapse::Team(TeamStop::Requested)));
        let ended = pair.until_resolved(goals, 1);
        assert_eq!(ended, [requested.clone(), requested], "{after} ms");
        for member in [0, 1] {
            assert!(pair.moved(member) > 0.1, "{}", pair.moved(member));
        }
    }
}

/// It has arrived, and its spring is released: nothing is left to brake.
#[test]
fn finishing_motion_ends_unchanged_when_the_team_stops() {
    let mut pair = Pair::new(false);
    let last = pair.robots[0].goal(turned(0.02), OnArrival::ReportAndFinish);
    let last = pair.submit_goal(0, last);
    let mut released = 0;
    while pair.robots[0].client.outcome(last).is_none() {
        pair.tick();
        assert!(pair.ticks < 5000, "it never ends");
        let record = &pair.robots[0].client.record;
        released += u64::from(record.goal == last.0 && record.remaining.is_zero());
        if released == 400 {
            pair.coordinator.stop();
        }
    }
    assert!(released > 400, "{released}");
    let ended = pair.robots[0].until_resolved(last, 1);
    assert_eq!(ended.map(drop), Ok(()));
}
