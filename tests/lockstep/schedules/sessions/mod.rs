//! Sessions that go from goal to goal, and disturbances of all kinds.
//!
//! This module draws the next action and advances time. `goals` and `streams` act on the session,
//! `mishaps` disturbs it from outside, and `ends` ends it.

mod ends;
mod goals;
mod mishaps;
mod streams;

use std::ops::Range;
use std::time::Duration;

use franka_lockstep::{Link, Lockstep};
use franka_model::RobotKind;
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::lifecycle::Engagement;
use franka_rt::session::{Backend, Deadman, GoalId, OnArrival};
use nalgebra::Isometry3;
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::OutcomeCounts;
use super::causes::Causes;
use super::submission::{Submission, Work};

/// Period in which a deadman is kept alive, `[ms]`.
const BEAT: u64 = 10;

/// The longest time until any work ends, `[ms]`: a path at the slowest pace takes twenty seconds.
const TIME_MAX: u64 = 30_000;

/// The longest time from a stop until it resolves, `[ms]`.
const STOP_MAX: u64 = 3000;

/// Joint motion when the robot's own controller takes over an arm that sticks, `[rad]`.
const SETTLING: f64 = 1e-2;

/// Time in which an arm brakes after a reflex, `[ms]`.
const REFLEX_MAX: u64 = 500;

/// One schedule.
pub(super) struct Sessions<'a> {
    lockstep: Lockstep,
    random: SmallRng,
    counts: &'a mut OutcomeCounts,
    home: Isometry3<f64>,
    /// True if there are no disturbances from outside.
    calm: bool,
    /// True if the disturbances alone may move the arm or end a motion.
    forceful: bool,
    causes: Causes,
    session: Option<Session>,
    /// Unresolved work, the oldest first.
    open: Vec<Submission>,
    submitted: usize,
    /// Chunks that continue others; a chunk that comes too late resolves like a goal.
    chunks: Vec<GoalId>,
}

/// The session that has the arm.
struct Session {
    id: GoalId,
    backend: Backend,
    deadman: Option<DeadmanFeed>,
    /// The newest goal.
    current: Option<GoalId>,
    /// True if goals are refused from now on.
    over: bool,
}

/// Source of a deadman's signs of life.
struct DeadmanFeed {
    token: Option<Deadman>,
    silence: u64,
    /// The time of the last sign of life.
    beat: u64,
    /// The time until which it gives no sign of life.
    silent: u64,
}

impl<'a> Sessions<'a> {
    /// Runs the schedule of this seed with a robot from `robot`.
    pub(super) fn play(
        seed: u64,
        robot: impl FnOnce(RobotKind) -> Lockstep,
        counts: &'a mut OutcomeCounts,
    ) {
        let mut this = Self::new(seed, robot, counts);
        this.engage();
        this.act_often(3..9);
        this.finish();
    }

    /// Runs the schedule of this seed, in which each session is stopped in the middle of its
    /// actions. Only datagrams are lost.
    pub(super) fn play_with_stops(
        seed: u64,
        robot: impl FnOnce(RobotKind) -> Lockstep,
        counts: &'a mut OutcomeCounts,
    ) {
        let mut this = Self::new(seed, robot, counts);
        this.forceful = false;
        for _ in 0..this.random.random_range(1..4) {
            this.engage();
            this.act_often(1..4);
            this.stop_and_rest();
        }
        this.finish();
    }

    fn new(
        seed: u64,
        robot: impl FnOnce(RobotKind) -> Lockstep,
        counts: &'a mut OutcomeCounts,
    ) -> Self {
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
        Self {
            home: lockstep.arm_pose(),
            lockstep,
            random,
            counts,
            calm,
            forceful: true,
            causes: Causes::default(),
            session: None,
            open: Vec::new(),
            submitted: 0,
            chunks: Vec::new(),
        }
    }

    fn act_often(&mut self, times: Range<u32>) {
        for _ in 0..self.random.random_range(times) {
            self.act();
            let pause = match self.random.random_range(0..4) {
                0 => self.random.random_range(0..4),
                1 => self.random.random_range(0..60),
                _ => self.random.random_range(0..350),
            };
            self.run(pause);
        }
    }

    fn engage(&mut self) {
        let kinds = Backend::ROBOT_CONTROLLERS;
        let kind = self.random.random_range(0..2 * kinds.len());
        let backend = kinds.get(kind).copied().unwrap_or_default();
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
            deadman: bound.then_some(DeadmanFeed {
                token: Some(token),
                silence,
                beat: now,
                silent: 0,
            }),
            current: None,
            over: false,
        });
        self.add(Submission::new(id, Work::Session, OnArrival::Hold, now));
        // The session holds the arm, or the robot has refused: after a push, a robot may trip
        // although it was idle.
        while self.lockstep.client.record.goal != id.0 && self.lockstep.client.outcome(id).is_none()
        {
            self.tick();
            let waited = self.lockstep.now() - now;
            assert!(waited < 1000, "{:?}", self.lockstep.client.lifecycle);
        }
    }

    fn add(&mut self, submission: Submission) {
        self.open.push(submission);
        self.submitted += 1;
    }

    fn act(&mut self) {
        self.begin_anew();
        let kinds = match (self.calm, self.forceful) {
            (true, _) => 20,
            (false, false) => 23,
            (false, true) => 27,
        };
        match self.random.random_range(0..kinds) {
            0..=3 => self.give(),
            4 => {
                // The first of them is superseded before it takes effect.
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
            18..=19 => self.go_through(),
            20..=22 => self.lose(),
            23..=24 => self.push(),
            25 => self.trip(),
            _ => self.press_user_stop(),
        }
    }

    /// Begins another session after the last, at random.
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
        let feed = self
            .session
            .as_ref()
            .and_then(|session| session.deadman.as_ref());
        // A gap in the states makes the silence seem longer.
        let silent =
            feed.is_some_and(|feed| now + 40 >= feed.beat + feed.silence && feed.beat + BEAT < now);
        for submission in &mut self.open {
            submission.observe(record);
            submission.deadman |= silent;
        }
        let Self {
            lockstep,
            causes,
            counts,
            ..
        } = self;
        self.open
            .retain(|submission| match lockstep.client.outcome(submission.id) {
                Some(outcome) => {
                    submission.judge(outcome, lockstep, causes);
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
            deadman: Some(feed),
            ..
        }) = &mut self.session
            && let Some(token) = &feed.token
            && now >= feed.silent
            && now >= feed.beat + BEAT
        {
            token.keep_alive();
            feed.beat = now;
        }
    }
}
