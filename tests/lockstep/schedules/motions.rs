//! Motions that supersede one another, each with its own end.

use franka_lockstep::Lockstep;
use franka_model::{READY, Wrench};
use franka_proto::{CollisionBehavior, Request, RobotError, RobotMode};
use franka_rt::driver::Activity;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalId, OnArrival, Target};
use nalgebra::{Isometry3, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::causes::Causes;
use super::{OutcomeCounts, draw, kind};

/// The largest torque of a session's first command at rest, `[N m]`, for budgets up to the default.
/// The dampers command it for the reference's first millisecond.
const FIRST_TORQUE: f64 = 0.02;

/// One schedule.
pub(super) struct Motions {
    lockstep: Lockstep,
    random: SmallRng,
    home: Isometry3<f64>,
    calm: bool,
    causes: Causes,
    goals: Vec<GoalId>,
    /// The goals faster than the default.
    hasty: Vec<u64>,
    /// The newest goal, if it is held and can be updated.
    held: Option<GoalId>,
    running: bool,
}

impl Motions {
    pub(super) fn new(seed: u64) -> Self {
        let mut lockstep = Lockstep::ready();
        let mut random = SmallRng::seed_from_u64(seed);
        let calm = seed.is_multiple_of(2);
        if !calm && random.random_bool(0.7) {
            let tolerant =
                CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
            lockstep.request(&Request::SetCollisionBehavior(tolerant));
            lockstep.run(5);
        }
        Self {
            home: lockstep.arm_pose(),
            lockstep,
            random,
            calm,
            causes: Causes::default(),
            goals: Vec::new(),
            hasty: Vec::new(),
            held: None,
            running: false,
        }
    }

    pub(super) fn play(&mut self) {
        for _ in 0..self.random.random_range(3..12) {
            self.act();
            let pause = match self.random.random_range(0..4) {
                0 => self.random.random_range(0..12),
                1 => self.random.random_range(0..120),
                _ => self.random.random_range(0..900),
            };
            self.run(pause);
        }
        self.lockstep.robot.press_user_stop(false);
        match (self.held.take(), self.random.random_range(0..3)) {
            (Some(held), 0) => self.lockstep.cancel(held),
            (Some(held), 1) => self.lockstep.client.lifecycle.close(held),
            (Some(_), _) | (None, 0) => self.stop(),
            (None, _) => {}
        }
    }

    fn act(&mut self) {
        match self.random.random_range(0..if self.calm { 10 } else { 16 }) {
            0..=2 => {
                let target = self.pose();
                self.submit(target, OnArrival::ReportAndFinish);
            }
            3..=4 => {
                let target = self.joints();
                self.submit(target, OnArrival::ReportAndFinish);
            }
            5 => {
                let target = self.pose();
                self.held = self.submit(target, OnArrival::Hold);
            }
            6..=7 => self.update(),
            8 => match self.held.take() {
                Some(held) => self.lockstep.client.lifecycle.close(held),
                None => self.stop(),
            },
            9 => {
                if !self.goals.is_empty() {
                    let which = self.random.random_range(0..self.goals.len());
                    // Mostly the newest, since the others have been superseded.
                    let which = which.max(self.goals.len().saturating_sub(2));
                    let goal = self.goals[which];
                    self.held = self.held.filter(|&held| held != goal);
                    self.lockstep.cancel(goal);
                }
            }
            10 => {
                let count = self.random.random_range(1..=25);
                self.causes.lose(self.lockstep.now(), count);
                self.lockstep.link.drop_states(count);
            }
            11 => {
                let count = self.random.random_range(1..=25);
                self.causes.lose(self.lockstep.now(), count);
                self.lockstep.link.drop_commands(count);
            }
            // Only under our own torques: the stiffness of the robot's own controller is not tested
            // here.
            12..=13 if self.running => {
                self.causes.push();
                let force = Vector3::from_fn(|_, _| self.random.random_range(-25.0..25.0));
                let duration = self.random.random_range(20..600);
                self.lockstep.robot.push_end_effector(
                    Wrench::new(force.x, force.y, force.z, 0.0, 0.0, 0.0),
                    duration,
                );
            }
            12..=13 => {}
            14 => {
                self.causes.trip(RobotError::CartesianReflex);
                self.lockstep.robot.trip(RobotError::CartesianReflex);
            }
            _ => {
                self.causes.stopped = true;
                let press = self.random.random_bool(0.5);
                self.lockstep.robot.press_user_stop(press);
            }
        }
        if self.lockstep.client.state.robot_mode == RobotMode::Reflex
            && self.random.random_bool(0.7)
        {
            self.lockstep.request(&Request::AutomaticErrorRecovery);
        }
    }

    fn pose(&mut self) -> Target {
        draw::pose(&mut self.random, &self.home, 0.1, 0.3)
    }

    fn joints(&mut self) -> Target {
        Target::Joints(draw::joints(&mut self.random, 0.3))
    }

    fn submit(&mut self, target: Target, on_arrival: OnArrival) -> Option<GoalId> {
        let mut goal = self.lockstep.goal(target, on_arrival);
        let speeds = [0.2, 0.5, 1.0, 1.0, 1.4];
        let speed = speeds[self.random.random_range(0..speeds.len())];
        goal.budget = goal.budget.scaled(speed);
        self.held = None;
        match self.lockstep.submit(goal) {
            Ok(id) => {
                self.goals.push(id);
                if speed > 1.0 {
                    self.hasty.push(id.0);
                }
                Some(id)
            }
            // From the arm's position, the search may find no path to a pose.
            Err(MotionError::Goal(_)) => None,
            Err(error) => panic!("{error:?}"),
        }
    }

    fn update(&mut self) {
        let Some(held) = self.held else {
            return;
        };
        for _ in 0..self.random.random_range(1..6) {
            let target = if self.random.random_bool(0.8) {
                self.pose()
            } else {
                self.joints()
            };
            let updated = self.lockstep.update(held, target);
            let over = self.lockstep.client.outcome(held).is_some();
            assert!(
                over || updated != Ok(false),
                "a held goal is being followed"
            );
            let pause = self.random.random_range(1..120);
            self.run(pause);
        }
    }

    fn stop(&mut self) {
        self.held = None;
        self.goals.extend(self.lockstep.stop());
    }

    fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }

    fn tick(&mut self) {
        self.lockstep.tick();
        let running = self.lockstep.client.record.activity == Activity::Running;
        let rests = self
            .lockstep
            .client
            .state
            .dq
            .iter()
            .all(|dq| dq.abs() < 5e-4);
        let hasty = self.hasty.contains(&self.lockstep.client.record.goal);
        if running && !self.running && rests && !hasty {
            let tau = self.lockstep.client.record.tau_c;
            let most = tau.iter().fold(0.0, |most: f64, tau| most.max(tau.abs()));
            assert!(most <= FIRST_TORQUE, "the first torques are {tau:?}");
        }
        self.running = running;
        if self.calm {
            assert!(
                self.lockstep.client.state.errors.is_empty(),
                "{}: {}",
                self.lockstep.now(),
                self.lockstep.client.state.errors
            );
        }
    }

    /// Runs until everything has ended, checks it, and counts the outcomes.
    pub(super) fn finish(&mut self, counts: &mut OutcomeCounts) {
        let deadline = self.lockstep.now() + 60_000;
        while !self.lockstep.client.lifecycle.is_idle() {
            self.tick();
            assert!(
                self.lockstep.now() < deadline,
                "not idle: {:?}",
                self.lockstep.client.lifecycle
            );
        }
        self.lockstep.robot.let_go();
        self.run(400);
        let dq = self.lockstep.robot.dq();
        assert!(dq.amax() < 0.02, "the arm still moves: {dq}");
        assert!(self.lockstep.client.driver.is_watching());
        let outcomes: Vec<_> = self
            .goals
            .iter()
            .map(|&goal| {
                let outcome = self.lockstep.client.outcome(goal);
                (goal, outcome.expect("resolved").clone())
            })
            .collect();
        assert_eq!(outcomes.len(), self.lockstep.client.resolved());
        for (goal, outcome) in &outcomes {
            let fits = match outcome {
                Err(MotionError::Control(error)) => self.causes.explains(error),
                outcome => match kind(outcome) {
                    "ok" | "superseded" | "stopped" | "short" | "blocked" => true,
                    _ => !self.calm,
                },
            };
            assert!(fits, "{goal:?}: {outcome:?}");
        }
        // After any event the next motion works.
        if self.lockstep.client.state.robot_mode != RobotMode::Idle {
            assert!(!self.calm);
            self.lockstep.request(&Request::AutomaticErrorRecovery);
            self.run(1500);
        }
        let again = self.lockstep.begin(Target::Joints(READY.into()));
        let outcome = self.lockstep.until_resolved(again, 15_000);
        assert!(outcome.is_ok(), "{outcome:?}");
        for (_, outcome) in &outcomes {
            counts.count(outcome);
        }
        counts.robot_time += self.lockstep.now();
    }
}
