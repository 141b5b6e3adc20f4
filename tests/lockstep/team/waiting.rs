//! References that wait for each other, as references of arms with a common object do.

use std::time::Duration;

use franka_lockstep::{Lockstep, outcomes_of};
use franka_model::Wrench;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::condition::elapsed;
use franka_rt::session::{Goal, GoalId, Guard, Leash, OnArrival, Target};
use franka_rt::team::MemberFault;
use franka_sim::Touch;
use nalgebra::{Isometry3, Translation3, Vector3};

use super::{Pair, stopped_by};

impl Pair {
    /// Begins to raise the common object by 10 cm, at 3 cm/s.
    fn raise(&mut self, mut with: impl FnMut(usize, Goal) -> Goal) -> [GoalId; 2] {
        let round = Some(self.coordinator.begin());
        [0, 1].map(|i| {
            let hand = self.robots[i].reference_pose();
            let up = Target::Pose(Translation3::new(0.0, 0.0, 0.1) * hand);
            let goal = self.robots[i].goal(up, OnArrival::ReportAndHold);
            let goal = Goal {
                round,
                grasp: Some(Isometry3::identity()),
                budget: goal.budget.scaled(0.1),
                ..goal
            };
            self.submit_goal(i, with(i, goal))
        })
    }

    /// Distance of an arm behind its reference, with turns as 0.2 m per radian, `[m]`.
    fn lag(&self, member: usize) -> f64 {
        let robot = &self.robots[member];
        let (reference, arm) = (robot.reference_pose(), robot.arm_pose());
        let way = reference.translation.vector - arm.translation.vector;
        way.norm() + 0.2 * reference.rotation.angle_to(&arm.rotation)
    }

    /// Holds the first arm so far behind its reference for a millisecond, with a force that follows
    /// `pull`, `[N]`.
    fn hold_back(&mut self, behind: f64, pull: &mut f64) {
        *pull += 3.0 * (behind - self.lag(0));
        push(&mut self.robots[0], -*pull);
    }

    fn heights(&self) -> [f64; 2] {
        let height = |robot: &Lockstep| robot.reference_pose().translation.z;
        self.robots.each_ref().map(height)
    }

    fn wall_above(&mut self, member: usize, distance: f64) {
        let robot = &mut self.robots[member].robot;
        let hand = robot.true_pose().translation.vector;
        let wall = Touch::wall(hand + Vector3::z() * distance, -Vector3::z());
        robot.touch(wall.stiffness(5000.0));
    }
}

/// Pushes the arm upwards for a millisecond, `[N]`.
fn push(robot: &mut Lockstep, force: f64) {
    let up = Wrench::new(0.0, 0.0, force, 0.0, 0.0, 0.0);
    robot.robot.push_end_effector(up, 1);
}

/// The clock of the second robot runs at half the speed of the first one's. The first would be
/// ahead by 5 cm with a common object, and is ahead without one.
#[test]
fn reference_halts_while_ahead_of_another_on_its_object() {
    for together in [true, false] {
        let mut pair = Pair::new(false);
        let start = pair.heights();
        let goals = pair.raise(|_, goal| Goal {
            grasp: goal.grasp.filter(|_| together),
            ..goal
        });
        let mut ahead = 0.0_f64;
        for ms in 0..20_000 {
            pair.robots[0].tick();
            if ms % 2 == 0 {
                pair.robots[1].tick();
            }
            let now = pair.heights();
            let [one, other] = [0, 1].map(|i| now[i] - start[i]);
            ahead = ahead.max((one - other).abs());
        }
        println!("ahead by {ahead:.4} m");
        if together {
            // 2 mm, and the braking distance at 3 cm/s.
            assert!(ahead < 4e-3, "{ahead} m");
        } else {
            assert!(ahead > 0.03, "{ahead} m");
        }
        assert_eq!(pair.until_resolved(goals, 20_000), [Ok(()), Ok(())]);
    }
}

/// Farther behind than the threshold of a lag, nearer than that, and nearer than the threshold for
/// having caught up.
#[test]
fn halted_references_resume_when_the_arm_has_caught_up() {
    let mut pair = Pair::new(false);
    let goals = pair.raise(|_, goal| goal);
    pair.run(500);
    let mut pull = 0.0;
    for (behind, go_on) in [(0.0165, false), (0.0135, false), (0.011, true)] {
        let mut before = [0.0; 2];
        for ms in 0..1200 {
            pair.hold_back(behind, &mut pull);
            pair.tick();
            if ms == 700 {
                before = pair.heights();
            }
        }
        let now = pair.heights();
        let went = [0, 1].map(|i| now[i] - before[i]);
        println!("{behind} m behind: {went:?} m in half a second");
        for went in went {
            assert_eq!(went > 5e-4, go_on, "{behind} m behind: {went} m");
            assert!(go_on || went.abs() < 1e-5, "{behind} m behind: {went} m");
        }
    }
    assert_eq!(pair.until_resolved(goals, 20_000), [Ok(()), Ok(())]);
}

/// The second arm is drawn back at the end of a short leash, and so also hindered, and for longer
/// than the first one. The clock of the first one runs at a third of its speed.
#[test]
fn awaited_one_of_two_hindered_arms_gives_up() {
    let mut pair = Pair::new(false);
    pair.wall_above(0, 0.02);
    let goals = pair.raise(|i, goal| match i {
        0 => goal,
        _ => Goal {
            leash: Leash::LEAST,
            ..goal
        },
    });
    while pair.lag(0) < 0.0152 {
        pair.tick();
        assert!(pair.ticks < 5000, "nothing holds it");
    }
    let top = pair.robots[1].arm_pose().translation.z;
    let mut leashed = 0;
    for ms in 0..20_000 {
        if ms % 3 == 0 {
            pair.robots[0].tick();
        }
        let robot = &mut pair.robots[1];
        if ms < 7000 {
            // A stiff hand that moves down at 3 cm/s, by less than the permitted displacement of
            // the arm.
            let drawn = top - 3e-5 * f64::from(ms);
            push(robot, 2000.0 * (drawn - robot.arm_pose().translation.z));
        }
        robot.tick();
        let record = &pair.robots[1].client.record;
        leashed += u64::from(record.bindings.contains(Guard::Leash));
        let Some([held, waited]) = outcomes_of(pair.robots.each_ref(), goals) else {
            continue;
        };
        println!("after {ms} ms, {leashed} ms of them on its leash: {held:?}");
        assert!(leashed > 6000, "{leashed} ms");
        assert!(matches!(held, Err(MotionError::TargetNotReached(_))));
        assert_eq!(waited, stopped_by(MemberFault::NotReached));
        return;
    }
    panic!("none gives up");
}

#[test]
fn arm_that_reacted_with_an_object_holds_up_no_other() {
    let mut pair = Pair::new(false);
    let goals = pair.raise(|i, goal| {
        let due = elapsed(Duration::from_millis(2500));
        Goal {
            reaction: (i == 0).then_some(due.into()),
            ..goal
        }
    });
    let mut pull = 0.0;
    for ms in 0..20_000 {
        if ms == 2500 {
            assert!(pair.lag(0) > 0.015, "the other one waits: {}", pair.lag(0));
        }
        pair.hold_back(0.017, &mut pull);
        pair.tick();
    }
    let ended = outcomes_of(pair.robots.each_ref(), goals);
    assert_eq!(ended, Some([Ok(()), Ok(())]));
}

/// The clock of the second robot runs so slowly that the robot is on its last millimetres
/// meanwhile.
#[test]
fn an_arm_that_has_arrived_with_the_object_holds_up_no_other() {
    let mut pair = Pair::new(false);
    let goals = pair.raise(|_, goal| goal);
    let mut pull = 0.0;
    let mut lagged = false;
    for ms in 0..200_000 {
        let arrived = pair.robots[0].client.outcome(goals[0]).is_some();
        if arrived {
            pair.hold_back(0.02, &mut pull);
        }
        pair.robots[0].tick();
        if ms % 20 == 0 {
            pair.robots[1].tick();
        }
        if let Some(ended) = outcomes_of(pair.robots.each_ref(), goals) {
            assert!(lagged, "{} m", pair.lag(0));
            assert_eq!(ended, [Ok(()), Ok(())]);
            return;
        }
        lagged |= pair.lag(0) > 0.016;
    }
    panic!("the second one waits for ever");
}

/// A motion longer than the five seconds after which a lagging arm gives up.
#[test]
fn an_arm_that_has_lagged_with_the_object_does_not_lag_without() {
    let mut pair = Pair::new(false);
    pair.raise(|_, goal| goal);
    let mut pull = 0.0;
    while pair.lag(0) < 0.0155 {
        pair.hold_back(0.017, &mut pull);
        pair.tick();
        assert!(pair.ticks < 5000, "{} m", pair.lag(0));
    }
    let up = Translation3::new(0.0, 0.0, 0.1) * pair.robots[0].reference_pose();
    let goal = pair.robots[0].goal(up.into(), OnArrival::ReportAndHold);
    let goal = Goal {
        budget: goal.budget.scaled(0.1),
        ..goal
    };
    let alone = pair.submit_goal(0, goal);
    let begun = pair.ticks;
    let outcome = pair.until_one_resolved(0, alone, 20_000);
    assert_eq!(outcome, Ok(()));
    assert!(pair.ticks - begun > 6000, "{} ms", pair.ticks - begun);
}

/// If others have the same object, the hindrance 3 mm short of its target counts as the object's.
#[test]
fn arm_near_its_target_arrives_if_it_carries_with_others() {
    for together in [true, false] {
        let mut pair = Pair::new(false);
        pair.wall_above(0, 0.096);
        let goals = pair.raise(|_, goal| Goal {
            round: goal.round.filter(|_| together),
            ..goal
        });
        let [near, free] = pair.until_resolved(goals, 20_000);
        println!("{near:?}");
        let short = matches!(near, Err(MotionError::TargetNotReached(_)));
        assert_eq!((near.is_ok(), short), (together, !together), "{near:?}");
        assert_eq!(free, Ok(()));
    }
}

/// Its plan was for the hand.
#[test]
fn arm_taking_an_object_in_motion_goes_on_from_there() {
    let mut robot = Lockstep::ready();
    let session = robot.engage();
    let home = robot.reference_pose();
    let object = Isometry3::translation(0.0, 0.3, 0.0);
    let up = |by: f64| Translation3::new(0.0, 0.0, by) * home;
    let taken = robot.within(session, up(0.2).into(), OnArrival::ReportAndHold);
    taken.expect("within reach");
    robot.run(700);
    let goal = robot.goal((up(0.15) * object).into(), OnArrival::ReportAndHold);
    let goal = Goal {
        grasp: Some(object),
        ..goal
    };
    let goal = robot.submit_within(session, goal).expect("within reach");
    let mut aside = 0.0_f64;
    while robot.client.outcome(goal).is_none() {
        robot.tick();
        assert!(robot.now() < 20_000, "it never arrives");
        let way = robot.reference_pose().translation.vector - home.translation.vector;
        aside = aside.max(way.xy().norm());
    }
    println!("{aside:.5} m aside");
    assert!(aside < 1e-3, "{aside} m");
    robot.until_resolved(goal, 1).expect("it arrives");
    let off = robot.arm_pose().translation.vector - up(0.15).translation.vector;
    assert!(off.norm() < 2e-3, "{off}");
}

/// Its target lies 0.3 m beside the target of the hand.
#[test]
fn line_of_a_carried_object_begins_at_the_object() {
    let mut robot = Lockstep::ready();
    let object = Isometry3::translation(0.0, 0.3, 0.0);
    let up = Translation3::new(0.0, 0.0, 0.1) * robot.arm_pose() * object;
    let goal = robot.goal(up.into(), OnArrival::ReportAndFinish);
    let goal = Goal {
        grasp: Some(object),
        ..goal
    };
    let goal = robot.submit(goal).expect("within reach");
    let report = robot.until_resolved(goal, 8000).expect("it arrives");
    let beside = report.line_deviation.expect("a goal to a pose");
    println!("{beside:.5} m beside its line");
    assert!(beside < 2e-3, "{beside} m");
}
