//! Motions that are requested while the robot is not ready.

use super::*;

#[test]
fn a_motion_meanwhile_is_refused_unless_it_may_wait() {
    let mut robot = Supervised::ready(without_chance().recover(3, WINDOW));
    robot.reflex([COLLISION]);
    let Admission::Refuse(error) = robot.submit(1) else {
        panic!("it does not wait")
    };
    assert_eq!(error, not_ready(Unready::Recovering, 0));
    robot.lose(CloseReason::ClosedByPeer);
    let Admission::Refuse(error) = robot.submit(2) else {
        panic!("it does not wait")
    };
    assert_eq!(error, not_ready(Unready::Disconnected, 0));
    // In conditions that the supervisor will not change, the robot itself refuses motions.
    let mut robot = Supervised::ready(without_chance().motions_wait(MS(1000)));
    for mode in [
        RobotMode::UserStopped,
        RobotMode::Guiding,
        RobotMode::Other,
        RobotMode::Reflex,
        RobotMode::Idle,
        RobotMode::Move,
    ] {
        robot.shows(mode);
        assert!(matches!(robot.submit(3), Admission::Begin), "{mode}");
    }
}

#[test]
fn waiting_motion_begins_when_ready_but_not_too_late() {
    let policy = without_chance().recover(3, WINDOW).motions_wait(MS(500));
    let mut robot = Supervised::ready(policy);
    robot.reflex([COLLISION]);
    assert!(matches!(robot.submit(1), Admission::Wait));
    robot.pass(499);
    robot.answers(1, Ok(()));
    robot.recovers();
    assert_eq!(robot.motions(), [(1, None)]);

    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    assert!(matches!(robot.submit(2), Admission::Wait));
    robot.pass(500);
    let late = not_ready(Unready::Disconnected, 500);
    assert_eq!(robot.motions(), [(2, Some(late))]);
    assert!(robot.connect());
    assert_eq!(robot.motions(), []);
}

#[test]
fn latched_stop_refuses_motions_across_connections() {
    let latched = not_ready(Unready::StopLatched, 0);
    for policy in [
        None,
        Some(without_chance().recover(3, WINDOW).motions_wait(MS(60_000))),
    ] {
        let mut robot = Supervised::connected(policy);
        let refused = |robot: &mut Supervised, id| match robot.submit(id) {
            Admission::Refuse(error) => assert_eq!(error, latched, "{id}"),
            other => panic!("{id}: {other:?}"),
        };
        let now = MS(robot.now);
        robot.after(|it| it.latch_stop(now));
        assert_eq!(robot.condition(), Condition::Unready(Unready::StopLatched));
        refused(&mut robot, 1);
        if policy.is_some() {
            // The latch refuses motions in a reflex, without a connection, and on the next
            // connection.
            robot.reflex([COLLISION]);
            refused(&mut robot, 2);
            robot.lose(CloseReason::ClosedByPeer);
            refused(&mut robot, 3);
            robot.release();
            robot.pass(500);
            assert!(robot.connect());
            refused(&mut robot, 4);
            robot.recovers();
            refused(&mut robot, 5);
            assert_eq!(robot.condition(), Condition::Unready(Unready::StopLatched));
        }
        assert_eq!(robot.motions(), []);
        let now = MS(robot.now);
        assert!(robot.after(|it| it.release_stop(now)));
        assert!(!robot.after(|it| it.release_stop(now)), "it was released");
        assert_eq!(robot.condition(), Condition::Ready);
        assert!(matches!(robot.submit(6), Admission::Begin));
        let latches = robot.told.iter().filter_map(|kind| match kind {
            EventKind::StopLatch { latched } => Some(*latched),
            _ => None,
        });
        assert_eq!(latches.collect::<Vec<_>>(), [true, false]);
    }
}

#[test]
fn latched_stop_takes_back_the_motion_that_waits() {
    let mut robot = Supervised::ready(without_chance().motions_wait(MS(60_000)));
    robot.lose(CloseReason::ClosedByPeer);
    assert!(matches!(robot.submit(1), Admission::Wait));
    let now = MS(robot.now);
    robot.after(|it| it.latch_stop(now));
    assert_eq!(robot.motions(), [(1, Some(MotionError::Stopped))]);
    robot.after(|it| it.release_stop(now));
    robot.release();
    assert!(robot.connect());
    assert_eq!(robot.motions(), [], "it never begins");
}

/// A program may pass the longest duration to wait indefinitely.
#[test]
fn motions_and_silences_may_take_the_longest_duration() {
    let ever = Duration::MAX;
    let policy = Policy::default()
        .reconnect(Backoff {
            first: ever,
            most: ever,
            jitter: 0.0,
        })
        .silence(ever)
        .give_up_after(ever)
        .motions_wait(ever);
    let mut robot = Supervised::ready(policy);
    let now = MS(robot.now);
    robot.after(|it| it.on_silence(MS(1000), now));
    assert!(matches!(robot.submit(1), Admission::Wait));
    robot.pass(86_400_000);
    assert_eq!(robot.motions(), []);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    robot.fails(refused("refused"));
    robot.pass(86_400_000);
    assert_eq!(robot.connects(), 1, "the pause is as long");
    assert_eq!(robot.supervision.deadline(), Some(ever));
}

#[test]
fn newest_waiting_motion_counts_and_a_stop_withdraws_it() {
    let policy = without_chance().motions_wait(MS(500));
    let mut robot = Supervised::ready(policy);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    assert!(matches!(robot.submit(1), Admission::Wait));
    assert!(matches!(robot.submit(2), Admission::Wait));
    assert_eq!(robot.motions(), [(1, Some(MotionError::Superseded))]);
    let session = |motion| match motion {
        NewMotion::Goal { goal, .. } => NewMotion::Session {
            goal,
            engagement: crate::lifecycle::Engagement::default(),
        },
        other => other,
    };
    let busy = |admission| matches!(admission, Admission::Refuse(MotionError::Busy));
    assert!(busy(robot.submit_as(3, session)), "it supersedes nothing");
    assert!(robot.after(|it| it.withdraw(GoalId(2))));
    assert!(!robot.after(|it| it.withdraw(GoalId(2))));
    assert!(matches!(robot.submit_as(4, session), Admission::Wait));
    assert!(busy(robot.submit(5)), "it is not superseded");
    robot.after(Supervision::stop);
    assert_eq!(robot.motions(), [(4, Some(MotionError::Stopped))]);
    assert!(robot.connect());
    assert_eq!(robot.motions(), []);

    robot.lose(CloseReason::ClosedByPeer);
    let [ticket] = StartBarrier::new().tickets();
    let together = |motion| match motion {
        NewMotion::Goal {
            goal,
            path,
            session,
            ..
        } => NewMotion::Goal {
            path,
            goal,
            ticket: Some(ticket),
            session,
        },
        other => other,
    };
    let refused = robot.submit_as(6, together);
    assert!(
        matches!(refused, Admission::Refuse(MotionError::NotReady { .. })),
        "the others would wait, too: {refused:?}"
    );
    let of_session = |motion| match motion {
        NewMotion::Goal {
            goal, path, ticket, ..
        } => NewMotion::Goal {
            path,
            goal,
            ticket,
            session: Some(GoalId(4)),
        },
        other => other,
    };
    let begun = robot.submit_as(7, of_session);
    assert!(
        matches!(begun, Admission::Begin),
        "its session has ended and says so: {begun:?}"
    );
}

#[test]
fn whatever_else_happens_turns_away_a_motion_that_waits() {
    type Mishap = fn(&mut Supervised);
    let mishaps: [(Mishap, MotionError); 7] = [
        (
            |robot| robot.reflex([COLLISION, RobotError::JointReflex]),
            not_ready(Unready::Recovering, 50),
        ),
        (
            |robot| {
                robot.shows(RobotMode::AutomaticErrorRecovery);
                robot.reflex([COLLISION]);
            },
            not_ready(Unready::Recovering, 50),
        ),
        (
            |robot| robot.lose(CloseReason::ClosedByPeer),
            not_ready(Unready::Disconnected, 50),
        ),
        (
            |robot| {
                let now = MS(robot.now);
                robot.after(|it| it.on_silence(MS(1000), now));
            },
            not_ready(Unready::Silent, 50),
        ),
        (
            |robot| robot.shows(RobotMode::UserStopped),
            not_ready(Unready::UserStopped, 50),
        ),
        (
            |robot| robot.shows(RobotMode::Guiding),
            not_ready(Unready::Guided, 50),
        ),
        (
            |robot| robot.shows(RobotMode::Other),
            not_ready(Unready::Braked, 50),
        ),
    ];
    for (mishap, error) in mishaps {
        let policy = without_chance().recover(9, WINDOW).motions_wait(MS(1000));
        let mut robot = Supervised::ready(policy);
        robot.reflex([COLLISION]);
        assert!(matches!(robot.submit(1), Admission::Wait));
        robot.pass(50);
        mishap(&mut robot);
        assert_eq!(robot.motions(), [(1, Some(error))]);
    }
}

/// The network was cut in the middle of a motion.
#[test]
fn a_reflex_that_is_found_with_a_connection_belongs_to_its_loss() {
    let policy = without_chance().recover(9, WINDOW).motions_wait(MS(5000));
    let mut robot = Supervised::ready(policy);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    assert!(matches!(robot.submit(1), Admission::Wait));
    robot.state.errors = COLLISION.into();
    robot.state.robot_mode = RobotMode::Reflex;
    assert!(robot.connect());
    assert_eq!(robot.recoveries(), [1]);
    robot.answers(1, Ok(()));
    robot.recovers();
    assert_eq!(robot.motions(), [(1, None)]);
}
