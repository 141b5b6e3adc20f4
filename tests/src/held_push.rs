//! Pushes on an arm that holds its pose, and what they leave behind.

use franka_lockstep::{Lockstep, Outcome};
use franka_model::RobotKind;
use franka_proto::{CollisionBehavior, Request};
use franka_rt::session::{GoalId, OnArrival, PoseError};
use franka_sim::arm::{Arm, Family};
use franka_sim::{Config, Touch};
use nalgebra::{Isometry3, Translation3, UnitVector3, Vector3};
use rand::Rng;
use rand::rngs::SmallRng;

/// A hand that pushes the end effector of an arm that holds its pose.
#[derive(Clone, Copy, Debug)]
pub struct HeldPush {
    /// `[N]`, base axes.
    pub force: Vector3<f64>,
    /// Duration, `[ms]`.
    pub lasts: u64,
    /// True if the arm has moved before, so that its friction is known.
    pub learned: bool,
    /// Begin of the push after the goal was set or has arrived, `[ms]`.
    pub after: u64,
}

/// What a push has left behind.
#[derive(Clone, Copy, Debug)]
pub struct Aftermath {
    /// Distance from the held pose two seconds after the push, `[m]` and `[rad]`.
    pub left: PoseError,
    /// Greatest distance in the second after these two, `[m]` and `[rad]`.
    pub later: PoseError,
    /// Greatest distance during the push, `[m]`.
    pub gave_way: f64,
    /// The outcome of a motion to the held pose, at the end.
    pub arrived: bool,
}

impl HeldPush {
    /// Draws a push in any direction. Force: 5 to 30 N. Time: 0.2 to 5 s.
    pub fn random(random: &mut SmallRng) -> Self {
        let way = loop {
            let way = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0_f64));
            if let Some(way) = UnitVector3::try_new(way, 0.1).filter(|_| way.norm() < 1.0) {
                break way;
            }
        };
        // Half of all below 12 N, and half of all shorter than 1 s.
        let between = |random: &mut SmallRng, least: f64, most: f64| {
            least * (most / least).powf(random.random_range(0.0..1.0))
        };
        Self {
            force: way.into_inner() * between(random, 5.0, 30.0),
            lasts: (between(random, 0.2, 5.0) * 1e3) as u64,
            learned: random.random_bool(0.5),
            after: match random.random_bool(0.5) {
                true => 0,
                false => random.random_range(500..3000),
            },
        }
    }

    /// Pushes this arm. Its collision thresholds are above the push.
    ///
    /// # Panics
    /// If a goal is refused, or one does not arrive before the push.
    pub fn on(&self, kind: RobotKind, arm: Arm, seed: u64) -> Aftermath {
        let mut lockstep = Lockstep::new(Config {
            arm: Some(arm),
            seed,
            ..Lockstep::config_of(kind)
        });
        let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
        lockstep.request(&Request::SetCollisionBehavior(tolerant));
        lockstep.run(5);
        let home = lockstep.arm_pose();
        let engaged = lockstep.engage();
        if self.learned {
            for way in [Vector3::x(), Vector3::y(), Vector3::z()] {
                for target in [Translation3::from(way * 0.05) * home, home] {
                    arrive(&mut lockstep, engaged, target).expect("nothing holds it");
                }
            }
        } else {
            let held = lockstep.within(engaged, home.into(), OnArrival::Hold);
            held.expect("it is there");
        }
        lockstep.run(self.after);
        self.leave(&mut lockstep, engaged, &home)
    }

    /// Pushes an arm that holds its pose in a session, and measures what this leaves.
    ///
    /// # Panics
    /// If the motion to the held pose is refused.
    pub fn leave(
        &self,
        lockstep: &mut Lockstep,
        engaged: GoalId,
        home: &Isometry3<f64>,
    ) -> Aftermath {
        let off = |lockstep: &Lockstep| PoseError::between(&lockstep.arm_pose(), home);
        lockstep
            .robot
            .touch(Touch::force(self.force).lasting(self.lasts));
        let mut gave_way = 0.0_f64;
        for _ in 0..self.lasts {
            lockstep.tick();
            gave_way = gave_way.max(off(lockstep).translation);
        }
        lockstep.run(RETURN);
        let left = off(lockstep);
        let mut later = left;
        for _ in 0..1000 {
            lockstep.tick();
            let now = off(lockstep);
            later.translation = later.translation.max(now.translation);
            later.rotation = later.rotation.max(now.rotation);
        }
        Aftermath {
            left,
            later,
            gave_way,
            arrived: arrive(lockstep, engaged, *home).is_ok(),
        }
    }
}

/// Moves within the session, and awaits the arrival.
pub fn arrive(lockstep: &mut Lockstep, engaged: GoalId, target: Isometry3<f64>) -> Outcome {
    let goal = lockstep.within(engaged, target.into(), OnArrival::ReportAndHold);
    lockstep.until_resolved(goal.expect("within reach"), 20_000)
}

/// A random arm of the realistic family, every fifth one the typical one.
pub fn random_arm(kind: RobotKind, seed: u64) -> Arm {
    match seed % 5 {
        0 => Arm::realistic(kind),
        _ => Arm::sample(kind, seed, &Family::realistic()),
    }
}

/// Time in which an arm comes back after a push, `[ms]`.
pub const RETURN: u64 = 2000;
