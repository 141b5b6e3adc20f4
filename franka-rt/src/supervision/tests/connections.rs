//! Connections: lost, made again, given up; and what is told of them.

use super::*;

#[test]
fn a_lost_connection_is_made_again_at_once_and_then_with_growing_pauses() {
    let mut robot = Supervised::ready(without_chance());
    let begun = robot.now;
    robot.lose(CloseReason::ClosedByPeer);
    assert_eq!(robot.condition(), Condition::Unready(Unready::Disconnected));
    assert_eq!(robot.connects(), 0, "the thread before is still there");
    robot.pass(20);
    robot.release();
    for (attempts, at) in [(1, 20), (2, 120), (3, 320), (4, 720), (5, 1120)] {
        let pause = begun + at - robot.now;
        robot.pass(pause.saturating_sub(1));
        assert_eq!(robot.connects(), attempts - usize::from(pause > 0));
        robot.pass(pause.min(1));
        assert_eq!(robot.connects(), attempts);
        robot.fails(refused("nobody is there"));
        assert_eq!(robot.supervision.health().attempts, attempts as u32);
    }
    robot.pass(400);
    assert!(robot.connect());
    let after = Some(MS(1520));
    let reason = CloseReason::ClosedByPeer;
    let connected = EventKind::Connected { attempts: 6, after };
    assert_eq!(robot.told, [EventKind::Lost { reason }, connected]);
    let health = robot.supervision.health();
    assert_eq!(health.condition, Condition::Ready);
    assert_eq!((health.reconnects, health.last_reconnect), (1, after));
    assert_eq!(health.attempts, 0);
    assert_eq!(robot.supervision.deadline(), None);
}

#[test]
fn connections_that_do_not_last_are_not_made_again_at_once() {
    let mut robot = Supervised::ready(without_chance());
    for connects in 1..=3 {
        robot.lose(CloseReason::ClosedByPeer);
        robot.release();
        assert_eq!(
            robot.connects(),
            if connects == 1 { 1 } else { connects - 1 }
        );
        robot.pass(400);
        assert_eq!(robot.connects(), connects);
        assert!(robot.connect());
    }
    robot.pass(1000);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    assert_eq!(robot.connects(), 4, "this one has lasted");
}

#[test]
fn it_gives_up_as_told_and_when_another_robot_answers() {
    let mut robot = Supervised::ready(without_chance().give_up_after(MS(250)));
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    robot.fails(refused("first"));
    robot.pass(100);
    robot.fails(refused("second"));
    robot.pass(200);
    robot.fails(refused("third"));
    let reason = CloseReason::GivenUp {
        attempts: 3,
        after: MS(300),
        text: "third".into(),
    };
    assert_eq!(robot.told.last(), Some(&EventKind::Closed { reason }));
    assert_eq!(robot.condition(), Condition::Closed);
    robot.pass(10_000);
    assert_eq!(robot.connects(), 3);
    assert!(!robot.connect(), "it comes too late");

    let mut robot = Supervised::ready(without_chance());
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    let text = String::from("it speaks version 5");
    robot.fails(ConnectFailure::AnotherRobot { text: text.clone() });
    let reason = CloseReason::AnotherRobot { text };
    assert_eq!(robot.told.last(), Some(&EventKind::Closed { reason }));
}

#[test]
fn what_this_program_closes_is_not_made_again() {
    for reason in [CloseReason::ClosedByUs, CloseReason::RuntimeEnded] {
        let mut robot = Supervised::ready(without_chance());
        robot.lose(reason.clone());
        robot.release();
        assert_eq!(robot.told, [EventKind::Closed { reason }]);
        assert_eq!(robot.connects(), 0);
    }
    let mut robot = Supervised::ready(without_chance().motions_wait(MS(1000)));
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    assert!(matches!(robot.submit(1), Admission::Wait));
    let (reason, now) = (CloseReason::ClosedByUs, MS(robot.now));
    robot.after(|it| it.close(reason.clone(), now));
    let closed = MotionError::ConnectionClosed { reason };
    assert_eq!(robot.motions(), [(1, Some(closed))]);
    assert!(!robot.connect(), "the attempt was under way");
}

#[test]
fn a_robot_that_is_only_watched_tells_what_happens_and_asks_for_nothing() {
    let mut robot = Supervised::connected(None);
    robot.reflex([COLLISION]);
    assert!(matches!(robot.submit(1), Admission::Begin));
    robot.pass(60_000);
    robot.recovers();
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    robot.pass(60_000);
    assert!(robot.asked.is_empty(), "{:?}", robot.asked);
    let reason = CloseReason::ClosedByPeer;
    let expected = [
        EventKind::Reflex(Reflex {
            number: 1,
            errors: COLLISION.into(),
            error: None,
        }),
        EventKind::NotRecovered {
            reflex: 1,
            why: NotRecovered::Never,
        },
        EventKind::Recovered {
            reflex: 1,
            after: MS(60_000),
            by_supervisor: false,
        },
        EventKind::Lost {
            reason: reason.clone(),
        },
        EventKind::Closed { reason },
    ];
    assert_eq!(robot.told, expected);
}

#[test]
fn a_silence_is_told_and_given_up_after_its_time() {
    let mut robot = Supervised::ready(without_chance().silence(MS(3000)));
    let silence = MS(1000);
    let now = MS(robot.now);
    robot.after(|it| it.on_silence(silence, now));
    robot.after(|it| it.on_silence(silence, now));
    robot.pass(2999);
    assert!(robot.asked.is_empty());
    robot.shows(RobotMode::Idle);
    let resumed = EventKind::Resumed { after: MS(2999) };
    assert_eq!(robot.told, [EventKind::Silent { silence }, resumed]);
    assert_eq!(robot.condition(), Condition::Ready);

    let now = MS(robot.now);
    robot.after(|it| it.on_silence(silence, now));
    robot.pass(10_000);
    let [Output::Disconnect { reason }] = &robot.asked[..] else {
        panic!("once: {:?}", robot.asked)
    };
    assert_eq!(*reason, CloseReason::Silent { silence: MS(3000) });
    robot.lose(CloseReason::Silent { silence: MS(3000) });
    robot.release();
    robot.connect();
    let Some(EventKind::Connected { after, .. }) = robot.told.last() else {
        panic!("{:?}", robot.told)
    };
    assert_eq!(*after, Some(MS(10_000)), "it began with the silence");
}

#[test]
fn loads_that_change_are_told_also_across_a_connection() {
    let mut robot = Supervised::ready(without_chance());
    robot.state.m_load = 0.5;
    robot.shows(RobotMode::Idle);
    robot.shows(RobotMode::Idle);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    robot.state.m_load = 0.0;
    robot.connect();
    let load = |kind: &EventKind| match kind {
        EventKind::LoadChanged { load } => Some(load.m_load),
        _ => None,
    };
    let loads: Vec<f64> = robot.told.iter().filter_map(load).collect();
    assert_eq!(loads, [0.5, 0.0]);
}
