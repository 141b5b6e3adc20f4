//! Random schedules of goals, stops and faults, each replayable from its seed.
//!
//! Even seeds are calm: nothing goes wrong, so nothing may be reported as wrong. Odd seeds lose datagrams, push the arm,
//! trip the robot and press its user stop. Whatever happens, every goal resolves once and fittingly, the arm comes to
//! rest, and the next motion works. The harness holds every command and its reference against the limits meanwhile.

use std::collections::BTreeMap;

use franka_model::{READY, Wrench};
use franka_proto::{CollisionBehavior, Request, RobotError, RobotMode};
use franka_rt::driver::Activity;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalId, Target, Then};
use franka_tests::lockstep::{Lockstep, Outcome};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// Schedules of one run; each takes some five seconds of the robot's time.
const SCHEDULES: u64 = 200;

/// Largest torque of a session's first command at rest, `[N m]`, for budgets up to the default: what the reference's own
/// first millisecond asks of the dampers.
const FIRST_TORQUE: f64 = 0.02;

#[test]
fn every_schedule_ends_with_all_goals_resolved_and_the_arm_at_rest() {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let first: u64 = number("FRANKA_SCHEDULE_SEED").unwrap_or(1);
    let count: u64 = number("FRANKA_SCHEDULES").unwrap_or(SCHEDULES);
    let mut tally: BTreeMap<&str, u64> = BTreeMap::new();
    let mut robot_time = 0;
    for seed in first..first + count {
        let replay = Replay(seed);
        let mut schedule = Schedule::new(seed);
        schedule.play();
        for (_, outcome) in schedule.finish() {
            *tally.entry(kind(&outcome)).or_default() += 1;
        }
        robot_time += schedule.lockstep.now();
        drop(replay);
    }
    println!(
        "seeds {first} to {}: {} s of robot time, {tally:?}",
        first + count - 1,
        robot_time / 1000
    );
}

/// Names the seed of the schedule that a panic ends.
struct Replay(u64);

impl Drop for Replay {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!(
                "replay with FRANKA_SCHEDULE_SEED={} FRANKA_SCHEDULES=1",
                self.0
            );
        }
    }
}

fn kind(outcome: &Outcome) -> &'static str {
    match outcome {
        Ok(_) => "ok",
        Err(MotionError::Superseded) => "superseded",
        Err(MotionError::Stopped) => "stopped",
        Err(MotionError::Short(_)) => "short",
        Err(MotionError::Control(error)) if error.is_reflex() => "reflex",
        Err(MotionError::Rejected(_)) => "rejected",
        Err(MotionError::Control(_)) => "aborted",
        Err(error) => panic!("nothing in here causes {error:?}"),
    }
}

struct Schedule {
    lockstep: Lockstep,
    random: SmallRng,
    home: Isometry3<f64>,
    calm: bool,
    goals: Vec<GoalId>,
    /// Those faster than the default.
    hasty: Vec<u64>,
    /// The newest goal, if it is held.
    held: Option<GoalId>,
    running: bool,
}

impl Schedule {
    fn new(seed: u64) -> Self {
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
            home: lockstep.true_pose(),
            lockstep,
            random,
            calm,
            goals: Vec::new(),
            hasty: Vec::new(),
            held: None,
            running: false,
        }
    }

    fn play(&mut self) {
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
                self.submit(target, Then::Finish);
            }
            3..=4 => {
                let target = self.joints();
                self.submit(target, Then::Finish);
            }
            5 => {
                let target = self.pose();
                self.held = self.submit(target, Then::Hold);
            }
            6..=7 => self.update(),
            8 => match self.held.take() {
                Some(held) => self.lockstep.client.lifecycle.close(held),
                None => self.stop(),
            },
            9 => {
                if !self.goals.is_empty() {
                    let which = self.random.random_range(0..self.goals.len());
                    // Mostly the newest: the others have been superseded.
                    let which = which.max(self.goals.len().saturating_sub(2));
                    let goal = self.goals[which];
                    self.held = self.held.filter(|&held| held != goal);
                    self.lockstep.cancel(goal);
                }
            }
            10 => {
                let count = self.random.random_range(1..=25);
                self.lockstep.link.drop_states(count);
            }
            11 => {
                let count = self.random.random_range(1..=25);
                self.lockstep.link.drop_commands(count);
            }
            // Only while torques are ours: how stiffly the robot itself holds is not what is tested here.
            12..=13 if self.running => {
                let force = Vector3::from_fn(|_, _| self.random.random_range(-25.0..25.0));
                let duration = self.random.random_range(20..600);
                self.lockstep.robot.push_end_effector(
                    Wrench::new(force.x, force.y, force.z, 0.0, 0.0, 0.0),
                    duration,
                );
            }
            12..=13 => {}
            14 => self.lockstep.robot.trip(RobotError::CartesianReflex),
            _ => {
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
        let mut vector = |most: f64| Vector3::from_fn(|_, _| self.random.random_range(-most..most));
        let (way, turn) = (vector(0.1), vector(0.3));
        Target::Pose(Isometry3::from_parts(
            Translation3::from(self.home.translation.vector + way),
            UnitQuaternion::from_scaled_axis(turn) * self.home.rotation,
        ))
    }

    fn joints(&mut self) -> Target {
        let offset: [f64; 7] = core::array::from_fn(|_| self.random.random_range(-0.3..0.3));
        Target::Joints(core::array::from_fn(|i| READY[i] + offset[i]))
    }

    fn submit(&mut self, target: Target, then: Then) -> Option<GoalId> {
        let mut goal = self.lockstep.goal(target, then);
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
            // From where the arm is, the search may not find a way to a pose.
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

    /// Lets everything come to its end, checks it, and returns how the goals turned out.
    fn finish(&mut self) -> Vec<(GoalId, Outcome)> {
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
            let fits = match kind(outcome) {
                "ok" | "superseded" | "stopped" | "short" => true,
                _ => !self.calm,
            };
            assert!(fits, "{goal:?}: {outcome:?}");
        }
        // Whatever happened, the next motion works.
        if self.lockstep.client.state.robot_mode != RobotMode::Idle {
            assert!(!self.calm);
            self.lockstep.request(&Request::AutomaticErrorRecovery);
            self.run(1500);
        }
        let again = self.lockstep.begin(Target::Joints(READY.into()));
        let outcome = self.lockstep.until_resolved(again, 15_000);
        assert!(outcome.is_ok(), "{outcome:?}");
        outcomes
    }
}
