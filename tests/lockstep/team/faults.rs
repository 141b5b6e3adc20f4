//! Events that brake the other arm, and events that do not.

use std::time::Duration;

use franka_lockstep::turned;
use franka_model::READY;
use franka_proto::RobotMode;
use franka_rt::driver::Driver;
use franka_rt::lifecycle::{MotionError, Tuning};
use franka_rt::session::condition::elapsed;
use franka_rt::session::{
    ForceCap, Goal, GoalId, Lapse, OnArrival, OnTimeout, Reaction, Target, Watchdog,
};
use franka_rt::team::{MemberFault, team_tolerating};
use franka_sim::Touch;
use nalgebra::{Translation3, Vector3};

use super::{Pair, stopped_by};

/// An event of the first robot, and the end of the second robot's motion.
struct Case {
    name: &'static str,
    happen: fn(&mut Pair, GoalId),
    fault: MemberFault,
    /// Cycles from the event to the cycle in which the thread of the first robot must have seen it.
    seen_after: core::ops::RangeInclusive<u64>,
    /// True if its session continues.
    goes_on: bool,
}

const CASES: [Case; 10] = [
    Case {
        name: "deadman dropped",
        happen: |pair, _| pair.deadman = None,
        fault: MemberFault::GivenUp,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "user stop",
        happen: |pair, _| pair.robots[0].robot.press_user_stop(true),
        fault: MemberFault::RobotStopped,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "collision",
        happen: |pair, _| {
            let robot = &mut pair.robots[0].robot;
            let hand = robot.true_pose().translation.vector;
            let wall = Touch::wall(hand + Vector3::y() * 0.01, -Vector3::y());
            robot.touch(wall.stiffness(20_000.0));
        },
        fault: MemberFault::RobotStopped,
        seen_after: 1..=400,
        goes_on: false,
    },
    Case {
        name: "link cut",
        happen: |pair, _| pair.robots[0].link.drop_states(1500),
        fault: MemberFault::Silent,
        seen_after: 20..=20,
        goes_on: false,
    },
    Case {
        name: "control thread gone",
        happen: |pair, _| {
            let client = &mut pair.robots[0].client;
            client.driver = Driver::new(client.version());
        },
        fault: MemberFault::Gone,
        seen_after: 0..=1,
        goes_on: false,
    },
    Case {
        name: "future dropped",
        happen: |pair, goal| pair.robots[0].cancel(goal),
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: true,
    },
    Case {
        name: "stopped",
        happen: |pair, _| {
            let stopping = pair.robots[0].stop();
            stopping.expect("it moves");
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "disengaged",
        happen: |pair, _| {
            let session = pair.sessions[0];
            pair.robots[0].disengage(session);
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: false,
    },
    Case {
        name: "another goal",
        happen: |pair, _| {
            pair.submit(0, None, turned(0.0));
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: true,
    },
    Case {
        name: "connection closed",
        happen: |pair, _| {
            let reason = franka_rt::lifecycle::CloseReason::ClosedByPeer;
            pair.robots[0].client.close(reason);
        },
        fault: MemberFault::TakenBack,
        seen_after: 1..=1,
        goes_on: false,
    },
];

#[test]
fn a_fault_of_one_brakes_the_other_within_two_cycles() {
    for case in CASES {
        for swapped in [false, true] {
            let name = case.name;
            let mut pair = Pair::new(swapped);
            let goals = pair.both([1.0, 1.0]);
            pair.run(700);
            let speed = pair.robots[1].client.record.dq_ref[0];
            assert!(speed > 0.2, "{name}: it is under way, {speed} rad/s");
            assert_eq!(pair.stopped, None, "{name}");
            let happened = pair.ticks;
            (case.happen)(&mut pair, goals[0]);
            while pair.stopped.is_none() {
                pair.tick();
                assert!(pair.ticks < happened + 2000, "{name}: nothing happens");
            }
            let seen = pair.stopped.expect("it was waited for");
            let after = seen - happened;
            assert!(case.seen_after.contains(&after), "{name}: {after} cycles");
            if case.fault == MemberFault::RobotStopped {
                // In the very cycle in which the state said so.
                let mode = pair.robots[0].client.state.robot_mode;
                assert_ne!(mode, RobotMode::Move, "{name}");
            }
            pair.run(2);
            let braked = pair.braked[1].unwrap_or_else(|| panic!("{name}: it goes on"));
            let cycles = braked - seen;
            assert!(cycles <= 2, "{name}: {cycles} cycles");
            println!("{name}: seen after {after} cycles, brakes after {cycles} more");
            pair.run(400);
            let record = &pair.robots[1].client.record;
            assert_eq!(record.dq_ref, [0.0; 7], "{name}: it rests after 0.4 s");
            let outcome = pair.robots[1].until_resolved(goals[1], 3000);
            assert_eq!(outcome.map(drop), stopped_by(case.fault), "{name}");
            assert!(pair.moved(1) < 0.9, "{name}: {}", pair.moved(1));
            let own = pair.robots[0].client.outcome(goals[0]);
            assert!(
                matches!(own, None | Some(Err(_))),
                "{name}: its own error names the cause: {own:?}"
            );
            // The other session continues, alone or with the next joint motion.
            let back = [0, 1].map(|i| pair.robots[i].robot.q()[0] - READY[0] + 0.1);
            if case.goes_on {
                let goals = pair.both(back);
                let ended = pair.until_resolved(goals, 20_000);
                assert_eq!(ended, [Ok(()), Ok(())], "{name}");
            } else {
                let alone = pair.submit(1, None, turned(back[1]));
                let outcome = pair.robots[1].until_resolved(alone, 20_000);
                outcome.unwrap_or_else(|error| panic!("{name}: {error}"));
            }
        }
    }
}

/// The arms pursue their goals of a round until all goals of the next round have arrived.
#[test]
fn a_fault_in_a_round_brakes_the_other_while_the_next_one_waits() {
    for early in [None, Some(0), Some(1)] {
        for swapped in [false, true] {
            let case = format!("early: {early:?}, swapped: {swapped}");
            let mut pair = Pair::new(swapped);
            let [_, pursued] = pair.both([1.0, 1.0]);
            pair.run(600);
            let next = Some(pair.coordinator.begin());
            let waiting = early.map(|member| (member, pair.submit(member, next, turned(0.0))));
            pair.run(50);
            let speed = pair.robots[1].client.record.dq_ref[0];
            assert!(speed > 0.2, "{case}: under way, {speed} rad/s");
            assert_eq!(pair.stopped, None, "{case}");
            let happened = pair.ticks;
            pair.deadman = None;
            pair.run(3);
            let braked = pair.braked[1].unwrap_or_else(|| panic!("{case}: it moves on"));
            assert!(braked <= happened + 3, "{case}: {}", braked - happened);
            let waits = waiting.filter(|(member, _)| *member == 1);
            let goal = waits.map_or(pursued, |(_, goal)| goal);
            let outcome = pair.until_one_resolved(1, goal, 3000);
            assert_eq!(outcome, stopped_by(MemberFault::GivenUp), "{case}");
            assert!(pair.moved(1) < 0.9, "{case}: {}", pair.moved(1));
        }
    }
}

/// The arms meanwhile hold their reached targets, as part of an older round.
#[test]
fn a_goal_of_a_round_that_was_replaced_stops_no_other() {
    for cycles in 0..4 {
        let mut pair = Pair::new(false);
        let goals = pair.both([0.02, 0.02]);
        assert_eq!(pair.until_resolved(goals, 3000), [Ok(()), Ok(())]);
        let late = pair.coordinator.begin();
        let next = pair.coordinator.begin();
        pair.submit(0, Some(late), turned(0.3));
        pair.run(cycles);
        let goals = [0, 1].map(|i| pair.submit(i, Some(next), turned(0.1)));
        let ended = pair.until_resolved(goals, 20_000);
        assert_eq!(ended, [Ok(()), Ok(())], "after {cycles} cycles");
    }
}

#[test]
fn each_silence_of_one_brakes_the_other_anew() {
    let mut pair = Pair::of(team_tolerating(Duration::from_millis(5)), false);
    for (by, silence) in [(0.5, 4), (-0.5, 8), (0.5, 8)] {
        let goals = pair.both([by, by]);
        pair.run(300);
        // Too short for a stop by the robot.
        pair.robots[0].link.drop_states(silence);
        let [_, other] = pair.until_resolved(goals, 20_000);
        let braked = stopped_by(MemberFault::Silent);
        assert_eq!(other, if silence < 5 { Ok(()) } else { braked });
    }
}

/// Tuning gives the session's name to the target that holds the arm.
#[test]
fn arrived_arm_stays_in_its_round_until_it_moves_on() {
    type Meanwhile = fn(&mut Pair);
    let ways: [(&str, Meanwhile, bool); 4] = [
        ("held", |_| {}, true),
        (
            "tuned",
            |pair| {
                let session = pair.sessions[0];
                let tuned = pair.robots[0].tune(session, Tuning::default());
                tuned.expect("it is engaged");
            },
            true,
        ),
        (
            "moved",
            |pair| {
                pair.submit(0, None, turned(0.0));
            },
            false,
        ),
        (
            "tuned and moved",
            |pair| {
                let session = pair.sessions[0];
                let tuned = pair.robots[0].tune(session, Tuning::default());
                tuned.expect("it is engaged");
                pair.run(20);
                pair.submit(0, None, turned(0.0));
            },
            false,
        ),
    ];
    for (name, meanwhile, is_part) in ways {
        let mut pair = Pair::new(false);
        let [first, second] = pair.both([0.02, 1.2]);
        let arrived = pair.until_one_resolved(0, first, 3000);
        assert_eq!(arrived, Ok(()), "{name}");
        meanwhile(&mut pair);
        pair.run(50);
        assert_eq!(pair.stopped, None, "{name}");
        let speed = pair.robots[1].client.record.dq_ref[0];
        assert!(speed > 0.2, "{name}: it is under way, {speed} rad/s");
        let happened = pair.ticks;
        pair.deadman = None;
        pair.run(2);
        let seen = is_part.then_some(happened + 1);
        assert_eq!(pair.stopped, seen, "{name}");
        let outcome = pair.until_one_resolved(1, second, 20_000);
        let expected = match is_part {
            true => stopped_by(MemberFault::GivenUp),
            false => Ok(()),
        };
        assert_eq!(outcome, expected, "{name}");
    }
}

#[test]
fn a_goal_that_takes_an_arm_out_of_its_round_is_pursued() {
    for waits in [false, true] {
        let mut pair = Pair::new(false);
        let round = Some(pair.coordinator.begin());
        let first = pair.submit(0, round, turned(1.0));
        if waits {
            pair.run(20);
        }
        let second = pair.submit(1, round, turned(1.0));
        if !waits {
            pair.run(700);
        }
        let alone = pair.submit(0, None, turned(0.1));
        let outcome = pair.until_one_resolved(0, alone, 10_000);
        assert_eq!(outcome, Ok(()), "waits: {waits}");
        let ended = pair.until_resolved([first, second], 1);
        let superseded = Err(MotionError::Superseded);
        assert_eq!(ended, [superseded, stopped_by(MemberFault::TakenBack)]);
    }
}

/// The timeout brakes the arm or holds it at the last target.
#[test]
fn a_stream_of_one_that_falls_silent_brakes_the_other() {
    type Ended = fn(Lapse) -> MotionError;
    let ways: [(OnTimeout, Ended); 2] = [
        (OnTimeout::Brake, MotionError::Braked),
        (OnTimeout::Hold, MotionError::Held),
    ];
    for (on_timeout, ended_as) in ways {
        let mut pair = Pair::new(false);
        let round = Some(pair.coordinator.begin());
        let silence = Duration::from_millis(100);
        let stream = Goal {
            round,
            watchdog: Some(Watchdog {
                silence,
                on_timeout,
            }),
            ..pair.robots[0].goal(turned(0.02), OnArrival::Hold)
        };
        let stream = pair.submit_goal(0, stream);
        let other = pair.submit(1, round, turned(1.2));
        let ended = pair.until_resolved([stream, other], 5000);
        let own = ended_as(Lapse::Silent { silence });
        assert_eq!(ended, [Err(own), stopped_by(MemberFault::GivenUp)]);
    }
}

#[test]
fn an_arm_that_something_holds_brakes_the_other() {
    let mut pair = Pair::new(false);
    let hand = pair.robots[0].robot.true_pose();
    let wall = Touch::wall(hand.translation.vector + Vector3::z() * 0.02, -Vector3::z());
    pair.robots[0].robot.touch(wall.stiffness(2000.0));
    let round = Some(pair.coordinator.begin());
    let up = |by: f64| Target::Pose(Translation3::new(0.0, 0.0, by) * hand);
    let first = pair.robots[0].goal(up(0.06), OnArrival::ReportAndHold);
    let first = Goal {
        force_cap: ForceCap::Newtons(8.0),
        round,
        ..first
    };
    let first = pair.submit_goal(0, first);
    // Slow enough to be under way when the first one gives up.
    let second = pair.robots[1].goal(turned(1.2), OnArrival::ReportAndHold);
    let second = Goal {
        budget: second.budget.scaled(0.08),
        round,
        ..second
    };
    let second = pair.submit_goal(1, second);
    let [held, braked] = pair.until_resolved([first, second], 30_000);
    assert!(
        matches!(held, Err(MotionError::TargetNotReached(_))),
        "{held:?}"
    );
    assert_eq!(braked, stopped_by(MemberFault::NotReached));
}

#[test]
fn a_reaction_and_a_motion_of_one_arm_alone_concern_no_other() {
    let mut pair = Pair::new(false);
    let round = Some(pair.coordinator.begin());
    let reacting = Goal {
        round,
        reaction: Some(Reaction::from(elapsed(Duration::from_millis(400)))),
        ..pair.robots[0].goal(turned(0.6), OnArrival::ReportAndHold)
    };
    let first = pair.submit_goal(0, reacting);
    let second = pair.submit(1, round, turned(0.6));
    let ended = pair.until_resolved([first, second], 20_000);
    assert_eq!(ended, [Ok(()), Ok(())]);
    assert!(pair.moved(0) < 0.5 && pair.moved(1) > 0.59);
    let alone = pair.submit(0, None, turned(0.2));
    pair.run(100);
    pair.robots[0].cancel(alone);
    pair.run(1000);
    assert_eq!(pair.stopped, None);
    // The end of its session brakes the other one in any case.
    let other = pair.submit(1, None, turned(0.0));
    pair.run(300);
    pair.robots[0].robot.press_user_stop(true);
    pair.run(3);
    let outcome = pair.robots[1].until_resolved(other, 3000);
    assert_eq!(outcome.map(drop), stopped_by(MemberFault::RobotStopped));
}
