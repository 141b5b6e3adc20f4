//! A hold that is lost in every way; refusals; a second viewer; any requests at all.

use rand::rngs::SmallRng;
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};

use super::*;
use crate::request::Axes;

const COMMANDER: ViewerId = 1;
const OTHER: ViewerId = 2;
const UP: Motion = Motion::Translate {
    direction: [0.0, 0.0, 1.0],
    axes: Axes::Base,
};

/// An authority, and the time that it is told.
struct Server {
    authority: Authority,
    now: Duration,
}

impl Server {
    fn new() -> Self {
        Self::with(Permissions {
            motion: true,
            disturbances: true,
            gripper: true,
            recording: true,
            patience: Duration::ZERO,
        })
    }

    fn with(permissions: Permissions) -> Self {
        Self {
            authority: Authority::new(permissions),
            now: Duration::ZERO,
        }
    }

    fn ask(&mut self, viewer: ViewerId, request: Request) -> Step {
        let round_trip = Some(Duration::from_millis(5));
        self.authority.handle(self.now, viewer, round_trip, request)
    }

    /// Time passes, in the steps in which the server looks. Returns what was lost meanwhile.
    fn pass(&mut self, milliseconds: u64) -> Option<Lost> {
        let mut lost = None;
        for _ in 0..milliseconds {
            self.now += Duration::from_millis(1);
            lost = lost.or(self.authority.tick(self.now));
        }
        lost
    }

    fn take(&mut self, viewer: ViewerId) -> Step {
        let name = "a person".to_owned();
        self.ask(viewer, Request::Take { name })
    }

    fn begin(&mut self, viewer: ViewerId) -> Step {
        self.ask(viewer, begin(0.05))
    }

    /// A server whose commander holds, and has sent `messages` in time.
    fn holding(messages: u32) -> Self {
        let mut server = Self::new();
        assert_eq!(server.take(COMMANDER), Step::default());
        let begun = server.begin(COMMANDER).effect;
        assert!(matches!(begun, Some(Effect::Begin { hold: 1, .. })));
        for seq in 1..=messages {
            assert_eq!(server.pass(50), None);
            let kept = server.ask(COMMANDER, Request::Hold { seq });
            assert_eq!(kept, effect(Effect::KeepAlive));
        }
        server
    }

    /// Asserts that nothing moves, and nothing but another `Begin` changes that.
    fn assert_at_rest(&mut self) {
        assert!(!self.authority.status().holding);
        for seq in 0..20 {
            let step = self.ask(COMMANDER, Request::Hold { seq });
            assert!(step.effect.is_none() && step.refusal.is_some(), "{step:?}");
        }
    }
}

fn begin(speed: f64) -> Request {
    Request::Begin { motion: UP, speed }
}

#[test]
fn a_hold_goes_on_while_messages_come_in_time() {
    let mut server = Server::holding(200);
    assert!(server.authority.status().holding);
    assert_eq!(server.pass(150), None);
    let kept = server.ask(COMMANDER, Request::Hold { seq: 201 });
    assert_eq!(kept, effect(Effect::KeepAlive));
}

#[test]
fn a_hold_ends_by_silence_within_the_deadman() {
    // A hidden or frozen page, a cable that is cut: what all of them look like from here.
    for messages in [0, 1, 7] {
        let mut server = Server::holding(messages);
        assert_eq!(server.pass(151), Some(Lost::Silent));
        server.assert_at_rest();
        // Shown until the next one.
        assert!(server.authority.status().expired);
        server.begin(COMMANDER);
        assert!(!server.authority.status().expired);
        server.ask(COMMANDER, Request::End {});
        assert!(!server.authority.status().expired);
    }
}

#[test]
fn a_message_that_comes_too_late_does_not_save_the_hold() {
    let mut server = Server::holding(3);
    // The server itself was held up, and has not looked meanwhile.
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
    // What does not end it: taking a lease that one has.
    let mut server = Server::holding(3);
    assert_eq!(
        server.ask(COMMANDER, Request::Take { name }),
        Step::default()
    );
    assert!(server.authority.status().holding);
}

#[test]
fn a_hold_ends_with_the_socket_of_its_commander_only() {
    let mut server = Server::holding(3);
    assert_eq!(server.authority.gone(OTHER), None);
    assert!(server.authority.status().holding);
    assert_eq!(server.authority.gone(COMMANDER), Some(Lost::Disconnected));
    assert_eq!(server.authority.status(), Status::default());
    server.assert_at_rest();
}

#[test]
fn a_motion_that_has_ended_ends_its_own_hold_only() {
    let mut server = Server::holding(3);
    server.authority.ended(0);
    assert!(server.authority.status().holding);
    server.authority.ended(1);
    server.assert_at_rest();
    assert_eq!(server.ask(COMMANDER, Request::End {}), Step::default());
}

#[test]
fn a_clock_that_goes_back_ends_nothing_and_prolongs_nothing() {
    let mut server = Server::holding(3);
    assert_eq!(server.authority.tick(Duration::ZERO), None);
    assert_eq!(server.pass(151), Some(Lost::Silent));
}

#[test]
fn a_second_viewer_commands_only_after_release_expiry_or_departure() {
    let mut server = Server::holding(3);
    let taken = Refusal::Taken("a person".to_owned());
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
    assert!(server.authority.status().holding);

    server.ask(COMMANDER, Request::Release {});
    assert_eq!(server.take(OTHER).refusal, None);
    assert_eq!(server.take(COMMANDER).refusal, Some(taken));
    server.pass(4000);
    server.ask(OTHER, Request::Alive {});
    server.pass(5000);
    assert_eq!(server.authority.status().commander, Some(OTHER));
    server.pass(1);
    assert_eq!(server.authority.status().commander, None);
    assert_eq!(server.take(COMMANDER).refusal, None);
    server.authority.gone(COMMANDER);
    assert_eq!(server.take(OTHER).refusal, None);
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
        Motion::Joint { joint: 7, up: true },
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
            .authority
            .handle(now, COMMANDER, round_trip, begin(0.1));
        (step.effect.is_some(), step.refusal)
    };
    let refused = (false, Some(Refusal::Latency(slow)));
    assert_eq!(begun(&mut server, Some(slow)), refused);
    assert_eq!(begun(&mut server, None), (false, Some(Refusal::Unmeasured)));
    assert_eq!(begun(&mut server, Some(ROUND_TRIP_MAX)), (true, None));
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
fn a_view_only_server_takes_stops_and_nothing_else() {
    let mut server = Server::with(Permissions::default());
    assert_eq!(server.take(COMMANDER).refusal, Some(Refusal::ViewOnly));
    assert_eq!(server.begin(COMMANDER).refusal, Some(Refusal::NoLease));
    let stopped = server.ask(OTHER, Request::Stop {});
    assert_eq!(stopped, effect(Effect::Stop));
    // A simulated robot that another program moves: it can be disturbed, but not moved.
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
        // A page that is only watched may record.
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

/// Whatever viewers send, and whenever: the arm moves only for the holder of the lease, and never
/// for longer than the deadman after the last message that counted.
#[test]
fn nothing_moves_without_the_messages_of_its_commander() {
    let seed: u64 = rand::rng().random();
    println!("seed {seed}");
    let mut random = SmallRng::seed_from_u64(seed);
    let mut server = Server::new();
    let (mut moving, mut fed, mut begun) = (None, Duration::ZERO, 0);
    for _ in 0..100_000 {
        let viewer = random.random_range(1..4);
        let requests = [
            Request::Take { name: "x".into() },
            begin(0.1),
            begin(f64::NAN),
            Request::Hold {
                seq: random.random_range(0..3),
            },
            Request::End {},
            Request::Release {},
            Request::Stop {},
            Request::Alive {},
            Request::Recover {},
        ];
        let request = requests.choose(&mut random).expect("some").clone();
        let commander = server.authority.status().commander;
        let step = server.ask(viewer, request.clone());
        if step.ended.is_some() || step.effect == Some(Effect::Stop) {
            moving = None;
        }
        match step.effect {
            Some(Effect::Begin { .. }) => {
                assert_eq!(commander, Some(viewer));
                assert_eq!(moving, None, "a second motion");
                (moving, fed, begun) = (Some(viewer), server.now, begun + 1);
            }
            Some(Effect::KeepAlive) => {
                assert_eq!(moving, Some(viewer));
                fed = server.now;
            }
            _ => {}
        }
        let wait = random.random_range(0..60);
        for _ in 0..wait {
            if server.pass(1).is_some() {
                moving = None;
            }
            assert!(moving.is_none() || server.now - fed <= DEADMAN);
        }
        if random.random_bool(0.02) && server.authority.gone(viewer).is_some() {
            assert_eq!(moving.take(), Some(viewer));
        }
        assert_eq!(server.authority.status().holding, moving.is_some());
    }
    assert!(begun > 1000, "{begun} holds are too few to say anything");
}
