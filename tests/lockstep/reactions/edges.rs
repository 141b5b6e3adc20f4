//! A condition that coincides with another event, or comes too early or too late.

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot};
use franka_proto::{CollisionBehavior, Request, RobotError, RobotMode};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::condition::{
    Axis, ConditionError, Quantity, contact, elapsed, force_x, force_z,
};
use franka_rt::session::{Free, Goal, GoalError, GoalId, OnArrival, Reaction, Target};
use nalgebra::Translation3;

use super::{MS, above, at, goes_on, reacted, report, says_so};

/// A motion of 12 cm upwards, under way, until this many milliseconds have passed.
fn until(
    lockstep: &mut Lockstep,
    milliseconds: u32,
    then: Option<Target>,
    on_arrival: OnArrival,
) -> Goal {
    let due = elapsed(milliseconds * MS);
    let reaction = then.map_or(Reaction::from(due), |target| due.then(target));
    let up = above(lockstep, 0.12);
    at(0.3, up, reaction, on_arrival, lockstep)
}

/// Runs until the record of a cycle shows the goal. Returns the `message_id` of its first state.
fn begin(lockstep: &mut Lockstep, goal: GoalId) -> u64 {
    for _ in 0..1000 {
        lockstep.tick();
        if lockstep.client.record.goal == goal.0 {
            return lockstep.client.state.message_id;
        }
    }
    panic!("{goal:?} does not begin")
}

#[test]
fn condition_true_from_the_first_cycle_stops_at_once() {
    for_each_robot(|ready| {
        for then in [None, Some(())] {
            let mut lockstep = ready();
            let home = lockstep.arm_pose();
            let aside = Translation3::new(0.0, 0.05, 0.0) * home;
            let other = then.map(|()| aside.into());
            let goal = until(&mut lockstep, 0, other, OnArrival::ReportAndFinish);
            let goal = lockstep.submit(goal).expect("within reach");
            let first = begin(&mut lockstep, goal);
            let mut highest = 0.0_f64;
            while goes_on(&lockstep, goal) {
                let up = lockstep.reference_pose().translation.z - home.translation.z;
                highest = highest.max(up);
                lockstep.tick();
            }
            let report = report(&mut lockstep, goal);
            let seen = report.reacted.expect("at once");
            assert_eq!((seen.after, seen.time), (Duration::ZERO, first));
            assert!(highest < 1e-4, "{highest} m");
            let moved = lockstep.arm_pose().translation.y - home.translation.y;
            let expected = if then.is_some() { 0.05 } else { 0.0 };
            assert!((moved - expected).abs() < 1e-3, "{moved} m");
        }
    });
}

/// The duration of a motion does not count the time for which the arm is watched at the target.
#[test]
fn condition_counts_until_the_arrival_is_reported() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let goal = until(&mut lockstep, 60_000, None, OnArrival::ReportAndFinish);
        let goal = lockstep.submit(goal).expect("within reach");
        let first = begin(&mut lockstep, goal);
        let duration = report(&mut lockstep, goal).duration.as_millis() as u32;
        let ended = lockstep.client.state.message_id - first;
        println!("arrived after {duration} ms, ended after {ended} ms");
        // During settling; in the last cycles before the report and the first after it; released;
        // ended. The report comes 250 ms after the arrival, plus or minus one cycle.
        let early = [duration + 10, duration + 200, duration + 247];
        let late = [duration + 253, duration + 300, ended as u32 + 50];
        for (milliseconds, counts) in early
            .map(|time| (time, true))
            .into_iter()
            .chain(late.map(|time| (time, false)))
        {
            for on_arrival in [OnArrival::ReportAndFinish, OnArrival::ReportAndHold] {
                let mut lockstep = ready();
                let engaged = (on_arrival == OnArrival::ReportAndHold).then(|| lockstep.engage());
                let back = lockstep.arm_pose();
                let goal = until(&mut lockstep, milliseconds, Some(back.into()), on_arrival);
                let goal = match engaged {
                    Some(engaged) => lockstep.submit_within(engaged, goal),
                    None => lockstep.submit(goal),
                };
                let goal = goal.expect("within reach");
                let report = report(&mut lockstep, goal);
                assert_eq!(
                    report.reacted.is_some(),
                    counts,
                    "{milliseconds} ms: {report:?}"
                );
                assert!(report.final_error.is_some(), "{report:?}");
                for _ in 0..500 {
                    lockstep.tick();
                    assert!(counts || !says_so(&lockstep));
                }
                let up = lockstep.arm_pose().translation.z - back.translation.z;
                let expected = if counts { 0.0 } else { 0.12 };
                assert!((up - expected).abs() < 2e-3, "{up} m");
            }
        }
    });
}

/// Runs `each` in the cycles around the reaction.
fn around(mut each: impl FnMut(u64)) {
    for cycle in 498..=502 {
        each(cycle);
    }
}

#[test]
fn newer_goal_takes_over_before_and_after_a_reaction() {
    for_each_robot(|ready| {
        around(|cycle| {
            for own in [false, true] {
                let mut lockstep = ready();
                let engaged = own.then(|| lockstep.engage());
                let on_arrival = match own {
                    true => OnArrival::ReportAndHold,
                    false => OnArrival::ReportAndFinish,
                };
                let home = lockstep.arm_pose();
                let back = Some(home.into());
                let older = until(&mut lockstep, 500, back, on_arrival);
                let aside = Translation3::new(0.0, 0.06, 0.03) * home;
                let submit = |lockstep: &mut Lockstep, goal| match engaged {
                    Some(engaged) => lockstep.submit_within(engaged, goal),
                    None => lockstep.submit(goal),
                };
                let older = submit(&mut lockstep, older).expect("within reach");
                begin(&mut lockstep, older);
                lockstep.run(cycle);
                let newer = lockstep.goal(aside.into(), on_arrival);
                let newer = submit(&mut lockstep, newer).expect("within reach");
                let outcome = lockstep.client.outcome(older);
                assert_eq!(outcome, Some(&Err(MotionError::Superseded)));
                lockstep.tick();
                lockstep.tick();
                while goes_on(&lockstep, newer) {
                    lockstep.tick();
                    assert!(!says_so(&lockstep), "that was the older one");
                }
                let report = report(&mut lockstep, newer);
                assert_eq!(report.reacted, None);
                let off = lockstep.arm_pose().translation.vector - aside.translation.vector;
                assert!(off.norm() < 2e-3, "{cycle}: {off}");
            }
        });
    });
}

#[test]
fn a_cancelled_goal_stops_whether_or_not_it_has_reacted() {
    for_each_robot(|ready| {
        let mut check = |cycle: u64| {
            for then in [false, true] {
                let mut lockstep = ready();
                let far = Translation3::new(0.0, 0.1, 0.0) * lockstep.arm_pose();
                let then = then.then_some(far.into());
                let goal = until(&mut lockstep, 500, then, OnArrival::ReportAndFinish);
                let goal = lockstep.submit(goal).expect("within reach");
                begin(&mut lockstep, goal);
                lockstep.run(cycle);
                lockstep.cancel(goal);
                let outcome = lockstep.until_resolved(goal, 2000);
                assert_eq!(outcome, Err(MotionError::Stopped), "{cycle}");
                let off = lockstep.arm_pose().translation.vector - far.translation.vector;
                assert!(off.norm() > 0.02, "braked on its way");
                lockstep.until_idle(1000);
            }
        };
        around(&mut check);
        // On the way to the other target, and while an arm without one lands.
        check(650);
        // A stop from outside.
        let mut lockstep = ready();
        let goal = until(&mut lockstep, 500, None, OnArrival::ReportAndFinish);
        let goal = lockstep.submit(goal).expect("within reach");
        begin(&mut lockstep, goal);
        lockstep.run(501);
        let stop = lockstep.stop().expect("it moves");
        let outcome = lockstep.client.outcome(goal);
        assert_eq!(outcome, Some(&Err(MotionError::Stopped)));
        assert_eq!(report(&mut lockstep, stop).reacted, None);
    });
}

#[test]
fn lost_states_delay_a_reaction_to_the_next_one_that_comes() {
    for_each_robot(|ready| {
        for lost in [1, 3, 8, 15] {
            for begins in [490, 495, 499] {
                let mut lockstep = ready();
                let goal = until(&mut lockstep, 500, None, OnArrival::ReportAndFinish);
                let goal = lockstep.submit(goal).expect("within reach");
                let first = begin(&mut lockstep, goal);
                lockstep.run(begins);
                lockstep.link.drop_states(lost);
                let seen = reacted(&mut lockstep, goal);
                // The state of millisecond `begins` was the last before the gap.
                let expected = (begins + lost + 1).max(500);
                assert_eq!(seen.time - first, expected, "{lost} after {begins}");
                assert_eq!(seen.after, expected as u32 * MS);
            }
        }
    });
}

#[test]
fn a_reflex_in_the_same_cycle_ends_the_motion() {
    for_each_robot(|ready| {
        around(|cycle| {
            let mut lockstep = ready();
            let back = Some(lockstep.arm_pose().into());
            let goal = until(&mut lockstep, 500, back, OnArrival::ReportAndFinish);
            let goal = lockstep.submit(goal).expect("within reach");
            begin(&mut lockstep, goal);
            lockstep.run(cycle);
            lockstep.robot.trip(RobotError::CartesianReflex);
            let error = lockstep.until_resolved(goal, 3000).unwrap_err();
            let reflex = error.control().is_some_and(|control| control.is_reflex());
            assert!(reflex, "{cycle}: {error}");
            lockstep.run(500);
            lockstep.request(&Request::AutomaticErrorRecovery);
            lockstep.run(1500);
            assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
            let home = lockstep.arm_pose();
            let again = lockstep.begin(home.into());
            assert_eq!(report(&mut lockstep, again).reacted, None);
        });
    });
}

/// A stop in contact: the robot's own thresholds, which are lower than the condition's, come first.
#[test]
fn a_robot_that_stops_at_its_own_thresholds_is_not_a_reaction() {
    let mut lockstep = Lockstep::ready();
    let strict = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [10.0; 6], [15.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(strict));
    lockstep.run(5);
    super::table(&mut lockstep, 0.02, 20_000.0);
    let down = above(&lockstep, -0.06);
    let goal = at(
        0.1,
        down,
        force_z(100.0),
        OnArrival::ReportAndFinish,
        &mut lockstep,
    );
    let goal = lockstep.submit(goal).expect("within reach");
    let outcome = lockstep.until_resolved(goal, 20_000);
    let error = outcome.expect_err("a reflex");
    assert!(
        error.control().is_some_and(|control| control.is_reflex()),
        "{error}"
    );
}

#[test]
fn either_kind_of_target_may_follow_either_kind_of_goal() {
    for_each_robot(|ready| {
        for from_joints in [false, true] {
            for to_joints in [false, true] {
                let mut lockstep = ready();
                let home = lockstep.arm_pose();
                let q: [f64; 7] = (*lockstep.robot.q()).into();
                let target = |joints: bool, by: f64| match joints {
                    true => Target::Joints(core::array::from_fn(|i| q[i] + by)),
                    false => (Translation3::new(0.0, by, by) * home).into(),
                };
                let due = Quantity::Speed.above(0.05) & elapsed(100 * MS);
                let reaction = due.then(target(to_joints, -0.05));
                let goal = Goal {
                    reaction: Some(reaction),
                    ..lockstep.goal(target(from_joints, 0.1), OnArrival::ReportAndFinish)
                };
                let goal = lockstep.submit(goal).expect("within reach");
                let report = report(&mut lockstep, goal);
                assert!(report.reacted.is_some(), "{report:?}");
                assert!(report.final_error.is_some(), "{report:?}");
                let arrived = match target(to_joints, -0.05) {
                    Target::Joints(q) => (lockstep.robot.q() - nalgebra::SVector::from(q)).amax(),
                    Target::Pose(pose) => {
                        (lockstep.arm_pose().translation.vector - pose.translation.vector).norm()
                    }
                    other => unreachable!("{other:?}"),
                };
                assert!(arrived < 3e-3, "{arrived}");
            }
        }
    });
}

#[test]
fn impossible_reaction_is_refused_before_anything_moves() {
    let mut lockstep = Lockstep::ready();
    let still = lockstep.arm_pose();
    let mut refused = |reaction: Reaction| {
        let up = above(&lockstep, 0.05);
        let goal = at(0.1, up, reaction, OnArrival::ReportAndFinish, &mut lockstep);
        match lockstep.submit(goal) {
            Err(MotionError::Goal(error)) => error,
            other => panic!("{other:?}"),
        }
    };
    let long = (0..20).fold(contact(), |all, _| all | force_x(9.0));
    assert_eq!(
        refused(long.into()),
        ConditionError::TooLong { got: 41 }.into()
    );
    let threshold = ConditionError::Threshold {
        quantity: Quantity::Force(Axis::Z),
        got: -5.0,
    };
    assert_eq!(refused(force_z(-5.0).into()), threshold.into());
    let joint = ConditionError::Joint { got: 0 };
    let zeroth = Quantity::JointVelocity(0).above(0.1);
    assert_eq!(refused(zeroth.into()), joint.into());
    let guided = contact().then(Target::Guide(Free::ALL));
    assert_eq!(refused(guided), ConditionError::Guided.into());
    let moving = contact().then((still, nalgebra::SVector::repeat(0.1)));
    assert_eq!(refused(moving), GoalError::Moves);
    let far = contact().then(nalgebra::Isometry3::translation(3.0, 0.0, 0.0));
    assert!(matches!(refused(far), GoalError::Unreachable { .. }));
    let beyond = contact().then([4.0; 7]);
    assert!(matches!(refused(beyond), GoalError::OutOfRange { .. }));
}
