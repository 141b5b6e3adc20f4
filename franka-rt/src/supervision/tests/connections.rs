//! Connections that are lost, restored or given up, and their events.

use super::*;

#[test]
fn lost_connection_is_retried_at_once_then_with_pauses() {
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
fn reconnecting_ends_at_the_limit_or_for_another_robot() {
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

/// A robot that was restarted, and an arm that was moved meanwhile.
const CHANGES: [fn(&mut RobotState); 4] = [
    |state| state.message_id = 1,
    |state| state.q[3] += 0.02,
    |state| state.F_T_NE[14] += 0.1,
    |state| state.message_id += 3_600_000,
];

/// Loses the connection and restores it with a robot that has changed. Returns the reported
/// differences.
fn change(robot: &mut Supervised, change: fn(&mut RobotState), mode: RobotMode) -> Differences {
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    robot.pass(3000);
    robot.goes_on();
    change(&mut robot.state);
    robot.state.robot_mode = mode;
    assert!(robot.connect_as_it_is());
    let told = robot.told.iter().find_map(|kind| match kind {
        EventKind::Unrecognised { differences } => Some(*differences),
        _ => None,
    });
    told.expect("something differs")
}

#[test]
fn robot_that_is_not_recognised_is_recovered_only_by_agreement() {
    for changed in CHANGES {
        let mut robot = Supervised::ready(without_chance().recover(100, WINDOW));
        robot.state.errors = COLLISION.into();
        let differences = change(&mut robot, changed, RobotMode::Reflex);
        assert!(robot.recoveries().is_empty(), "{differences}");
        let why = Unready::Unrecognised(differences);
        assert_eq!(robot.condition(), Condition::Unready(why));
        let asked = robot.asked.iter().find_map(|output| match output {
            Output::Ask(reflex) => Some(reflex.clone()),
            _ => None,
        });
        let asked = asked.expect("somebody is asked");
        assert_eq!(asked.differences, Some(differences));
        let now = MS(robot.now);
        assert!(robot.after(|it| it.agree(asked.number, true, now)));
        assert_eq!(robot.recoveries(), [asked.number]);
        robot.answers(asked.number, Ok(()));
        robot.recovers();
        assert_eq!(robot.condition(), Condition::Ready);
        // From here on, the robot is known.
        robot.reflex([COLLISION]);
        assert_eq!(robot.recoveries(), [asked.number, asked.number + 1]);
    }
}

#[test]
fn motion_does_not_wait_for_a_robot_that_is_not_recognised() {
    for changed in CHANGES {
        let mut robot = Supervised::ready(without_chance().motions_wait(MS(60_000)));
        robot.lose(CloseReason::ClosedByPeer);
        assert!(matches!(robot.submit(1), Admission::Wait));
        robot.release();
        robot.goes_on();
        changed(&mut robot.state);
        assert!(robot.connect_as_it_is());
        let motions = robot.motions();
        let [(1, Some(MotionError::NotReady { why, .. }))] = &motions[..] else {
            panic!("{motions:?}")
        };
        assert!(matches!(why, Unready::Unrecognised(_)), "{why}");
        // A caller that requests a motion now accepts the robot in its present condition.
        assert_eq!(robot.condition(), Condition::Ready);
        assert!(matches!(robot.submit(2), Admission::Begin));
    }
}

#[test]
fn robot_that_is_recognised_is_recovered_as_before() {
    let mut robot = Supervised::ready(without_chance().recover(100, WINDOW));
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    robot.pass(30_000);
    robot.state.errors = COLLISION.into();
    robot.state.robot_mode = RobotMode::Reflex;
    robot.state.q[3] += 1e-3;
    assert!(robot.connect());
    assert_eq!(robot.recoveries().len(), 1);
}

#[test]
fn connection_closed_by_us_is_not_made_again() {
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
fn unsupervised_robot_tells_events_and_asks_for_nothing() {
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
            differences: None,
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
