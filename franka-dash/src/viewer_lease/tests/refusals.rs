//! Commanders and refused requests.

use franka_async::connection::lease::Taken;

use super::*;

#[test]
fn second_viewer_commands_only_once_the_lease_is_free() {
    let mut server = Server::holding(3);
    let name = "a person".to_owned();
    let taken = Refusal::Taken(Taken { name });
    assert_eq!(server.take(OTHER).refusal, Some(taken.clone()));
    for request in [
        begin(0.05),
        Request::Hold { seq: 4 },
        Request::End {},
        Request::Release {},
        Request::Recover {},
    ] {
        let step = server.ask(OTHER, request);
        assert_eq!(step.refusal, Some(Refusal::NoLease));
        assert_eq!((step.effect, step.ended), (None, None));
    }
    assert!(server.viewer_lease.status().holding);

    server.ask(COMMANDER, Request::Release {});
    assert_eq!(server.take(OTHER).refusal, None);
    assert_eq!(server.take(COMMANDER).refusal, Some(taken));
    server.pass(4000);
    server.ask(OTHER, Request::Alive {});
    server.pass(5000);
    assert_eq!(server.viewer_lease.status().commander, Some(OTHER));
    server.pass(1);
    assert_eq!(server.viewer_lease.status().commander, None);
    assert_eq!(server.take(COMMANDER).refusal, None);
    server.viewer_lease.gone(COMMANDER);
    assert_eq!(server.take(OTHER).refusal, None);
}

#[test]
fn lease_of_another_service_keeps_viewers_from_commanding() {
    let mut server = Server::new();
    let silence = Duration::from_millis(300);
    let lease = server.lease.clone();
    let other = lease.take("a joystick", silence, server.start);
    let other = other.expect("it is free");
    let refused = server.take(COMMANDER).refusal;
    let name = "a joystick".to_owned();
    assert_eq!(refused, Some(Refusal::Taken(Taken { name: name.clone() })));
    let status = server.viewer_lease.status();
    assert_eq!((status.commander, status.name), (None, Some(name)));
    assert_eq!(server.begin(COMMANDER).refusal, Some(Refusal::NoLease));
    drop(other);
    assert_eq!(server.take(COMMANDER).refusal, None);
    let later = server.start + server.now;
    assert!(lease.take("a joystick", silence, later).is_err());
}

#[test]
fn lease_that_another_service_finds_lost_ends_the_hold() {
    let mut server = Server::holding(3);
    // The other service checks later than this server, and takes the lease.
    let later = server.start + server.now + LEASE + Duration::from_millis(1);
    let other = server.lease.take("a joystick", LEASE, later);
    let other = other.expect("it is free");
    let step = server.ask(COMMANDER, Request::Hold { seq: 4 });
    assert_eq!(step.ended, Some(Lost::Silent));
    assert_eq!(step.refusal, Some(Refusal::NoLease));
    assert_eq!(server.begin(COMMANDER).refusal, Some(Refusal::NoLease));
    server.assert_at_rest();
    assert!(other.is_held(later));
}

#[test]
fn lease_with_patience_outlasts_its_deadman() {
    let mut server = Server::with(Permissions {
        motion: true,
        patience: Duration::from_secs(30),
        ..Permissions::default()
    });
    server.take(COMMANDER);
    assert!(server.begin(COMMANDER).effect.is_some());
    assert_eq!(server.pass(30_150), None);
    assert!(server.viewer_lease.status().holding);
    assert_eq!(server.pass(1), Some(Lost::Silent));
    assert_eq!(server.viewer_lease.status().commander, Some(COMMANDER));
}

#[test]
fn a_begin_is_refused_with_the_reason() {
    let mut server = Server::new();
    server.take(COMMANDER);
    for speed in [0.0, -0.1, 0.2501, f64::NAN, f64::INFINITY] {
        let refusal = server.ask(COMMANDER, begin(speed)).refusal;
        assert!(matches!(refusal, Some(Refusal::Value(_))), "{speed}");
    }
    for motion in [
        Motion::Joint { joint: 8, up: true },
        Motion::Joints { q: [f64::NAN; 7] },
        Motion::Rotate {
            direction: [0.0; 3],
            axes: Axes::Tool,
        },
    ] {
        let request = Request::Begin { motion, speed: 0.1 };
        let refusal = server.ask(COMMANDER, request).refusal;
        assert!(matches!(refusal, Some(Refusal::Value(_))), "{motion:?}");
    }
    let now = server.now;
    let slow = Duration::from_millis(101);
    let begun = |server: &mut Server, round_trip| {
        let step = server
            .viewer_lease
            .handle(now, COMMANDER, round_trip, begin(0.1));
        (step.effect.is_some(), step.refusal)
    };
    let refused = (false, Some(Refusal::Latency(slow)));
    assert_eq!(begun(&mut server, Some(slow)), refused);
    assert_eq!(begun(&mut server, None), (false, Some(Refusal::Unmeasured)));
    assert_eq!(begun(&mut server, Some(ROUND_TRIP_MAX)), (true, None));
}

#[test]
fn a_view_only_server_takes_stops_and_nothing_else() {
    let mut server = Server::with(Permissions::default());
    assert_eq!(server.take(COMMANDER).refusal, Some(Refusal::ViewOnly));
    assert_eq!(server.begin(COMMANDER).refusal, Some(Refusal::NoLease));
    let stopped = server.ask(OTHER, Request::Stop {});
    assert_eq!(stopped, effect(Effect::Stop));
    // A simulated robot moved by another program: it can be disturbed, but not moved.
    let mut server = Server::with(Permissions {
        disturbances: true,
        ..Permissions::default()
    });
    assert_eq!(server.take(COMMANDER).refusal, None);
    assert_eq!(server.begin(COMMANDER).refusal, Some(Refusal::ViewOnly));
    let tuning = Tuning::default();
    for request in [Request::Recover {}, Request::Tune { tuning }] {
        let refusal = server.ask(COMMANDER, request).refusal;
        assert_eq!(refusal, Some(Refusal::ViewOnly));
    }
}

#[test]
fn gripper_and_recorder_are_there_or_refused() {
    let home = || Request::Gripper {
        action: GripperAction::Home {},
    };
    let record = || Request::Record { on: true };
    let mut server = Server::new();
    for request in [home(), record()] {
        assert_eq!(
            server.ask(COMMANDER, request).refusal,
            Some(Refusal::NoLease)
        );
    }
    server.take(COMMANDER);
    let acted = server.ask(COMMANDER, home());
    assert_eq!(acted, effect(Effect::Gripper(GripperAction::Home {})));
    assert_eq!(
        server.ask(COMMANDER, record()),
        effect(Effect::Record(true))
    );
    for (permissions, refusals) in [
        (
            Permissions {
                motion: true,
                ..Permissions::default()
            },
            [Some(Refusal::NoGripper), Some(Refusal::NoRecordings)],
        ),
        // A view-only page may record.
        (
            Permissions {
                gripper: true,
                recording: true,
                ..Permissions::default()
            },
            [Some(Refusal::ViewOnly), None],
        ),
    ] {
        let mut server = Server::with(permissions);
        assert_eq!(server.take(COMMANDER).refusal, None);
        let got = [home(), record()].map(|it| server.ask(COMMANDER, it).refusal);
        assert_eq!(got, refusals);
    }
}

#[test]
fn only_a_simulated_robot_is_disturbed_and_within_bounds() {
    let push = |force| Request::Disturb {
        disturbance: Disturbance::Push {
            link: 7,
            offset: [0.0; 3],
            force: [0.0, 0.0, force],
        },
    };
    let mut server = Server::new();
    server.take(COMMANDER);
    assert!(server.ask(COMMANDER, push(20.0)).effect.is_some());
    for force in [201.0, f64::NAN] {
        let step = server.ask(COMMANDER, push(force));
        assert!(step.effect.is_none() && step.refusal.is_some());
    }
    let mut robot = Server::with(Permissions {
        motion: true,
        ..Permissions::default()
    });
    robot.take(COMMANDER);
    let refusal = robot.ask(COMMANDER, push(20.0)).refusal;
    assert_eq!(refusal, Some(Refusal::NoSimulator));
}
