//! Rounds: when their goals begin, and when they do not.

use std::time::Duration;

use franka_lockstep::{Lockstep, turned};
use franka_model::READY;
use franka_rt::lifecycle::{Engagement, MotionError, NewMotion};
use franka_rt::session::condition::elapsed;
use franka_rt::session::{Goal, GoalId, Lapse, OnArrival, OnTimeout, Target, Watchdog, Waypoint};
use franka_rt::team::{Member, MemberFault, Passage, Round, team};

use super::{Pair, stopped_by};

const MS: Duration = Duration::from_millis(1);

#[test]
fn team_goals_begin_together_and_resolve_separately() {
    for (swapped, late) in [(false, 0), (true, 0), (false, 1), (true, 700)] {
        let mut pair = Pair::new(swapped);
        // Twice, in the same sessions.
        for by in [0.1, -0.1] {
            let before = [0, 1].map(|i| *pair.robots[i].robot.q());
            let round = Some(pair.coordinator.begin());
            let first = pair.submit(0, round, turned(by));
            pair.run(late);
            assert!((pair.robots[0].robot.q() - before[0]).amax() < 2e-3);
            let second = pair.submit(1, round, turned(2.0 * by));
            let mut began = [None; 2];
            for ms in 0..50 {
                pair.tick();
                for (i, began) in began.iter_mut().enumerate() {
                    if pair.robots[i].client.record.dq_ref != [0.0; 7] {
                        began.get_or_insert(ms);
                    }
                }
            }
            let [Some(left), Some(right)] = began else {
                panic!("both have begun: {began:?}")
            };
            assert!(i32::abs_diff(left, right) <= 1, "{began:?}");
            let ended = pair.until_resolved([first, second], 20_000);
            assert_eq!(ended, [Ok(()), Ok(())]);
        }
        // The shorter motion has arrived long before the other: that is no fault.
        assert_eq!((pair.stopped, pair.braked), (None, [None; 2]));
    }
}

#[test]
fn without_the_others_nothing_begins() {
    // The goal of the first robot is refused.
    let mut pair = Pair::new(false);
    let round = pair.coordinator.begin();
    let second = pair.submit(1, Some(round), turned(0.3));
    pair.run(100);
    let goal = pair.robots[0].goal(turned(9.0), OnArrival::ReportAndHold);
    let session = pair.sessions[0];
    let round_of = |goal| Goal {
        round: Some(round),
        ..goal
    };
    let refused = pair.robots[0].submit_within(session, round_of(goal));
    assert!(matches!(refused, Err(MotionError::Goal(_))), "{refused:?}");
    pair.coordinator.refuse(round, 0);
    let outcome = pair.robots[1].until_resolved(second, 2000);
    assert_eq!(outcome.map(drop), stopped_by(MemberFault::Refused));
    assert!(pair.moved(1) < 2e-3, "{}", pair.moved(1));

    // It is cancelled while it waits, or superseded.
    for superseded in [false, true] {
        let round = Some(pair.coordinator.begin());
        let first = pair.submit(0, round, turned(0.3));
        pair.run(100);
        if superseded {
            pair.submit(0, None, turned(0.0));
        } else {
            pair.robots[0].cancel(first);
        }
        pair.run(2);
        let second = pair.submit(1, round, turned(0.3));
        let ended = pair.until_resolved([first, second], 2000);
        let own = match superseded {
            true => MotionError::Superseded,
            false => MotionError::Stopped,
        };
        assert_eq!(ended, [Err(own), stopped_by(MemberFault::TakenBack)]);
    }

    // It never comes.
    let round = Some(pair.coordinator.begin());
    let first = pair.submit(0, round, turned(0.3));
    let outcome = pair.robots[0].until_resolved(first, 12_000);
    assert_eq!(outcome.map(drop), stopped_by(MemberFault::TimedOut));
    assert!(pair.moved(0) < 2e-3 && pair.moved(1) < 2e-3);
}

#[test]
fn an_arm_that_is_to_be_held_takes_part_in_a_round() {
    let mut pair = Pair::new(false);
    let moving = pair.submit(0, None, turned(0.4));
    pair.run(600);
    let round = Some(pair.coordinator.begin());
    let held = pair.submit(0, round, Target::Rest);
    pair.run(100);
    let speed = pair.robots[0].client.record.dq_ref[0];
    assert!(speed > 0.1, "it goes on until the round begins");
    let turning = pair.submit(1, round, turned(0.1));
    let ended = pair.until_resolved([held, turning], 5000);
    assert_eq!(ended, [Ok(()), Ok(())]);
    let superseded = pair.robots[0].client.outcome(moving);
    assert_eq!(superseded, Some(&Err(MotionError::Superseded)));
    assert!((0.01..0.39).contains(&pair.moved(0)), "{}", pair.moved(0));
    assert!(pair.moved(1) > 0.098, "{}", pair.moved(1));
    assert_eq!(pair.stopped, None);
}

/// A motion has its name from when it is made, which may be long before it begins.
#[test]
fn a_path_made_before_the_goal_in_force_waits_for_the_others() {
    let mut pair = Pair::new(false);
    let path = pair.robots[0].goal(turned(0.0), OnArrival::ReportAndHold);
    pair.submit(0, None, turned(0.0));
    pair.run(50);
    let round = Some(pair.coordinator.begin());
    let motion = NewMotion::Goal {
        goal: Box::new(Goal { round, ..path }),
        path: None,
        ticket: None,
        session: Some(pair.sessions[0]),
    };
    let there_and_back = [0.2, 0.0].map(|by| Waypoint::new(turned(by)));
    let begun = pair.robots[0].client.begin_along(&there_and_back, motion);
    let first = begun.expect("within reach");
    pair.run(100);
    let second = pair.submit(1, round, turned(0.1));
    let mut farthest = 0.0_f64;
    for _ in 0..2000 {
        pair.tick();
        farthest = farthest.max(pair.moved(0));
    }
    let ended = pair.until_resolved([first, second], 10_000);
    assert_eq!(ended, [Ok(()), Ok(())]);
    assert!(farthest > 0.19, "{farthest} rad");
}

/// A session whose goal of a round came before its first state, and the reason for its wait.
struct Waiting {
    robot: Lockstep,
    goal: GoalId,
    round: Round,
    other: Member,
}

impl Waiting {
    /// For this goal of the robot, half a second later.
    fn with(goal: impl FnOnce(&mut Lockstep) -> Goal) -> Self {
        let (coordinator, [own, other]) = team();
        let mut robot = Lockstep::ready();
        let session = robot.begin_session(Engagement {
            team: Some(own),
            ..Engagement::default()
        });
        let round = coordinator.begin();
        let goal = Goal {
            round: Some(round),
            ..goal(&mut robot)
        };
        let motion = NewMotion::Goal {
            goal: Box::new(goal),
            path: None,
            ticket: None,
            session: Some(session),
        };
        let goal = robot.client.begin(motion).expect("it is taken");
        robot.run(500);
        let mut this = Self {
            robot,
            goal,
            round,
            other,
        };
        this.waits();
        this
    }

    fn waits(&mut self) {
        assert!((self.robot.robot.q() - READY).amax() < 1e-3, "it waits");
        assert_eq!(self.robot.client.outcome(self.goal), None);
        let record = &self.robot.client.record;
        assert_eq!(record.goal, 0, "no goal's");
        assert!(record.bindings.is_empty(), "{:?}", record.bindings);
    }

    fn begin(&mut self) {
        assert_eq!(self.other.pass(self.round, 0), Passage::Open);
        self.other.leave();
    }
}

#[test]
fn goal_before_the_first_state_of_its_session_waits_too() {
    let mut waiting = Waiting::with(|robot| robot.goal(turned(0.2), OnArrival::ReportAndHold));
    waiting.begin();
    let Waiting {
        mut robot, goal, ..
    } = waiting;
    robot.until_resolved(goal, 10_000).expect("it arrives");
}

#[test]
fn the_watchdog_of_a_goal_runs_from_its_beginning() {
    let silence = 100 * MS;
    let mut waiting = Waiting::with(|robot| Goal {
        watchdog: Some(Watchdog {
            silence,
            on_timeout: OnTimeout::Brake,
        }),
        ..robot.goal(turned(0.2), OnArrival::Hold)
    });
    waiting.begin();
    let Waiting {
        mut robot, goal, ..
    } = waiting;
    robot.run(90);
    assert!(robot.client.record.dq_ref[0] > 0.01, "it is under way");
    assert_eq!(robot.client.outcome(goal), None);
    let silent = Err(MotionError::Braked(Lapse::Silent { silence }));
    assert_eq!(robot.until_resolved(goal, 2000), silent);
}

#[test]
fn the_condition_of_a_goal_counts_from_its_beginning() {
    let mut waiting = Waiting::with(|robot| {
        let due = elapsed(300 * MS).then(turned(-0.1));
        Goal {
            reaction: Some(due),
            ..robot.goal(turned(0.5), OnArrival::ReportAndHold)
        }
    });
    waiting.begin();
    let Waiting {
        mut robot, goal, ..
    } = waiting;
    let report = robot.until_resolved(goal, 10_000).expect("a reaction");
    assert_eq!(report.reacted.expect("in mid-motion").after, 300 * MS);
    let turn = robot.robot.q()[0] - READY[0];
    assert!((turn + 0.1).abs() < 2e-3, "{turn} rad");
}
