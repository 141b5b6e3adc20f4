//! Reflexes that are reported, and then recovered from or left to a person.

use super::*;

#[test]
fn reflex_is_told_and_recovered_once_its_motion_has_ended() {
    let mut robot = Supervised::ready(without_chance().recover(3, WINDOW));
    let now = MS(robot.now);
    robot.after(|it| it.on_begun(GoalId(7), now));
    robot.shows(RobotMode::Move);
    robot.told.clear();
    robot.reflex([COLLISION]);
    assert_eq!(robot.condition(), Condition::Unready(Unready::Recovering));
    robot.pass(30);
    assert_eq!((robot.told.len(), robot.asked.len()), (0, 0));
    let now = MS(robot.now);
    robot.after(|it| it.on_ended(GoalId(7), &collision(), now));
    let [
        EventKind::MotionEnded { goal: 7, .. },
        EventKind::Reflex(reflex),
    ] = &robot.told[..]
    else {
        panic!("{:?}", robot.told)
    };
    assert!(reflex.error.is_some(), "it has the log of the motion");
    assert_eq!(robot.recoveries(), [1]);
    robot.shows(RobotMode::AutomaticErrorRecovery);
    robot.pass(100);
    robot.answers(1, Ok(()));
    assert_eq!(robot.condition(), Condition::Unready(Unready::Recovering));
    robot.pass(5);
    robot.recovers();
    let after = MS(135);
    let recovered = EventKind::Recovered {
        reflex: 1,
        after,
        by_supervisor: true,
    };
    assert_eq!(robot.told.last(), Some(&recovered));
    let health = robot.supervision.health();
    assert_eq!((health.recoveries, health.last_recovery), (1, Some(after)));
    assert_eq!(health.condition, Condition::Ready);
    robot.pass(10_000);
    assert_eq!(robot.recoveries(), [1]);
}

/// On a busy host, states may be read after the replies.
#[test]
fn reflex_that_ends_a_motion_before_its_state_has_a_log() {
    let mut robot = Supervised::ready(without_chance().recover(3, WINDOW));
    let now = MS(robot.now);
    robot.after(|it| it.on_begun(GoalId(7), now));
    robot.after(|it| it.on_ended(GoalId(7), &collision(), now));
    robot.reflex([COLLISION]);
    let told = robot.told.last();
    assert!(
        matches!(told, Some(EventKind::Reflex(Reflex { error: Some(_), .. }))),
        "{told:?}"
    );
}

#[test]
fn recovery_obeys_the_count_and_errors_of_the_policy() {
    let mut robot = Supervised::ready(without_chance());
    robot.reflex([COLLISION]);
    assert_eq!(robot.left(), Some(NotRecovered::Never));
    assert_eq!(robot.condition(), Condition::Unready(Unready::Reflex));

    let mut robot = Supervised::ready(without_chance().recover(2, MS(1000)));
    for reflex in 1..=2 {
        robot.reflex([COLLISION]);
        robot.pass(100);
        robot.answers(reflex, Ok(()));
        robot.recovers();
    }
    assert_eq!(robot.left(), None);
    robot.reflex([COLLISION]);
    assert_eq!(robot.left(), Some(NotRecovered::TooOften));
    robot.pass(10_000);
    assert_eq!(robot.recoveries(), [1, 2], "a person is needed now");
    robot.recovers();
    robot.reflex([COLLISION]);
    assert_eq!(robot.recoveries(), [1, 2, 4], "the window has passed");

    let only = without_chance().recover(9, WINDOW).only([COLLISION]);
    assert_eq!(without_chance().only([COLLISION]).recover(9, WINDOW), only);
    for (errors, left) in [
        (vec![COLLISION], None),
        // A reflex whose state names no error may have any cause.
        (vec![], Some(NotRecovered::OtherError)),
        (
            vec![COLLISION, RobotError::PowerLimitViolation],
            Some(NotRecovered::OtherError),
        ),
        (
            vec![RobotError::JointReflex],
            Some(NotRecovered::OtherError),
        ),
    ] {
        let mut robot = Supervised::ready(only);
        robot.reflex(errors);
        assert_eq!(robot.left(), left);
        assert_eq!(robot.recoveries().len(), usize::from(left.is_none()));
    }
}

#[test]
fn recoveries_that_fail_are_repeated_with_pauses_and_count() {
    let mut robot = Supervised::ready(without_chance().recover(3, WINDOW));
    robot.reflex([COLLISION]);
    robot.answers(1, Err(RecoveryFailure::Other));
    robot.pass(99);
    assert_eq!(robot.recoveries(), [1]);
    robot.pass(1);
    assert_eq!(robot.recoveries(), [1, 1]);
    robot.answers(1, Ok(()));
    // The robot has answered, but still shows the reflex.
    robot.pass(2000 + 199);
    assert_eq!(robot.recoveries(), [1, 1]);
    robot.pass(1);
    assert_eq!(robot.recoveries(), [1, 1, 1]);
    robot.answers(1, Err(RecoveryFailure::Other));
    robot.pass(60_000);
    assert_eq!(robot.recoveries(), [1, 1, 1]);
    assert_eq!(robot.left(), Some(NotRecovered::TooOften));

    let mut robot = Supervised::ready(without_chance().recover(3, WINDOW));
    robot.reflex([COLLISION]);
    robot.answers(1, Err(RecoveryFailure::ByHand));
    robot.pass(60_000);
    assert_eq!(robot.left(), Some(NotRecovered::ByHand));
    assert_eq!(robot.recoveries(), [1]);
}

#[test]
fn a_recovery_waits_for_the_release_of_the_user_stop() {
    let mut robot = Supervised::ready(without_chance().recover(3, WINDOW));
    robot.shows(RobotMode::UserStopped);
    assert_eq!(robot.condition(), Condition::Unready(Unready::UserStopped));
    robot.pass(5000);
    robot.reflex([COLLISION]);
    assert_eq!(robot.recoveries(), [1]);
    // The stop is pressed again while the robot recovers.
    robot.shows(RobotMode::UserStopped);
    robot.answers(1, Err(RecoveryFailure::Other));
    robot.pass(5000);
    assert_eq!(robot.recoveries(), [1]);
    robot.shows(RobotMode::Reflex);
    assert_eq!(robot.recoveries(), [1, 1]);
    let stops: Vec<_> = robot
        .told
        .iter()
        .filter(|kind| matches!(kind, EventKind::UserStop { .. }))
        .collect();
    let stop = |pressed| EventKind::UserStop { pressed };
    assert_eq!(
        stops,
        [&stop(true), &stop(false), &stop(true), &stop(false)]
    );
}

#[test]
fn recovery_waits_for_agreement_to_the_same_reflex() {
    let policy = without_chance().recover(3, WINDOW).ask_first();
    let mut robot = Supervised::ready(policy);
    robot.reflex([COLLISION]);
    let awaited = Condition::Unready(Unready::AgreementAwaited);
    assert_eq!(robot.condition(), awaited);
    assert_eq!(robot.supervision.health().reflex, Some(1));
    robot.pass(60_000);
    let [Output::Ask(Reflex { number: 1, .. })] = &robot.asked[..] else {
        panic!("asked once: {:?}", robot.asked)
    };
    // Another error is added before the answer.
    robot.reflex([COLLISION, RobotError::JointReflex]);
    let now = MS(robot.now);
    assert!(!robot.after(|it| it.agree(1, true, now)));
    assert_eq!(robot.condition(), awaited);
    assert!(robot.recoveries().is_empty());
    assert!(robot.after(|it| it.agree(2, true, now)));
    assert_eq!(robot.recoveries(), [2]);
    assert!(!robot.after(|it| it.agree(2, true, now)), "once is enough");

    let mut robot = Supervised::ready(policy);
    robot.reflex([COLLISION]);
    let now = MS(robot.now);
    assert!(robot.after(|it| it.agree(1, false, now)));
    assert_eq!(robot.left(), Some(NotRecovered::Declined));
    assert!(!robot.after(|it| it.agree(1, true, now)));
    assert!(robot.recoveries().is_empty());
}
