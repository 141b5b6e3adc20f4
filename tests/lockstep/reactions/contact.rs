//! Guarded moves: down to a table of unknown height, and the hand of a person on the way.

use franka_lockstep::Lockstep;
use franka_model::RobotKind;
use franka_rt::lifecycle::{MotionError, Party};
use franka_rt::session::condition::{elapsed, force_z};
use franka_rt::session::{OnArrival, Reaction};
use franka_sim::arm::Family;
use franka_sim::{Arm, Touch};
use franka_tests::thorough;
use nalgebra::{Translation3, Vector3};

use super::{
    MS, above, at, felt, goes_on, reacted, realistic, report, says_so, table, tolerate, with_arm,
};

/// Stiffness of a padded table, and of a firm one, `[N/m]`.
const SOFT: f64 = 2000.0;
const FIRM: f64 = 20_000.0;

/// The threshold that the book recommends, `[N]`.
const THRESHOLD: f64 = 8.0;

/// Arms of both kinds: an exact one, a worn one, and two that stick. Thorough runs have more that
/// stick.
fn arms() -> Vec<(String, Lockstep)> {
    let [fr3, fer] = [RobotKind::Fr3, RobotKind::Fer];
    let family = Family::realistic();
    let named = |name: &str, kind, arm, seed| {
        let name = format!("{name} {kind:?} {seed}");
        (name, with_arm(kind, arm, seed))
    };
    let sampled = if thorough() { 6 } else { 2 };
    let sticking = (0..sampled).map(|seed| {
        let kind = [fr3, fer][seed as usize % 2];
        let arm = Arm::sample(kind, seed, &family);
        named("realistic", kind, Some(arm), seed)
    });
    let others = [
        named("ideal", fr3, None, 1),
        named("bad", fer, Some(Arm::bad(fer)), 1),
    ];
    others.into_iter().chain(sticking).collect()
}

/// Result of a guarded move, in milliseconds of the robot's clock and newtons.
#[derive(Debug, Default)]
struct Contact {
    /// From the contact to the state that was reacted to.
    seen_after: u64,
    /// From that state to the one in which the reference rests.
    braked_after: u64,
    /// From that state to the state in which nothing touches the arm.
    left_after: Option<u64>,
    at_reaction: f64,
    most: f64,
    last: f64,
}

/// Moves down to a table 4 cm below, and up again if told so.
fn guarded(lockstep: &mut Lockstep, velocity: f64, stiffness: f64, retreats: bool) -> Contact {
    let home = lockstep.arm_pose();
    let table = table(lockstep, 0.04, stiffness);
    let touched = force_z(THRESHOLD).relative();
    let reaction = match retreats {
        true => touched.then(home),
        false => Reaction::from(touched),
    };
    let down = above(lockstep, -0.1);
    let goal = at(
        velocity,
        down,
        reaction,
        OnArrival::ReportAndFinish,
        lockstep,
    );
    let goal = lockstep.submit(goal).expect("within reach");
    let (mut contact, mut braked, mut left) = (None, None, None);
    let mut seen = Contact::default();
    let (mut reaction, mut first) = (None, None);
    while goes_on(lockstep, goal) {
        lockstep.tick();
        let state = &lockstep.client.state;
        let (now, force) = (state.message_id, felt(lockstep, table));
        if lockstep.client.record.goal == goal.0 {
            let z = state.O_F_ext_hat_K[2];
            let change = (z - *first.get_or_insert(z)).abs();
            if reaction.is_none() && change >= THRESHOLD {
                reaction = Some(now);
                seen.at_reaction = force;
            }
        }
        if force > 0.0 {
            contact.get_or_insert(now);
        }
        seen.most = seen.most.max(force);
        if says_so(lockstep) {
            assert!(reaction.is_some_and(|at| at < now), "in the next cycle");
            if lockstep.client.record.dq_ref == [0.0; 7] {
                braked.get_or_insert(now);
            }
            if force == 0.0 {
                left.get_or_insert(now);
            }
            seen.last = force;
        }
    }
    let report = report(lockstep, goal);
    let reacted = report.reacted.expect("a contact");
    // The first state that fulfils the condition.
    assert_eq!(Some(reacted.time), reaction);
    assert_eq!(report.final_error.is_some(), retreats, "of the target");
    if retreats {
        let back = lockstep.arm_pose().translation.vector - home.translation.vector;
        assert!(back.norm() < 2e-3, "{back}");
    }
    seen.seen_after = reacted.time - contact.expect("a contact");
    seen.braked_after = braked.expect("a brake") - reacted.time;
    seen.left_after = left.map(|left| left - reacted.time);
    seen
}

/// The harness checks every command against the jerk limit, among others.
#[test]
fn a_guarded_move_stops_at_a_table_of_unknown_height() {
    // Velocity, stiffness of the table, the most that the arm may press with.
    for (velocity, stiffness, most) in [
        (0.02, SOFT, 12.0),
        (0.02, FIRM, 14.0),
        (0.05, SOFT, 13.0),
        (0.05, FIRM, 27.0),
        (0.1, SOFT, 21.0),
        (0.1, FIRM, 56.0),
    ] {
        for (arm, mut lockstep) in arms() {
            let seen = guarded(&mut lockstep, velocity, stiffness, false);
            println!("{velocity} m/s, {stiffness} N/m, {arm}: {seen:.1?}");
            assert!(seen.braked_after <= 145, "{arm}: {seen:?}");
            assert!(seen.most <= most, "{arm}: {seen:?}");
            if velocity == 0.1 {
                assert!(seen.seen_after <= 15, "{arm}: {seen:?}");
            }
        }
    }
}

#[test]
fn a_guarded_move_that_retreats_leaves_the_table_at_once() {
    for velocity in [0.05, 0.1] {
        for stiffness in [SOFT, FIRM] {
            for (arm, mut lockstep) in arms() {
                let seen = guarded(&mut lockstep, velocity, stiffness, true);
                println!("{velocity} m/s, {stiffness} N/m, {arm}: {seen:.1?}");
                assert!(
                    seen.left_after.is_some_and(|left| left <= 350),
                    "{arm}: {seen:?}"
                );
                assert_eq!(seen.last, 0.0);
            }
        }
    }
}

/// A budget that is slow by its accelerations would keep the arm on the table for seconds.
#[test]
fn an_arm_that_approaches_gently_retreats_all_the_same() {
    let mut lockstep = realistic(RobotKind::Fr3, 3);
    let home = lockstep.arm_pose();
    let table = table(&mut lockstep, 0.01, SOFT);
    let touched = force_z(THRESHOLD).relative().then(home);
    let down = above(&lockstep, -0.05);
    let mut goal = at(
        0.1,
        down,
        touched,
        OnArrival::ReportAndFinish,
        &mut lockstep,
    );
    goal.budget = goal.budget.scaled(0.2);
    let slow = goal.budget.translation.velocity;
    let goal = lockstep.submit(goal).expect("within reach");
    let (mut left, mut fastest) = (None, 0.0_f64);
    while goes_on(&lockstep, goal) {
        let before = lockstep.reference_pose().translation.vector;
        lockstep.tick();
        let now = lockstep.client.state.message_id;
        if says_so(&lockstep) {
            let moved = lockstep.reference_pose().translation.vector - before;
            fastest = fastest.max(moved.norm() / 1e-3);
            if felt(&lockstep, table) == 0.0 {
                left.get_or_insert(now);
            }
        }
    }
    let reacted = reacted(&mut lockstep, goal);
    let left = left.expect("it leaves") - reacted.time;
    println!("{left} ms, {fastest} m/s of {slow}");
    assert!(left < 800, "{left} ms");
    assert!(fastest < 1.05 * slow, "{fastest} m/s");
}

/// The law must not continue to push with its compensation.
#[test]
fn engaged_arm_rests_on_contact_and_presses_no_harder() {
    for (arm, mut lockstep) in arms() {
        let engaged = lockstep.engage();
        let table = table(&mut lockstep, 0.03, FIRM);
        let down = above(&lockstep, -0.1);
        let touched = force_z(THRESHOLD).relative();
        let goal = at(0.05, down, touched, OnArrival::ReportAndHold, &mut lockstep);
        let goal = lockstep.submit_within(engaged, goal).expect("within reach");
        reacted(&mut lockstep, goal);
        // It may bounce on the obstacle, and then settles.
        let (mut most, mut last) = (0.0_f64, 0.0);
        let mut moved = 0.0_f64;
        for _ in 0..3000 {
            lockstep.tick();
            most = most.max(felt(&lockstep, table));
        }
        let rests = lockstep.arm_pose().translation.vector;
        for _ in 0..2000 {
            lockstep.tick();
            last += felt(&lockstep, table) / 2000.0;
            moved = moved.max((lockstep.arm_pose().translation.vector - rests).norm());
        }
        println!("{arm}: at most {most:.1} N, {last:.1} N in the end, {moved:.5} m");
        assert!(most < THRESHOLD, "{arm}: {most} N");
        assert!((0.3..6.0).contains(&last), "{arm}: {last} N");
        assert!(moved < 1e-4, "{arm}: {moved} m");
        assert_eq!(lockstep.client.outcome(engaged), None);
    }
}

#[test]
fn a_hand_in_the_way_stops_the_arm() {
    for seed in 0..4 {
        let mut lockstep = realistic(RobotKind::Fr3, seed);
        let aside = (Translation3::new(0.0, 0.3, 0.0) * lockstep.arm_pose()).into();
        let met = franka_rt::session::condition::force(10.0) & elapsed(200 * MS);
        let goal = at(0.1, aside, met, OnArrival::ReportAndFinish, &mut lockstep);
        let goal = lockstep.submit(goal).expect("within reach");
        lockstep.run(1000);
        let hand = lockstep
            .robot
            .touch(Touch::force(Vector3::new(0.0, -12.0, 0.0)));
        let pushed = lockstep.client.state.message_id;
        let reacted = reacted(&mut lockstep, goal);
        println!("{} ms, {:.1?}", reacted.time - pushed, reacted.wrench);
        assert!((1..200).contains(&(reacted.time - pushed)), "{reacted:?}");
        // Action of the arm on the hand.
        assert!(reacted.wrench[1] > 5.0, "{reacted:?}");
        lockstep.robot.release(hand);
    }
}

/// Without the condition the arm continues to press up to the force cap.
#[test]
fn a_missed_contact_is_no_reaction() {
    let mut lockstep = Lockstep::ready();
    tolerate(&mut lockstep);
    let down = above(&lockstep, -0.05);
    let free = at(
        0.1,
        down,
        force_z(THRESHOLD),
        OnArrival::ReportAndFinish,
        &mut lockstep,
    );
    let free = lockstep.submit(free).expect("within reach");
    let arrived = report(&mut lockstep, free);
    assert_eq!(arrived.reacted, None);
    assert!(arrived.final_error.is_some());
    lockstep.until_idle(1000);

    let table = table(&mut lockstep, 0.03, FIRM);
    let down = above(&lockstep, -0.08);
    let goal = lockstep.begin(down);
    let outcome = lockstep.until_resolved(goal, 20_000);
    assert!(
        matches!(outcome, Err(MotionError::TargetNotReached(_))),
        "{outcome:?}"
    );
    assert!(felt(&lockstep, table) < 50.0);
}

/// A wall that was not there on the way down.
#[test]
fn a_retreat_that_something_holds_tells_of_the_contact_too() {
    let mut lockstep = Lockstep::ready();
    tolerate(&mut lockstep);
    let home = lockstep.arm_pose();
    let table = table(&mut lockstep, 0.04, FIRM);
    let touched = force_z(THRESHOLD).relative().then(home);
    let down = above(&lockstep, -0.1);
    let goal = at(
        0.05,
        down,
        touched,
        OnArrival::ReportAndFinish,
        &mut lockstep,
    );
    let goal = lockstep.submit(goal).expect("within reach");
    while !says_so(&lockstep) {
        lockstep.tick();
        assert!(goes_on(&lockstep, goal));
    }
    let hand = lockstep.robot.true_pose().translation.vector;
    let wall = Touch::wall(hand + Vector3::z() * 0.015, -Vector3::z());
    lockstep.robot.touch(wall.stiffness(SOFT));
    let error = lockstep.until_resolved(goal, 20_000).expect_err("a wall");
    let reacted = error.reacted().expect("a contact before that");
    assert!(-reacted.wrench[2] > 5.0, "{reacted:?}");
    assert!(error.is_ready_for_more(), "{error}");
    assert_eq!(error.party(), Party::Robot);
    let MotionError::AfterReaction { error, .. } = error else {
        panic!("{error}");
    };
    assert!(
        matches!(*error, MotionError::TargetNotReached(_)),
        "{error}"
    );
    assert_eq!(felt(&lockstep, table), 0.0);
}
