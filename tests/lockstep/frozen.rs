//! Arms that ignore their commands while the robot reports the motion and no error.

use franka_lockstep::Lockstep;
use franka_model::{Load, RobotKind};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::{Engagement, MotionError, Party};
use franka_rt::session::{Backend, GoalId, Guard, Lapse, OnArrival, Target};
use franka_sim::arm::{Arm, Family};
use franka_sim::{Config, Freeze, Touch};
use franka_tests::thorough;
use nalgebra::{Isometry3, Translation3, Vector3};

const FREEZES: [Freeze; 2] = [Freeze::Joints, Freeze::Controllers];

fn backends() -> impl Iterator<Item = Backend> {
    [Backend::Torques]
        .into_iter()
        .chain(Backend::ROBOT_CONTROLLERS)
}

/// An arm of the realistic family that no contact stops.
fn realistic(kind: RobotKind, seed: u64) -> Lockstep {
    sampled(kind, seed, &Family::realistic())
}

fn sampled(kind: RobotKind, seed: u64, family: &Family) -> Lockstep {
    let mut lockstep = Lockstep::new(Config {
        arm: Some(Arm::sample(kind, seed, family)),
        seed,
        ..Lockstep::config_of(kind)
    });
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
    lockstep
}

/// A session on such an arm.
fn engaged(kind: RobotKind, seed: u64, backend: Backend) -> (Lockstep, GoalId) {
    let mut lockstep = realistic(kind, seed);
    let engaged = lockstep.engage_with(Engagement {
        backend,
        ..Engagement::default()
    });
    (lockstep, engaged)
}

fn aside(lockstep: &Lockstep, by: f64) -> Isometry3<f64> {
    Translation3::new(0.0, by, 0.0) * lockstep.arm_pose()
}

/// With every back end, frozen at rest before the goal comes, and in motion. The second robot with
/// only one back end, unless the run is thorough.
#[test]
fn a_frozen_arm_is_named_within_a_second() {
    for kind in RobotKind::ALL {
        for (number, backend) in backends().enumerate() {
            if kind == RobotKind::Fer && number > 0 && !thorough() {
                continue;
            }
            for freeze in FREEZES {
                for moving in [0, 600] {
                    let what = format!("{kind:?} {backend} {freeze:?} after {moving} ms");
                    let (mut lockstep, engaged) = engaged(kind, number as u64, backend);
                    let target = aside(&lockstep, 0.25);
                    if moving == 0 {
                        lockstep.robot.freeze(Some(freeze));
                    }
                    let goal = lockstep.within(engaged, target.into(), OnArrival::ReportAndHold);
                    let goal = goal.expect("within reach");
                    lockstep.run(moving);
                    lockstep.robot.freeze(Some(freeze));
                    let named = named(&mut lockstep);
                    println!("{what}: named after {named:?} ms");
                    assert!(
                        named.is_some_and(|ms| ms <= NAMED_WITHIN),
                        "{what}: {named:?}"
                    );
                    let outcome = lockstep.until_resolved(goal, RESOLVED_WITHIN);
                    assert_eq!(outcome, Err(IGNORED), "{what}");
                    leaps_not(&mut lockstep, &what);
                    if lockstep.client.outcome(engaged).is_some() {
                        // A robot that resumes with torques that have stepped ends the motion.
                        assert_eq!((backend, freeze), (Backend::Torques, Freeze::Controllers));
                        continue;
                    }
                    // The arm continues from its position.
                    let back = lockstep.within(engaged, target.into(), OnArrival::ReportAndHold);
                    let back = back.expect("within reach");
                    let outcome = lockstep.until_resolved(back, 10_000);
                    assert!(outcome.is_ok(), "{what}: {outcome:?}");
                }
            }
        }
    }
}

/// The longest time until a frozen arm is reported, `[ms]`. A reference that begins at rest needs
/// most of it to get far enough from the arm.
const NAMED_WITHIN: u64 = 900;

/// The longest time from there until its goal resolves, `[ms]`: the reference returns to the arm.
const RESOLVED_WITHIN: u64 = 2500;

const IGNORED: MotionError = MotionError::Braked(Lapse::Unresponsive);

#[test]
fn an_arm_that_ignores_its_commands_is_the_robots_fault() {
    assert_eq!(IGNORED.party(), Party::Robot);
}

#[test]
fn a_motion_of_a_frozen_arm_ends() {
    for kind in RobotKind::ALL {
        for freeze in FREEZES {
            let mut lockstep = realistic(kind, 3);
            let target = aside(&lockstep, 0.25);
            let goal = lockstep.begin(target.into());
            lockstep.run(600);
            lockstep.robot.freeze(Some(freeze));
            let outcome = lockstep.until_resolved(goal, NAMED_WITHIN + RESOLVED_WITHIN);
            assert_eq!(outcome, Err(IGNORED), "{kind:?} {freeze:?}");
        }
    }
}

/// Under every back end: the arm rests, so the stop resolves, and the session ends.
#[test]
fn a_stop_of_a_frozen_arm_ends() {
    let cases = RobotKind::ALL
        .into_iter()
        .flat_map(|kind| backends().enumerate().map(move |case| (kind, case)));
    for (kind, (number, backend)) in cases {
        for freeze in FREEZES {
            let (mut lockstep, engaged) = engaged(kind, number as u64, backend);
            let what = format!("{kind:?} {backend} {freeze:?}");
            let target = aside(&lockstep, 0.25);
            head_for(&mut lockstep, engaged, target);
            lockstep.run(600);
            lockstep.robot.freeze(Some(freeze));
            lockstep.run(20);
            let stop = lockstep.stop().expect("it moves");
            let outcome = lockstep.until_resolved(stop, RESOLVED_WITHIN);
            assert!(outcome.is_ok(), "{what}: {outcome:?}");
            assert!(!lockstep.client.state.motion_running(), "{what}");
            let ended = lockstep.client.outcome(engaged);
            assert_eq!(ended, Some(&Err(MotionError::Stopped)), "{what}");
        }
    }
}

/// Milliseconds until the guard binds, within three seconds.
fn named(lockstep: &mut Lockstep) -> Option<u64> {
    (1..=3000).find(|_| {
        lockstep.tick();
        lockstep
            .client
            .record
            .bindings
            .contains(Guard::Unresponsive)
    })
}

/// Makes the arm obey again once its goal was given up, and checks that it does not jump.
fn leaps_not(lockstep: &mut Lockstep, what: &str) {
    lockstep.run(1000);
    let stood = lockstep.arm_pose();
    lockstep.robot.freeze(None);
    lockstep.run(1000);
    let moved = (lockstep.arm_pose().translation.vector - stood.translation.vector).norm();
    assert!(moved < 5e-3, "{what}: {moved} m");
}

/// True if the guard binds within this time.
fn binds(lockstep: &mut Lockstep, milliseconds: u64) -> bool {
    let mut bound = false;
    for _ in 0..milliseconds {
        lockstep.tick();
        bound |= lockstep
            .client
            .record
            .bindings
            .contains(Guard::Unresponsive);
    }
    bound
}

/// Friction against small commands; an obstacle that holds the arm in motion and at its goal; and
/// an arm that rests there. The harness checks the same in every other test.
#[test]
fn an_arm_that_is_held_or_rests_is_not_named() {
    let seeds = if thorough() { 10 } else { 1 };
    for kind in RobotKind::ALL {
        for (number, backend) in backends().enumerate() {
            if kind == RobotKind::Fer && number > 1 && !thorough() {
                continue;
            }
            for seed in 0..seeds {
                let (mut lockstep, engaged) = engaged(kind, 7 * seed + number as u64, backend);
                let what = format!("{kind:?} {backend} {seed}");
                let home = lockstep.arm_pose();
                // Steps that friction holds for a while.
                for by in [0.5e-3, 1e-3, 2e-3, 4e-3] {
                    let small = Translation3::new(by, -by, by) * home;
                    head_for(&mut lockstep, engaged, small);
                    assert!(!binds(&mut lockstep, 700), "{what}: a step of {by} m");
                }
                head_for(&mut lockstep, engaged, home);
                assert!(!binds(&mut lockstep, 1500), "{what}: at rest");
                // A wall that is soft enough for the robot's controllers, and a hand that holds on.
                for touch in [wall(&home), Touch::hold().stiffness(2000.0)] {
                    let touch = lockstep.robot.touch(touch);
                    head_for(
                        &mut lockstep,
                        engaged,
                        Translation3::new(0.0, 0.1, 0.0) * home,
                    );
                    assert!(!binds(&mut lockstep, 3000), "{what}: held");
                    // Released there, a stiff controller would leap.
                    head_for(&mut lockstep, engaged, home);
                    assert!(!binds(&mut lockstep, 2000), "{what}: on its way back");
                    lockstep.robot.release(touch);
                    assert!(!binds(&mut lockstep, 500), "{what}: released");
                }
                assert_eq!(lockstep.client.outcome(engaged), None, "{what}");
            }
        }
    }
}

fn wall(home: &Isometry3<f64>) -> Touch {
    let place = home.translation.vector + Vector3::y() * 0.02;
    Touch::wall(place, -Vector3::y()).stiffness(2000.0)
}

fn head_for(lockstep: &mut Lockstep, engaged: GoalId, pose: Isometry3<f64>) {
    let goal = lockstep.within(engaged, Target::Pose(pose), OnArrival::Hold);
    goal.expect("within reach");
}

/// Arms that stick most, at a hundredth and a tenth of the default pace, with half a kilogram that
/// is not declared: the harness checks that none is named.
#[test]
fn slow_motions_of_arms_that_stick_are_not_named() {
    let seeds = if thorough() { 30 } else { 3 };
    for seed in 0..seeds {
        let kind = RobotKind::ALL[seed as usize % 2];
        let mut lockstep = sampled(kind, seed, &Family::bad());
        lockstep.robot.attach(Load {
            mass: 0.5,
            ..Load::NONE
        });
        let home = lockstep.arm_pose();
        let engaged = lockstep.engage();
        for (by, pace) in [(0.004, 0.01), (0.03, 0.1), (0.15, 1.0)] {
            let target = Translation3::new(0.0, by, -by / 2.0) * home;
            let mut goal = lockstep.goal(target.into(), OnArrival::ReportAndHold);
            goal.budget = goal.budget.scaled(pace);
            lockstep.submit_within(engaged, goal).expect("within reach");
            lockstep.run(3000);
        }
        assert_eq!(lockstep.client.outcome(engaged), None, "{kind:?} {seed}");
    }
}
