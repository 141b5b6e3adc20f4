//! One supervised robot, its mishaps, and the rules that it must keep.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

use franka_lockstep::{Asked, Lockstep, Outcome, Supervised};
use franka_model::{READY, RobotKind};
use franka_proto::{Errors, RobotError, RobotMode};
use franka_rt::lifecycle::{MotionError, Unready};
use franka_rt::session::{GoalId, Target};
use franka_rt::supervision::{Backoff, Condition, EventKind, Policy};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::chronicle::Chronicle;
use super::settings::{end_effector, load};

/// A policy, in numbers that a test can check.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    kind: RobotKind,
    /// Permitted number of recoveries, and their period in milliseconds.
    recover: Option<(u32, u64)>,
    only: Option<RobotError>,
    asks: bool,
    /// `[ms]`
    waits: Option<u64>,
}

impl Rules {
    /// One policy for each robot.
    pub(super) fn all() -> [Self; 5] {
        let never = Self {
            kind: RobotKind::Fr3,
            recover: None,
            only: None,
            asks: false,
            waits: None,
        };
        let always = Self {
            recover: Some((1000, 1000)),
            ..never
        };
        [
            never,
            Self {
                recover: Some((3, 5000)),
                waits: Some(2000),
                ..never
            },
            Self {
                kind: RobotKind::Fer,
                only: Some(RobotError::CartesianReflex),
                ..always
            },
            Self {
                asks: true,
                waits: Some(4000),
                ..always
            },
            Self {
                kind: RobotKind::Fer,
                waits: Some(1000),
                ..always
            },
        ]
    }

    fn policy(&self, seed: u64) -> Policy {
        let mut policy = Policy::default()
            .reconnect(BACKOFF)
            .silence(Duration::from_millis(1500))
            .seed(seed);
        if let Some((times, window)) = self.recover {
            policy = policy.recover(times, Duration::from_millis(window));
        }
        if let Some(only) = self.only {
            policy = policy.only([only]);
        }
        if self.asks {
            policy = policy.ask_first();
        }
        if let Some(waits) = self.waits {
            policy = policy.motions_wait(Duration::from_millis(waits));
        }
        policy
    }
}

const BACKOFF: Backoff = Backoff {
    first: Duration::from_millis(40),
    most: Duration::from_millis(640),
    jitter: 0.5,
};

/// End of a mishap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    Restart,
    Release,
    LetGo,
    Open,
    /// End of a cut network; true if both ends have given up by then.
    Mend(bool),
}

/// One robot.
pub(super) struct Trial {
    robot: Supervised,
    rules: Rules,
    random: SmallRng,
    /// Ends that are due, and their times.
    ends: BTreeMap<End, u64>,
    submitted: BTreeMap<GoalId, u64>,
    /// Time at which the robot last left its motions for something that its client can see.
    ended: u64,
    mode: RobotMode,
    /// Since when no motion has been shown.
    still: u64,
    /// Times of the requests to recover.
    recoveries: VecDeque<u64>,
    /// Future answers of a person: time, reflex, and true for yes.
    answers: Vec<(u64, u64, bool)>,
    agreed: BTreeSet<u64>,
    /// Reflexes of a robot that was not recognised.
    unrecognised: BTreeSet<u64>,
    /// True if it was started again since it was last connected to.
    is_restarted: bool,
    /// Time of the last request to connect, since the connection was lost.
    attempt: Option<u64>,
    /// Motions that have waited and begun.
    waited: u64,
    chronicle: Chronicle,
}

impl Trial {
    pub(super) fn new(rules: Rules, seed: u64) -> Self {
        let config = Lockstep::config_of(rules.kind);
        let mut this = Self {
            robot: Supervised::new(config, rules.policy(seed)),
            rules,
            random: SmallRng::seed_from_u64(seed),
            ends: BTreeMap::new(),
            submitted: BTreeMap::new(),
            ended: 0,
            mode: RobotMode::Idle,
            still: 0,
            recoveries: VecDeque::new(),
            answers: Vec::new(),
            agreed: BTreeSet::new(),
            unrecognised: BTreeSet::new(),
            is_restarted: false,
            attempt: None,
            waited: 0,
            chronicle: Chronicle::default(),
        };
        this.judge();
        this
    }

    /// Causes a mishap, or requests a motion. Returns true for a mishap.
    pub(super) fn act(&mut self) -> bool {
        let now = self.robot.now();
        let long = self.random.random_range(1..1500);
        let is_up = !self.ends.contains_key(&End::Restart);
        match self.random.random_range(0..20) {
            0..=5 => {
                self.submit();
                return false;
            }
            6 => {
                let newest = self.submitted.keys().next_back().copied();
                newest.into_iter().for_each(|goal| self.robot.cancel(goal));
                return false;
            }
            7 | 8 if is_up => {
                if self.robot.is_seen() {
                    self.ended = now;
                }
                self.ends.clear();
                self.robot.kill();
                self.ends.insert(End::Restart, now + long);
            }
            9 | 10 if is_up => {
                self.robot.robot().press_user_stop(true);
                self.ends.insert(End::Release, now + long);
            }
            11 if is_up => {
                self.robot.robot().guide(true);
                self.ends.insert(End::LetGo, now + long);
            }
            12 if is_up => {
                self.robot.robot().close_brakes();
                self.ends.insert(End::Open, now + long);
            }
            13 if is_up => {
                let gave_up = self.random.random_bool(0.3);
                let long = match self.random.random_range(0..3) {
                    0 => self.random.random_range(1..30),
                    1 => self.random.random_range(30..1000),
                    _ => self.random.random_range(1000..4000),
                };
                self.robot.cut();
                self.ends.retain(|end, _| !matches!(end, End::Mend(_)));
                self.ends.insert(End::Mend(gave_up), now + long);
            }
            14 => {
                // A person, or the program itself, regardless of the policy.
                if self.robot.state().robot_mode == RobotMode::Reflex {
                    self.robot.recover();
                }
                return false;
            }
            18 | 19 => {
                // Light: nothing is attached, and the compensation of the declared load pulls the
                // arm up.
                let random = self.random.random_range(0.0..0.002);
                self.robot.set(match self.random.random_range(0..2) {
                    0 => load(random),
                    _ => end_effector(random),
                });
                return false;
            }
            _ if is_up => {
                let errors = [
                    RobotError::CartesianReflex,
                    RobotError::JointReflex,
                    RobotError::PowerLimitViolation,
                ];
                self.robot
                    .trip(errors[self.random.random_range(0..errors.len())]);
            }
            _ => return false,
        }
        true
    }

    fn submit(&mut self) {
        let q = core::array::from_fn(|i| READY[i] + self.random.random_range(-0.05..0.05));
        let goal = self.robot.submit(Target::Joints(q));
        self.submitted.insert(goal, self.robot.now());
    }

    pub(super) fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }

    fn tick(&mut self) {
        let now = self.robot.now();
        while let Some((&end, _)) = self.ends.iter().find(|(_, at)| **at <= now) {
            self.ends.remove(&end);
            match end {
                End::Restart => {
                    self.robot.restart();
                    self.is_restarted = true;
                }
                End::Release => self.robot.robot().press_user_stop(false),
                End::LetGo => drop(self.robot.robot().guide(false)),
                End::Open => self.robot.robot().open_brakes(),
                End::Mend(gave_up) => self.robot.mend(gave_up),
            }
        }
        let due = |answer: &mut (u64, u64, bool)| answer.0 <= now;
        for (_, reflex, agrees) in self.answers.extract_if(.., due).collect::<Vec<_>>() {
            // Recorded first, because the request may follow immediately.
            if agrees {
                self.agreed.insert(reflex);
            }
            self.robot.agree(reflex, agrees);
        }
        self.robot.tick();
        self.judge();
    }

    /// Checks the requests and events of the supervision, and the robot's activity.
    fn judge(&mut self) {
        self.judge_motion();
        for asked in std::mem::take(&mut self.robot.requests) {
            match asked {
                Asked::Connect => self.judge_attempt(),
                Asked::Recover(reflex, mode, errors) => {
                    assert_eq!(mode, RobotMode::Reflex);
                    self.judge_recovery(reflex, errors);
                }
                Asked::Agreement(reflex) => {
                    assert!(self.rules.asks || reflex.differences.is_some());
                    if reflex.differences.is_some() {
                        self.unrecognised.insert(reflex.number);
                    }
                    let at = self.robot.now() + self.random.random_range(0..1500);
                    match self.random.random_range(0..10) {
                        0 => {}
                        1 => self.answers.push((at, reflex.number, false)),
                        _ => self.answers.push((at, reflex.number, true)),
                    }
                }
                Asked::Begin(goal) => {
                    let (begun, ended) = (self.submitted[&goal], self.ended);
                    self.waited += 1;
                    assert!(
                        begun >= ended,
                        "{goal:?} was asked for at {begun}, before {ended}"
                    );
                }
            }
        }
        for event in std::mem::take(&mut self.robot.events) {
            self.chronicle.take(&event);
            match event.kind {
                EventKind::Unrecognised { differences } => {
                    // Possibly no state has shown a setting from just before the loss.
                    let has_set = !self.robot.answers.is_empty();
                    let by_us = has_set && differences.frames && !differences.clock;
                    assert!(self.is_restarted || by_us, "{differences}");
                }
                EventKind::Lost { .. } => self.is_restarted = false,
                _ => {}
            }
        }
        if self.robot.health().condition != Condition::Unready(Unready::Disconnected) {
            self.attempt = None;
        }
    }

    fn judge_motion(&mut self) {
        let now = self.robot.now();
        if !self.robot.is_up() {
            (self.mode, self.still) = (RobotMode::Other, now);
            return;
        }
        let is_seen = self.robot.is_seen();
        let before = self.mode;
        let robot = self.robot.robot();
        let (mode, speed) = (robot.state().robot_mode, robot.dq().amax());
        self.mode = mode;
        let is_ended = matches!(
            mode,
            RobotMode::Reflex | RobotMode::UserStopped | RobotMode::Other | RobotMode::Guiding
        );
        if mode != before && is_ended && is_seen {
            self.ended = now - 1;
        }
        if mode == RobotMode::Move {
            let wanted = |(&goal, &at): (&GoalId, &u64)| {
                self.robot.is_under_way(goal) && (at >= self.ended || !is_seen)
            };
            assert!(
                self.submitted.iter().any(wanted),
                "at {now} the arm moves and nobody asked for it since {}",
                self.ended
            );
            self.still = now;
        } else if now > self.still + 1500 {
            assert!(speed < 5e-3, "at {now} the arm moves at {speed} rad/s");
        }
    }

    fn judge_recovery(&mut self, reflex: u64, errors: Errors) {
        let now = self.robot.now();
        let (times, window) = self.rules.recover.expect("it recovers from some");
        self.recoveries.retain(|at| at + window > now);
        assert!(
            self.recoveries.len() < times as usize,
            "{:?}",
            self.recoveries
        );
        self.recoveries.push_back(now);
        if let Some(only) = self.rules.only {
            assert_eq!(errors, Errors::from(only));
        }
        assert!(
            !self.rules.asks && !self.unrecognised.contains(&reflex)
                || self.agreed.contains(&reflex),
            "{reflex}"
        );
    }

    /// After a failed attempt, the next one comes only after the pause.
    fn judge_attempt(&mut self) {
        let now = self.robot.now();
        if let Some(before) = self.attempt.replace(now) {
            let pause = BACKOFF.first.mul_f64(1.0 - BACKOFF.jitter);
            assert!(
                Duration::from_millis(now - before) >= pause,
                "{before}, {now}"
            );
        }
    }

    /// Ends all mishaps, checks that the robot moves again, and returns its events.
    pub(super) fn finish(mut self) -> String {
        let now = self.robot.now();
        for at in self.ends.values_mut() {
            *at = now;
        }
        let deadline = now + 30_000;
        while self.robot.health().condition != Condition::Ready || !self.is_resolved() {
            self.run(20);
            let health = self.robot.health();
            assert!(self.robot.now() < deadline, "{health:?}");
            if matches!(
                health.condition,
                Condition::Unready(
                    Unready::Reflex | Unready::AgreementAwaited | Unready::Unrecognised(_)
                )
            ) && self.robot.state().robot_mode == RobotMode::Reflex
            {
                // A person does the steps that the policy does not take.
                self.robot.recover();
                self.run(300);
            }
        }
        let last = self.robot.submit(Target::Joints(READY.into()));
        self.submitted.insert(last, self.robot.now());
        while !self.is_resolved() {
            self.run(20);
        }
        let outcomes = &self.robot.outcomes;
        assert!(outcomes[&last].is_ok(), "{:?}", outcomes[&last]);
        assert_eq!(outcomes.len(), self.submitted.len());
        let mut counts: BTreeMap<&str, u64> = BTreeMap::new();
        for outcome in outcomes.values() {
            *counts.entry(kind(outcome)).or_default() += 1;
        }
        assert!(self.chronicle.is_complete());
        let seconds = self.robot.now() / 1000;
        let (told, text, waited) = (&self.chronicle.counts, &self.chronicle.text, self.waited);
        format!("{text}{seconds} s: {counts:?}, {waited} of them waited; told {told:?}")
    }

    fn is_resolved(&self) -> bool {
        self.robot.outcomes.len() == self.submitted.len()
    }
}

fn kind(outcome: &Outcome) -> &'static str {
    match outcome {
        Ok(_) => "ok",
        Err(MotionError::Superseded) => "superseded",
        Err(MotionError::Stopped) => "stopped",
        Err(MotionError::Control(error)) if error.is_reflex() => "reflex",
        Err(MotionError::Control(_)) => "aborted",
        Err(MotionError::Rejected(_)) => "rejected",
        Err(MotionError::NotReady { waited, .. }) if waited.is_zero() => "refused",
        Err(MotionError::NotReady { .. }) => "turned away",
        Err(MotionError::ConnectionClosed { .. }) => "closed",
        Err(MotionError::LinkLost { .. }) => "link lost",
        Err(MotionError::Protocol { .. }) => "given up",
        Err(error) => panic!("nothing in here causes {error:?}"),
    }
}
