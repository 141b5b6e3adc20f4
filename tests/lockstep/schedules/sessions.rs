//! Sessions that go from goal to goal, and all that can happen to them.

use std::time::Duration;

use franka_model::{READY, RobotKind, Wrench};
use franka_proto::{CollisionBehavior, Request, RobotError, RobotMode};
use franka_rt::driver::Activity;
use franka_rt::lifecycle::{Engagement, MotionError, Tuning};
use franka_rt::session::{
    Backend, Budget, Deadman, Free, Goal, GoalId, Lapse, Setpoints, Stale, Target, Then, Watchdog,
};
use franka_tests::lockstep::{Link, Lockstep};
use nalgebra::{Isometry3, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::causes::Causes;
use super::given::{Given, Work};
use super::{Tally, draw};

/// How often a deadman is kept alive, `[ms]`.
const BEAT: u64 = 10;

/// The longest that anything that comes to its end may take, `[ms]`.
const PATIENCE: u64 = 20_000;

/// One schedule.
pub(super) struct Sessions<'a> {
    lockstep: Lockstep,
    random: SmallRng,
    tally: &'a mut Tally,
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
    pub(super) fn play(seed: u64, robot: impl FnOnce(RobotKind) -> Lockstep, tally: &'a mut Tally) {
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
            tally,
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
        // Poses for the robot's controller are left out: its own inverse kinematics may accelerate joints by more than
        // the reference does, and beyond the robot's limits.
        let backend = match self.random.random_range(0..4) {
            0 => Backend::RobotController(Setpoints::Joints),
            _ => Backend::Torques,
        };
        let bound = self.random.random_bool(0.5);
        let silence = self.random.random_range(30..80);
        let (token, grip) = Deadman::new(Duration::from_millis(silence));
        let id = self.lockstep.engage_with(Engagement {
            deadman: bound.then_some(grip),
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
        self.add(Given::new(id, Work::Session, Then::Hold, now));
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
            23 => {
                let error = RobotError::CartesianReflex;
                self.causes.trip(error);
                self.lockstep.robot.trip(error);
            }
            _ => {
                self.causes.stopped = true;
                self.lockstep.robot.press_user_stop(true);
                let pause = self.random.random_range(1..300);
                self.run(pause);
                self.lockstep.robot.press_user_stop(false);
            }
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

    /// Gives the session a goal of any kind.
    fn give(&mut self) {
        let backend = self.session.as_ref().map(|session| session.backend);
        let kinds = match backend {
            Some(Backend::RobotController(_)) => 8,
            _ => 10,
        };
        let target = match self.random.random_range(0..kinds) {
            0..=3 => draw::pose(&mut self.random, &self.home, 0.1, 0.3),
            4 => Target::Rest,
            5..=7 => Target::Joints(draw::joints(&mut self.random, 0.3)),
            _ => Target::Guide(Free {
                axes: core::array::from_fn(|_| self.random.random_bool(0.5)),
                elbow: self.random.random_bool(0.5),
            }),
        };
        let then = match self.random.random_range(0..20) {
            0 if !matches!(target, Target::Guide(_)) => Then::Finish,
            1..=9 if !matches!(target, Target::Guide(_)) => Then::Stay,
            _ => Then::Hold,
        };
        self.submit(target, then);
    }

    /// Submits a goal that goes about it in any way. Returns whether it was taken.
    fn submit(&mut self, target: Target, then: Then) -> bool {
        let mut goal = self.lockstep.goal(target, then);
        goal.budget = self.budget();
        let mut soft = false;
        if !matches!(target, Target::Guide(_)) && self.random.random_bool(0.3) {
            goal.gains = draw::gains(&mut self.random);
            soft = true;
        }
        if self.random.random_bool(0.2) {
            goal.force_cap = Some(self.random.random_range(10.0..100.0));
            soft = true;
        }
        // Nothing streams to a hand.
        let streams = then == Then::Hold && !matches!(target, Target::Guide(_));
        if streams && self.random.random_bool(0.5) {
            goal.watchdog = Some(self.watchdog());
        }
        let Some(session) = &self.session else {
            return false;
        };
        let taken = self.lockstep.submit_within(session.id, goal);
        self.note(goal, Work::Goal(target), soft, taken)
    }

    /// Takes note of a goal that was submitted.
    fn note(
        &mut self,
        goal: Goal,
        work: Work,
        soft: bool,
        taken: Result<GoalId, MotionError>,
    ) -> bool {
        let now = self.lockstep.now();
        let causes = self.causes.any();
        let Some(session) = &mut self.session else {
            return false;
        };
        match taken {
            Ok(id) => {
                assert!(!session.over, "no goal is taken after the last");
                session.over = goal.then == Then::Finish;
                let before = session.current.replace(id);
                let current = session.id;
                for given in &mut self.open {
                    if Some(given.id) == before {
                        given.superseded = true;
                        let told = self.lockstep.client.outcome(given.id).is_some();
                        // Of a session that is ending, everybody hears its end.
                        assert!(told || causes, "{given:?} is superseded");
                    }
                    given.finishing |= given.id == current && goal.then == Then::Finish;
                }
                let mut given = Given::new(id, work, goal.then, now);
                given.watchdog = goal.watchdog;
                given.soft = soft;
                self.add(given);
                true
            }
            // From where the arm is, the search may not find a way to a pose.
            Err(MotionError::Goal(_)) => false,
            Err(error) => {
                let ended = self.lockstep.client.outcome(session.id);
                let fits = match ended {
                    Some(Err(ended)) => error == *ended,
                    Some(Ok(_)) => error == MotionError::Disengaged,
                    None => session.over && error == MotionError::Disengaged,
                };
                assert!(fits, "{error:?} of a session that ended as {ended:?}");
                session.over = true;
                false
            }
        }
    }

    fn budget(&mut self) -> Budget {
        let goal = self.lockstep.goal(Target::Rest, Then::Hold);
        let speeds = [0.3, 0.6, 1.0, 1.0, 1.4, 1.7];
        goal.budget
            .scaled(speeds[self.random.random_range(0..speeds.len())])
    }

    /// Moves the target of a goal that is held, at a random rate, and then perhaps never again.
    fn stream(&mut self) {
        if self.held().is_none() {
            let target = draw::pose(&mut self.random, &self.lockstep.true_pose(), 0.02, 0.05);
            self.submit(target, Then::Hold);
        }
        let Some(id) = self.held() else {
            return;
        };
        let most = self.random.random_range(2..60);
        for _ in 0..self.random.random_range(2..30) {
            let target = if self.random.random_bool(0.8) {
                let here = self.lockstep.reference_pose();
                draw::pose(&mut self.random, &here, 0.03, 0.1)
            } else {
                Target::Joints(draw::joints(&mut self.random, 0.15))
            };
            let now = self.lockstep.now();
            let updated = self.lockstep.update(id, target);
            let given = self.open.iter_mut().find(|given| given.id == id);
            match (updated, given) {
                (Ok(true), Some(given)) => {
                    given.work = Work::Goal(target);
                    given.heard = now;
                }
                (Ok(false), given) => {
                    let told = self.lockstep.client.outcome(id).is_some();
                    let lost = |given: &mut Given| told || given.cancelled || self.causes.any();
                    assert!(given.is_none_or(lost), "it is followed");
                    return;
                }
                (Ok(true), None) => panic!("nobody is told twice"),
                (Err(_), _) => {}
            }
            let pause = self.random.random_range(1..most);
            self.run(pause);
        }
    }

    /// The newest goal, if it is held and still open.
    fn held(&self) -> Option<GoalId> {
        let current = self.session.as_ref()?.current?;
        let given = self.open.iter().find(|given| given.id == current)?;
        let guided = matches!(given.work, Work::Goal(Target::Guide(_)) | Work::Chunks);
        (given.then == Then::Hold && !given.cancelled && !guided).then_some(current)
    }

    /// Some chunks one after the other, as of a policy: most come before the one before them has ended.
    fn chunk(&mut self) {
        for _ in 0..self.random.random_range(1..6) {
            let Some(session) = &self.session else {
                return;
            };
            let id = session.id;
            let (q, pose) = (
                self.lockstep.client.record.q_ref,
                self.lockstep.reference_pose(),
            );
            let now = self.lockstep.client.state.message_id;
            let chunk = draw::chunk(&mut self.random, &q, &pose, now);
            let mut goal = self.lockstep.goal(chunk.target(), Then::Hold);
            goal.budget = self.budget();
            if self.random.random_bool(0.3) {
                goal.watchdog = Some(self.watchdog());
            }
            let before = self.session.as_ref().and_then(|session| session.current);
            let taken = self.lockstep.submit_chunk(id, goal, chunk);
            let heard = self.lockstep.now();
            let goes_on = self.open.iter_mut().find(|given| {
                Some(given.id) == before && given.work == Work::Chunks && !given.cancelled
            });
            match (goes_on, &taken) {
                (Some(given), Ok(_)) => {
                    given.heard = heard;
                    self.chunks.push(goal.id);
                }
                _ => {
                    self.note(goal, Work::Chunks, false, taken);
                }
            }
            let pause = self.random.random_range(1..150);
            self.run(pause);
        }
    }

    fn watchdog(&mut self) -> Watchdog {
        Watchdog {
            silence: Duration::from_millis(self.random.random_range(20..200)),
            stale: [Stale::Hold, Stale::Brake][self.random.random_range(0..2)],
        }
    }

    fn tune(&mut self) {
        let Some(session) = &self.session else {
            return;
        };
        let id = session.id;
        let tuning = Tuning {
            gains: self
                .random
                .random_bool(0.7)
                .then(|| draw::gains(&mut self.random)),
            budget: None,
            ..Tuning::default()
        };
        let budget = self.random.random_bool(0.5).then(|| self.budget());
        let tuned = self.lockstep.tune(id, Tuning { budget, ..tuning });
        match tuned {
            Ok(()) => {
                for given in &mut self.open {
                    given.soft = true;
                }
            }
            Err(MotionError::Goal(_)) => {}
            Err(error) => {
                let over = self.session.as_ref().is_some_and(|session| session.over);
                let ended = self.lockstep.client.outcome(id).is_some();
                assert!(over || ended, "{error:?}");
            }
        }
    }

    fn cancel(&mut self) {
        let sessions = |given: &&mut Given| matches!(given.work, Work::Goal(_) | Work::Chunks);
        if let Some(given) = self.open.iter_mut().rev().find(sessions) {
            given.cancelled = true;
            let (id, finishes) = (given.id, given.then == Then::Finish);
            self.lockstep.cancel(id);
            // A session that a goal was to end goes on without it.
            if let Some(session) = self.session.as_mut().filter(|_| finishes) {
                session.over = false;
                let named = |given: &&mut Given| given.id == session.id;
                for given in self.open.iter_mut().filter(named) {
                    given.finishing = false;
                }
            }
        }
    }

    fn close(&mut self) {
        if let Some(id) = self.held() {
            self.lockstep.client.lifecycle.close(id);
            let given = self.open.iter_mut().find(|given| given.id == id);
            given.expect("it is open").then = Then::Stay;
        }
    }

    /// Until the newest goal has come to its end, if it has one.
    fn wait(&mut self) {
        let Some(current) = self.session.as_ref().and_then(|session| session.current) else {
            return;
        };
        let begin = self.lockstep.now();
        let ends = |given: &Given| {
            let watched = given.watchdog.is_some() && given.then == Then::Hold;
            given.id == current && (given.then != Then::Hold || given.cancelled || watched)
        };
        while self.open.iter().any(ends) {
            self.run(1);
            let waited = self.lockstep.now() - begin;
            assert!(waited < PATIENCE, "{:?}", self.lockstep.client.lifecycle);
        }
    }

    /// The hand on the deadman keeps still.
    fn fall_silent(&mut self) {
        let now = self.lockstep.now();
        let pause = self.random.random_range(20..300);
        let for_good = self.random.random_bool(0.1);
        let Some(hand) = self
            .session
            .as_mut()
            .and_then(|session| session.deadman.as_mut())
        else {
            return;
        };
        hand.silent = now + pause;
        if for_good {
            hand.token = None;
        }
        self.run(pause);
    }

    /// Ends the session in one of the ways that there are.
    fn end(&mut self) {
        let Some(session) = &mut self.session else {
            return;
        };
        let (id, over) = (session.id, session.over);
        let way = self.random.random_range(0..3);
        session.over = true;
        if way == 2 {
            if let Some(stop) = self.lockstep.stop() {
                let now = self.lockstep.now();
                for given in &mut self.open {
                    given.stopped = true;
                }
                self.add(Given::new(stop, Work::Stop, Then::Finish, now));
            }
            return;
        }
        if !over {
            for given in &mut self.open {
                given.released = true;
                given.stopped |= given.id != id;
            }
        }
        match way {
            0 => self.lockstep.disengage(id),
            _ => self.lockstep.cancel(id),
        }
    }

    /// Somebody else wants the arm.
    fn interfere(&mut self) {
        let goal = self.lockstep.goal(Target::Rest, Then::Finish);
        let has_it = self.session.as_ref().is_some_and(|session| {
            let ended = self.lockstep.client.outcome(session.id).is_some();
            let of_it = self.open.iter().find(|given| given.id == session.id);
            // One that lets go lets others wait for the arm.
            let lets_go = of_it.is_none_or(|given| given.released || given.stopped);
            !(ended || lets_go || session.over)
        });
        if has_it {
            assert_eq!(self.lockstep.submit(goal), Err(MotionError::Busy));
        }
    }

    fn lose(&mut self) {
        if self.lockstep.client.record.activity != Activity::Running {
            return;
        }
        let count = match self.random.random_range(0..4) {
            0 => self.random.random_range(18..30),
            _ => self.random.random_range(1..17),
        };
        self.causes.lose(self.lockstep.now(), count);
        if self.random.random_bool(0.5) {
            self.lockstep.link.drop_states(count);
        } else {
            self.lockstep.link.drop_commands(count);
        }
    }

    /// Only while torques are ours: how stiffly the robot itself holds is not what is tested here.
    fn push(&mut self) {
        let ours = self
            .session
            .as_ref()
            .is_some_and(|session| session.backend == Backend::Torques);
        if !ours || self.lockstep.client.record.activity != Activity::Running {
            return;
        }
        self.causes.push();
        let force = Vector3::from_fn(|_, _| self.random.random_range(-25.0..25.0));
        let duration = self.random.random_range(20..400);
        let wrench = Wrench::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
        self.lockstep.robot.push_end_effector(wrench, duration);
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
            tally,
            ..
        } = self;
        self.open
            .retain(|given| match lockstep.client.outcome(given.id) {
                Some(outcome) => {
                    given.judge(outcome, lockstep, causes);
                    tally.count(outcome);
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

    /// Lets everything come to its end, and checks it.
    fn finish(&mut self) {
        self.lockstep.robot.press_user_stop(false);
        if self.random.random_bool(0.8) {
            self.end();
        }
        let begin = self.lockstep.now();
        while !self.lockstep.client.lifecycle.is_idle() {
            let waited = self.lockstep.now() - begin;
            // Nobody ends it who was to.
            if waited == 1000 {
                self.end_by_stop();
            }
            assert!(waited < PATIENCE, "{:?}", self.lockstep.client.lifecycle);
            self.tick();
        }
        self.tick();
        assert!(self.open.is_empty(), "{:?}", self.open);
        let late = |id: &&GoalId| self.lockstep.client.outcome(**id).is_some();
        let late = self.chunks.iter().filter(late).count();
        assert_eq!(self.given + late, self.lockstep.client.resolved());
        self.lockstep.robot.let_go();
        self.lockstep.link = Link::perfect();
        self.run(400);
        let dq = self.lockstep.robot.dq();
        assert!(dq.amax() < 0.02, "the arm still moves: {dq}");
        assert!(self.lockstep.client.driver.is_watching());
        // Whatever happened, the next motion works.
        let stopped_itself = self.lockstep.client.state.robot_mode != RobotMode::Idle;
        if stopped_itself {
            assert!(!self.calm);
            self.recover();
        }
        if stopped_itself || self.random.random_bool(0.2) {
            let again = self.lockstep.begin(Target::Joints(READY.into()));
            let outcome = self.lockstep.until_resolved(again, PATIENCE);
            // An arm that was pushed into itself has no way out that begins there.
            let pushed_together =
                self.causes.pushed() && outcome == Err(MotionError::Braked(Lapse::Blocked));
            assert!(outcome.is_ok() || pushed_together, "{outcome:?}");
        }
        self.tally.robot_time += self.lockstep.now();
    }

    fn recover(&mut self) {
        self.lockstep.request(&Request::AutomaticErrorRecovery);
        let begin = self.lockstep.now();
        while self.lockstep.client.state.robot_mode != RobotMode::Idle {
            self.tick();
            assert!(self.lockstep.now() < begin + 2000, "it recovers");
        }
    }

    fn end_by_stop(&mut self) {
        let now = self.lockstep.now();
        if let Some(stop) = self.lockstep.stop() {
            for given in &mut self.open {
                given.stopped = true;
            }
            self.add(Given::new(stop, Work::Stop, Then::Finish, now));
        }
    }
}
