//! Sessions that go from goal to goal, and all that can happen to them.
//!
//! What is done next is drawn here, and here time passes. `goals` and `streams` do it to the
//! session, `mishaps` from outside, and `ends` sees to the end.

mod ends;
mod goals;
mod mishaps;
mod streams;

use std::time::Duration;

use franka_model::RobotKind;
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::lifecycle::Engagement;
use franka_rt::session::{Backend, Deadman, GoalId, OnArrival, Setpoints};
use franka_tests::lockstep::{Link, Lockstep};
use nalgebra::Isometry3;
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::OutcomeCounts;
use super::causes::Causes;
use super::given::{Given, Work};

/// How often a deadman is kept alive, `[ms]`.
const BEAT: u64 = 10;

/// The longest that anything that comes to its end may take, `[ms]`.
const PATIENCE: u64 = 20_000;

/// One schedule.
pub(super) struct Sessions<'a> {
    lockstep: Lockstep,
    random: SmallRng,
    counts: &'a mut OutcomeCounts,
    home: Isometry3<f64>,
    /// Nothing comes from outside.
    calm: bool,
    causes: Causes,
    session: Option<Session>,
    /// What has not been resolved yet, the oldest first.
    open: Vec<Given>,
    given: usize,
    /// Chunks that have gone on from others; one that comes too late resolves like a goal.
    chunks: Vec<GoalId>,
}

/// The session that has the arm.
struct Session {
    id: GoalId,
    backend: Backend,
    deadman: Option<Hand>,
    /// The newest goal.
    current: Option<GoalId>,
    /// Goals are refused from now on.
    over: bool,
}

/// The hand on a deadman.
struct Hand {
    token: Option<Deadman>,
    silence: u64,
    /// When it showed life last.
    beat: u64,
    /// Until when it does not.
    silent: u64,
}

impl<'a> Sessions<'a> {
    /// Plays the schedule of that seed with a robot from `robot`.
    pub(super) fn play(
        seed: u64,
        robot: impl FnOnce(RobotKind) -> Lockstep,
        counts: &'a mut OutcomeCounts,
    ) {
        let mut random = SmallRng::seed_from_u64(seed);
        let kind = RobotKind::ALL[random.random_range(0..RobotKind::ALL.len())];
        let mut lockstep = robot(kind);
        let calm = seed.is_multiple_of(4);
        if !calm && random.random_bool(0.7) {
            let tolerant =
                CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
            lockstep.request(&Request::SetCollisionBehavior(tolerant));
            lockstep.run(5);
        }
        if !calm && random.random_bool(0.3) {
            let [states, commands] = [0, 1].map(|_| random.random_range(0.0..0.02));
            lockstep.link = Link::lossy(seed, states, commands);
        }
        let mut this = Self {
            home: lockstep.true_pose(),
            lockstep,
            random,
            counts,
            calm,
            causes: Causes::default(),
            session: None,
            open: Vec::new(),
            given: 0,
            chunks: Vec::new(),
        };
        this.engage();
        for _ in 0..this.random.random_range(3..9) {
            this.act();
            let pause = match this.random.random_range(0..4) {
                0 => this.random.random_range(0..4),
                1 => this.random.random_range(0..60),
                _ => this.random.random_range(0..350),
            };
            this.run(pause);
        }
        this.finish();
    }

    fn engage(&mut self) {
        let backend = match self.random.random_range(0..6) {
            0 => Backend::RobotController(Setpoints::Joints),
            1 => Backend::RobotController(Setpoints::Poses),
            _ => Backend::Torques,
        };
        let bound = self.random.random_bool(0.5);
        let silence = self.random.random_range(30..80);
        let (token, monitor) = Deadman::new(Duration::from_millis(silence));
        let id = self.lockstep.begin_session(Engagement {
            deadman: bound.then_some(monitor),
            backend,
            ..Engagement::default()
        });
        let now = self.lockstep.now();
        self.session = Some(Session {
            id,
            backend,
            deadman: bound.then_some(Hand {
                token: Some(token),
                silence,
                beat: now,
                silent: 0,
            }),
            current: None,
            over: false,
        });
        self.add(Given::new(id, Work::Session, OnArrival::Hold, now));
        // It holds the arm, or the robot has refused: one that was pushed may trip after it has
        // shown itself idle.
        while self.lockstep.client.record.goal != id.0 && self.lockstep.client.outcome(id).is_none()
        {
            self.tick();
            let waited = self.lockstep.now() - now;
            assert!(waited < 1000, "{:?}", self.lockstep.client.lifecycle);
        }
    }

    fn add(&mut self, given: Given) {
        self.open.push(given);
        self.given += 1;
    }

    fn act(&mut self) {
        self.begin_anew();
        match self.random.random_range(0..if self.calm { 18 } else { 25 }) {
            0..=3 => self.give(),
            4 => {
                // The first of them is superseded before anybody has seen it.
                self.give();
                self.give();
            }
            5..=7 => self.stream(),
            8..=9 => self.chunk(),
            10 => self.tune(),
            11 => self.cancel(),
            12 => self.close(),
            13 => self.wait(),
            14..=15 => self.fall_silent(),
            16 => self.end(),
            17 => self.interfere(),
            18..=20 => self.lose(),
            21..=22 => self.push(),
            23 => self.trip(),
            _ => self.press_user_stop(),
        }
    }

    /// Begins another session after the last, perhaps.
    fn begin_anew(&mut self) {
        let ended = |session: &Session| self.lockstep.client.outcome(session.id).is_some();
        if !self.session.as_ref().is_some_and(ended) || self.random.random_bool(0.3) {
            return;
        }
        if self.lockstep.client.state.robot_mode == RobotMode::Reflex {
            self.lockstep.robot.let_go();
            self.recover();
        }
        if self.lockstep.client.lifecycle.is_idle()
            && self.lockstep.client.state.robot_mode == RobotMode::Idle
        {
            self.run(5);
            self.engage();
        }
    }

    fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }

    fn tick(&mut self) {
        self.keep_alive();
        self.lockstep.tick();
        let record = &self.lockstep.client.record;
        let now = self.lockstep.now();
        let hand = self
            .session
            .as_ref()
            .and_then(|session| session.deadman.as_ref());
        // A gap in the states makes it seem longer.
        let silent =
            hand.is_some_and(|hand| now + 40 >= hand.beat + hand.silence && hand.beat + BEAT < now);
        for given in &mut self.open {
            given.observe(record);
            given.deadman |= silent;
        }
        let Self {
            lockstep,
            causes,
            counts,
            ..
        } = self;
        self.open
            .retain(|given| match lockstep.client.outcome(given.id) {
                Some(outcome) => {
                    given.judge(outcome, lockstep, causes);
                    counts.count(outcome);
                    false
                }
                None => true,
            });
        if self.calm {
            let errors = &self.lockstep.client.state.errors;
            assert!(errors.is_empty(), "{now}: {errors}");
        }
    }

    fn keep_alive(&mut self) {
        let now = self.lockstep.now();
        if let Some(Session {
            deadman: Some(hand),
            ..
        }) = &mut self.session
            && let Some(token) = &hand.token
            && now >= hand.silent
            && now >= hand.beat + BEAT
        {
            token.keep_alive();
            hand.beat = now;
        }
    }
}
