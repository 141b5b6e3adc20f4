//! Tests of every way in which a hold can end early.

use super::*;

#[test]
fn a_hold_goes_on_while_messages_come_in_time() {
    let mut server = Server::holding(200);
    assert!(server.viewer_lease.status().holding);
    assert_eq!(server.pass(150), None);
    let kept = server.ask(COMMANDER, Request::Hold { seq: 201 });
    assert_eq!(kept, effect(Effect::KeepAlive));
}

#[test]
fn a_hold_ends_by_silence_within_the_deadman() {
    // A hidden or frozen page, or a cut cable: all look the same to the server.
    for messages in [0, 1, 7] {
        let mut server = Server::holding(messages);
        assert_eq!(server.pass(151), Some(Lost::Silent));
        server.assert_at_rest();
        // Shown until the next hold.
        assert!(server.viewer_lease.status().expired);
        server.begin(COMMANDER);
        assert!(!server.viewer_lease.status().expired);
        server.ask(COMMANDER, Request::End {});
        assert!(!server.viewer_lease.status().expired);
    }
}

#[test]
fn a_message_that_comes_too_late_does_not_save_the_hold() {
    let mut server = Server::holding(3);
    // The server itself was delayed, and has not checked meanwhile.
    server.now += Duration::from_millis(151);
    let step = server.ask(COMMANDER, Request::Hold { seq: 4 });
    assert_eq!(step.ended, Some(Lost::Silent));
    assert_eq!(step.refusal, Some(Refusal::NoHold));
    server.assert_at_rest();
}

#[test]
fn other_messages_of_the_page_do_not_keep_a_hold() {
    let mut server = Server::holding(3);
    let mut lost = None;
    for server_ms in 0..20 {
        lost = lost.or(server.pass(10));
        let step = server.ask(COMMANDER, Request::Seen { server_ms });
        let alive = server.ask(COMMANDER, Request::Alive {});
        lost = lost.or(step.ended).or(alive.ended);
    }
    assert_eq!(lost, Some(Lost::Silent));
}

#[test]
fn a_hold_ends_by_a_gap_an_older_and_a_repeated_message() {
    for got in [0, 2, 3, 5, u32::MAX] {
        let mut server = Server::holding(3);
        let step = server.ask(COMMANDER, Request::Hold { seq: got });
        let lost = Lost::Sequence { expected: 4, got };
        assert_eq!(step.ended, Some(lost));
        server.assert_at_rest();
    }
}

#[test]
fn a_hold_ends_when_it_is_let_go_released_replaced_or_stopped() {
    let name = "a person".to_owned();
    for (viewer, request, lost) in [
        (COMMANDER, Request::End {}, Lost::LetGo),
        (COMMANDER, Request::Release {}, Lost::Released),
        (COMMANDER, begin(0.05), Lost::Replaced),
        (COMMANDER, Request::Stop {}, Lost::Stopped),
        (OTHER, Request::Stop {}, Lost::Stopped),
    ] {
        let mut server = Server::holding(3);
        assert_eq!(server.ask(viewer, request).ended, Some(lost));
        server.assert_at_rest();
    }
    // Taking a lease again does not end the hold.
    let mut server = Server::holding(3);
    assert_eq!(
        server.ask(COMMANDER, Request::Take { name }),
        Step::default()
    );
    assert!(server.viewer_lease.status().holding);
}

#[test]
fn a_hold_ends_with_the_socket_of_its_commander_only() {
    let mut server = Server::holding(3);
    assert_eq!(server.viewer_lease.gone(OTHER), None);
    assert!(server.viewer_lease.status().holding);
    assert_eq!(
        server.viewer_lease.gone(COMMANDER),
        Some(Lost::Disconnected)
    );
    assert_eq!(server.viewer_lease.status(), Status::default());
    server.assert_at_rest();
}

#[test]
fn a_motion_that_has_ended_ends_its_own_hold_only() {
    let mut server = Server::holding(3);
    server.viewer_lease.ended(0);
    assert!(server.viewer_lease.status().holding);
    server.viewer_lease.ended(1);
    server.assert_at_rest();
    assert_eq!(server.ask(COMMANDER, Request::End {}), Step::default());
}

#[test]
fn a_clock_that_goes_back_ends_nothing_and_prolongs_nothing() {
    let mut server = Server::holding(3);
    assert_eq!(server.viewer_lease.tick(Duration::ZERO), None);
    assert_eq!(server.pass(151), Some(Lost::Silent));
}

#[test]
fn patience_moves_the_deadman_by_as_much() {
    let mut server = Server::with(Permissions {
        motion: true,
        patience: Duration::from_secs(1),
        ..Permissions::default()
    });
    server.take(COMMANDER);
    assert!(server.begin(COMMANDER).effect.is_some());
    assert_eq!(server.pass(1150), None);
    assert_eq!(server.pass(1), Some(Lost::Silent));
}

#[test]
fn the_speed_of_a_hold_changes_and_nothing_else_does() {
    let speed = || Request::Speed { speed: 0.2 };
    let mut server = Server::holding(3);
    assert_eq!(server.ask(COMMANDER, speed()), effect(Effect::Speed(0.2)));
    assert_eq!(server.pass(151), Some(Lost::Silent));
    assert_eq!(
        server.ask(COMMANDER, speed()).refusal,
        Some(Refusal::NoHold)
    );
    server.assert_at_rest();
}
