//! A lease and its viewers, without a clock and sockets, with arbitrary requests.

mod holds;
mod refusals;

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

/// A lease, and its simulated time.
struct Server {
    viewer_lease: ViewerLease,
    /// Lease of the robot.
    lease: Lease,
    /// Moment at which the simulated time is zero.
    start: Instant,
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
        let (lease, start) = (Lease::default(), Instant::now());
        Self {
            viewer_lease: ViewerLease::new(permissions, lease.clone(), start),
            lease,
            start,
            now: Duration::ZERO,
        }
    }

    fn ask(&mut self, viewer: ViewerId, request: Request) -> Step {
        let round_trip = Some(Duration::from_millis(5));
        self.viewer_lease
            .handle(self.now, viewer, round_trip, request)
    }

    /// Advances the time, in the steps of the server's checks. Returns the reason if a hold was
    /// lost.
    fn pass(&mut self, milliseconds: u64) -> Option<Lost> {
        let mut lost = None;
        for _ in 0..milliseconds {
            self.now += Duration::from_millis(1);
            lost = lost.or(self.viewer_lease.tick(self.now));
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

    /// Returns a server whose commander holds, and has sent `messages` in time.
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

    /// Asserts that the arm does not move, and that only another `Begin` can move it.
    fn assert_at_rest(&mut self) {
        assert!(!self.viewer_lease.status().holding);
        for seq in 0..20 {
            let step = self.ask(COMMANDER, Request::Hold { seq });
            assert!(step.effect.is_none() && step.refusal.is_some(), "{step:?}");
        }
    }
}

fn begin(speed: f64) -> Request {
    Request::Begin { motion: UP, speed }
}

/// For any messages at any times, the arm moves only for the holder of the lease. It stops at the
/// latest when the deadman expires after the last valid message.
#[test]
fn arm_moves_only_on_messages_of_its_commander() {
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
        let commander = server.viewer_lease.status().commander;
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
        if random.random_bool(0.02) && server.viewer_lease.gone(viewer).is_some() {
            assert_eq!(moving.take(), Some(viewer));
        }
        assert_eq!(server.viewer_lease.status().holding, moving.is_some());
    }
    assert!(begun > 1000, "{begun} holds are too few to say anything");
}
