//! Motions that continue until a condition is true: contacts, free ways, and every coincidence of a
//! condition with another event.

mod backends;
mod contact;
mod edges;
mod free;
mod pushed;
mod sessions;

use std::time::Duration;

use franka_lockstep::Lockstep;
use franka_model::{Model, RobotKind};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::MotionReport;
use franka_rt::session::{Budget, Goal, GoalId, Guard, OnArrival, Reacted, Reaction, Target};
use franka_sim::arm::Family;
use franka_sim::{Arm, Config, Touch, TouchId};
use nalgebra::{Translation3, Vector3};

const MS: Duration = Duration::from_millis(1);

/// A robot with this arm, whose collision thresholds tolerate a contact.
fn with_arm(kind: RobotKind, arm: Option<Arm>, seed: u64) -> Lockstep {
    let mut lockstep = Lockstep::new(Config {
        arm,
        seed,
        ..Lockstep::config_of(kind)
    });
    tolerate(&mut lockstep);
    lockstep
}

fn realistic(kind: RobotKind, seed: u64) -> Lockstep {
    let arm = Arm::sample(kind, seed, &Family::realistic());
    with_arm(kind, Some(arm), seed)
}

fn tolerate(lockstep: &mut Lockstep) {
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
}

/// The end effector's pose, raised by `by`.
fn above(lockstep: &Lockstep, by: f64) -> Target {
    (Translation3::new(0.0, 0.0, by) * lockstep.arm_pose()).into()
}

/// A goal at this velocity of translation, `[m/s]`, with the default accelerations.
fn at(
    velocity: f64,
    target: Target,
    reaction: impl Into<Reaction>,
    on_arrival: OnArrival,
    lockstep: &mut Lockstep,
) -> Goal {
    let limits = Model::of(lockstep.robot.config().kind).joint_limits();
    let mut budget = Budget::of(limits);
    budget.translation.velocity = velocity;
    Goal {
        budget,
        reaction: Some(reaction.into()),
        ..lockstep.goal(target, on_arrival)
    }
}

/// A table so far below the end effector, of this stiffness, `[N/m]`.
fn table(lockstep: &mut Lockstep, below: f64, stiffness: f64) -> TouchId {
    let hand = lockstep.robot.true_pose().translation.vector;
    let table = Touch::wall(hand - Vector3::z() * below, Vector3::z());
    lockstep.robot.touch(table.stiffness(stiffness))
}

/// Action of a touch on the arm, `[N]`.
fn felt(lockstep: &Lockstep, touch: TouchId) -> f64 {
    let felt = lockstep.robot.felt(touch).expect("it has not ended");
    felt.fixed_rows::<3>(0).norm()
}

/// True if the record of the last cycle reports the goal's reaction.
fn says_so(lockstep: &Lockstep) -> bool {
    lockstep.client.record.bindings.contains(Guard::Reaction)
}

/// True if the goal is not resolved yet.
///
/// # Panics
/// If the robot has been running for two minutes.
fn goes_on(lockstep: &Lockstep, goal: GoalId) -> bool {
    assert!(lockstep.now() < 120_000, "{goal:?} never resolves");
    lockstep.client.outcome(goal).is_none()
}

/// Runs until the goal is resolved.
fn report(lockstep: &mut Lockstep, goal: GoalId) -> MotionReport {
    let outcome = lockstep.until_resolved(goal, 20_000);
    outcome.expect("an arrival or a reaction")
}

/// The reaction of a goal that must have reacted.
fn reacted(lockstep: &mut Lockstep, goal: GoalId) -> Reacted {
    report(lockstep, goal).reacted.expect("a reaction")
}
