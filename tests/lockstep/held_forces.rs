//! The force with which a hand displaces an arm that holds its pose: before its joints have moved
//! both ways, when their friction is unknown, and afterwards.

use franka_lockstep::Lockstep;
use franka_model::RobotKind;
use franka_proto::{CollisionBehavior, Request};
use franka_rt::law::Gains;
use franka_rt::session::{Goal, OnArrival};
use franka_sim::arm::{Arm, Family};
use franka_sim::{Config, Touch};
use franka_tests::held_push::arrive;
use franka_tests::push::STIFFNESS;
use franka_tests::thorough;
use nalgebra::{Translation3, Vector3};

/// Distances by which the hand displaces the end effector, `[m]`: within the range of friction, and
/// beyond it. The springs alone exert 3 N and 7.5 N there.
const DISTANCES: [f64; 2] = [0.004, 0.01];

/// Velocity of the hand, `[m/s]`.
const PACE: f64 = 0.02;

/// Time for which the hand then holds it there, `[ms]`: the integral has come to its end.
const HELD: u32 = 3000;

/// Forces of the hand, `[N]`.
#[derive(Clone, Copy, Debug)]
struct Force {
    /// Greatest one on the way.
    most: f64,
    /// Mean of the last second.
    held: f64,
}

/// Forces on a hand that displaces an arm by `way`, `[m]`. Before that, the arm has `moved` along
/// each axis and back, or holds its first pose.
fn force(kind: RobotKind, seed: u64, gains: Gains, moved: bool, way: Vector3<f64>) -> Force {
    let distance = way.norm();
    let way = way / distance;
    let mut lockstep = Lockstep::new(Config {
        arm: Some(Arm::sample(kind, seed, &Family::realistic())),
        seed,
        ..Lockstep::config_of(kind)
    });
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
    let home = lockstep.arm_pose();
    let engaged = lockstep.engage();
    if moved {
        for way in [Vector3::x(), Vector3::y(), Vector3::z()] {
            for target in [Translation3::from(way * 0.05) * home, home] {
                arrive(&mut lockstep, engaged, target).expect("nothing holds it");
            }
        }
    }
    let goal = Goal {
        gains,
        ..lockstep.goal(home.into(), OnArrival::Hold)
    };
    let held = lockstep.submit_within(engaged, goal);
    held.expect("it is there");
    lockstep.run(3000);
    let from = lockstep.arm_pose().translation.vector;
    let path = move |t: f64| from + way * (PACE * t).min(distance);
    let push = lockstep.robot.touch(Touch::carry(path, STIFFNESS));
    let mut force = Force {
        most: 0.0,
        held: 0.0,
    };
    let cycles = (distance / PACE * 1e3) as u32 + HELD;
    for cycle in 0..cycles {
        lockstep.tick();
        let felt = lockstep.robot.felt(push).expect("it has not ended");
        let felt = felt.fixed_rows::<3>(0).norm();
        force.most = force.most.max(felt);
        force.held += if cycle + 1000 >= cycles {
            felt / 1e3
        } else {
            0.0
        };
    }
    assert_eq!(lockstep.client.outcome(engaged), None);
    force
}

#[test]
fn an_fr3_whose_friction_is_unknown_resists_a_hand_by_little_more() {
    bounds(RobotKind::Fr3);
}

#[test]
fn an_fer_whose_friction_is_unknown_resists_a_hand_by_little_more() {
    bounds(RobotKind::Fer);
}

fn bounds(kind: RobotKind) {
    let seeds = if thorough() { 12 } else { 2 };
    for (seed, distance) in (0..seeds).zip(DISTANCES.into_iter().cycle()) {
        for way in [Vector3::x(), Vector3::y(), -Vector3::z()] {
            bound(kind, seed, way * distance);
        }
    }
}

fn bound(kind: RobotKind, seed: u64, way: Vector3<f64>) {
    let of = |gains, moved| force(kind, seed, gains, moved, way);
    let springs = of(Gains::cartesian().without_compensation(), true);
    let before = of(Gains::cartesian(), false);
    let after = of(Gains::cartesian(), true);
    let what = format!(
        "{kind:?} {seed}, by {:?} m: springs {springs:.1?}, before {before:.1?}, after {after:.1?}",
        way.as_slice()
    );
    println!("{what}");
    for (with, more) in [(before, BEFORE), (after, AFTER)] {
        assert!(with.most < springs.most + more, "{what}");
        assert!(with.held < springs.held + more, "{what}");
    }
}

/// Additional force before the joints have moved both ways, `[N]`.
const BEFORE: f64 = 5.0;

/// Additional force afterwards, `[N]`.
const AFTER: f64 = 8.0;
