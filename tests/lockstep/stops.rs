//! Ends of motions while hands push the arm: it still receives a stop and stops.

use std::time::Duration;

use franka_diagnosis::{Advice, Cause, Diagnose, Subject};
use franka_lockstep::Lockstep;
use franka_model::{RobotKind, Wrench};
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{Backend, Lapse, OnArrival, Settling, Target};
use franka_sim::arm::{Arm, Distribution, Family};
use franka_sim::{Config, Touch};
use franka_tests::thorough;
use nalgebra::Translation3;

/// The longest time from a stop to its successful result while hands push, `[ms]`. It consists of
/// the time until the robot receives the stop, and the duration of the stop.
const BOUND: u64 = 2500;

/// The same for a stop that reports that the arm was not seen at rest.
const UNSEEN: u64 = BOUND + 2000;

fn arms() -> u64 {
    if thorough() { 20 } else { 1 }
}

/// An arm of the realistic family that no contact stops.
fn realistic(kind: RobotKind, seed: u64) -> Lockstep {
    of_family(kind, seed, &Family::realistic())
}

fn of_family(kind: RobotKind, seed: u64, family: &Family) -> Lockstep {
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

/// Hands that push in turn to either side, with this force and this long each, `[N]` and `[ms]`.
fn hands((force, each): (f64, u64)) -> Touch {
    Touch::over_time(move |seconds| {
        let side = (seconds * 1e3) as u64 / each % 2;
        let y = if side == 0 { force } else { -force };
        Wrench::new(0.0, y, 0.0, 0.0, 0.0, 0.0)
    })
}

/// Force of the hands, and time to each side. The second shakes the arm, also under the robot's own
/// controller.
const PUSHES: [(f64, u64); 4] = [(15.0, 250), SHAKE, (30.0, 250), (60.0, 2000)];

const SHAKE: (f64, u64) = (15.0, 60);

fn aside(lockstep: &Lockstep) -> Target {
    (Translation3::new(0.0, 0.3, 0.0) * lockstep.arm_pose()).into()
}

/// Stops an arm that moves while hands push it, and expects it to stop in time.
fn stop_while_pushed(mut lockstep: Lockstep, push: (f64, u64), what: &str) {
    lockstep.run(700);
    lockstep.robot.touch(hands(push));
    lockstep.run(100);
    let stop = lockstep.stop().expect("it moves");
    let took = (0..12_000).find(|_| {
        lockstep.tick();
        lockstep.client.outcome(stop).is_some()
    });
    let outcome = lockstep.client.outcome(stop);
    let bound = match outcome {
        Some(Ok(_)) => BOUND,
        Some(Err(MotionError::NotAtRest { .. })) if push == SHAKE => UNSEEN,
        _ => panic!("{what}: {outcome:?}"),
    };
    assert!(took.is_some_and(|ms| ms <= bound), "{what}: {took:?} ms");
    let state = &lockstep.client.state;
    assert_eq!(state.robot_mode, RobotMode::Idle, "{what}");
    assert!(state.errors.is_empty(), "{what}: {}", state.errors);
}

#[test]
fn a_stop_ends_in_time_while_hands_push_the_arm() {
    for kind in RobotKind::ALL {
        for seed in 0..arms() {
            for push in PUSHES {
                let mut lockstep = realistic(kind, seed);
                // A patient goal makes no patient stop.
                let mut goal = lockstep.goal(aside(&lockstep), OnArrival::ReportAndFinish);
                goal.settling.timeout = Settling::TIMEOUT_MAX;
                lockstep.submit(goal).expect("within reach");
                stop_while_pushed(lockstep, push, &format!("{kind:?} {seed}: {push:?}"));
            }
        }
    }
}

#[test]
fn a_stop_of_a_session_ends_in_time_while_hands_push_the_arm() {
    for kind in RobotKind::ALL {
        for backend in [Backend::Torques, Backend::ROBOT_CONTROLLERS[0]] {
            for push in PUSHES {
                let mut lockstep = realistic(kind, 0);
                let engaged = lockstep.engage_with(Engagement {
                    backend,
                    ..Engagement::default()
                });
                let target = aside(&lockstep);
                lockstep
                    .within(engaged, target, OnArrival::Hold)
                    .expect("within reach");
                stop_while_pushed(lockstep, push, &format!("{kind:?}, {backend}: {push:?}"));
            }
        }
    }
}

#[test]
fn no_motion_ends_in_a_reflex_because_hands_push_the_arm() {
    for kind in RobotKind::ALL {
        // A hand that pushes harder than the force cap makes the arm too fast.
        for push in [PUSHES[0], SHAKE, PUSHES[2]] {
            for cancelled in [false, true] {
                let mut lockstep = realistic(kind, 0);
                let mut goal = lockstep.goal(aside(&lockstep), OnArrival::ReportAndFinish);
                goal.settling.timeout = Duration::from_secs(1);
                let id = lockstep.submit(goal).expect("within reach");
                lockstep.run(700);
                // Hands that continue to push may keep the arm from its target for as long.
                lockstep.robot.touch(hands(push).lasting(10_000));
                if cancelled {
                    lockstep.cancel(id);
                }
                let outcome = lockstep.until_resolved(id, 20_000);
                let what = format!("{kind:?}, {push:?}, cancelled {cancelled}: {outcome:?}");
                let stopped = matches!(outcome, Err(MotionError::Stopped));
                assert!(!cancelled || stopped, "{what}");
                assert!(!matches!(outcome, Err(MotionError::Control(_))), "{what}");
                lockstep.run(300);
                assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle, "{what}");
            }
        }
    }
}

/// A hand that pushes with this force, `[N]`.
fn steady([x, y, z]: [f64; 3]) -> Touch {
    Touch::over_time(move |_| Wrench::new(x, y, z, 0.0, 0.0, 0.0))
}

/// The longest time from a cancel to its outcome while one hand pushes steadily, `[ms]`: the brake
/// and a second of rest, a second of release, and the stop by the robot's own controller.
const STEADY: u64 = 2500;

/// Force of a hand that pushes harder than the force cap of a goal, `[N]`. Joints then come fast to
/// where the robot allows less speed.
const STEADY_PUSHES: [[f64; 3]; 4] = [
    [0.0, 60.0, 0.0],
    [0.0, -60.0, 0.0],
    [60.0, 0.0, 0.0],
    [0.0, 0.0, -60.0],
];

#[test]
fn a_cancelled_motion_ends_in_no_reflex_while_a_hand_pushes_the_arm_away() {
    // With a higher gain the wrist is so light that this force accelerates it beyond the limit in
    // 80 ms, faster than the robot lets a torque change.
    let family = Family {
        torque_loop_gain: Distribution::Constant(2.0.into()),
        ..Family::realistic()
    };
    for kind in RobotKind::ALL {
        for seed in 0..arms() + 1 {
            for push in STEADY_PUSHES {
                let mut lockstep = of_family(kind, seed, &family);
                let goal = lockstep.goal(aside(&lockstep), OnArrival::ReportAndFinish);
                let id = lockstep.submit(goal).expect("within reach");
                lockstep.run(700);
                lockstep.robot.touch(steady(push).lasting(10_000));
                lockstep.run(100);
                lockstep.cancel(id);
                let began = lockstep.now();
                let outcome = lockstep.until_resolved(id, 20_000);
                let took = lockstep.now() - began;
                let what = format!("{kind:?} {seed}, {push:?} N: {outcome:?} after {took} ms");
                println!("{what}");
                assert!(matches!(outcome, Err(MotionError::Stopped)), "{what}");
                assert!(took <= STEADY, "{what}");
            }
        }
    }
}

/// The longest time until a goal is resolved while hands undo its progress again and again, `[ms]`.
/// It contains a stall after some progress, and the time limit of an arm that does not settle.
const UNDONE: u64 = 30_000;

#[test]
fn a_goal_is_resolved_while_hands_push_the_arm_to_and_fro() {
    for kind in RobotKind::ALL {
        for seed in 0..arms() {
            for push in [(30.0, 250), (30.0, 400)] {
                let mut lockstep = realistic(kind, seed);
                let goal = lockstep.goal(aside(&lockstep), OnArrival::ReportAndFinish);
                let id = lockstep.submit(goal).expect("within reach");
                lockstep.run(700);
                lockstep.robot.touch(hands(push));
                let began = lockstep.now();
                let outcome = lockstep.until_resolved(id, 60_000);
                let took = lockstep.now() - began;
                let what = format!("{kind:?} {seed}, {push:?}: {outcome:?} after {took} ms");
                println!("{what}");
                let short = matches!(
                    outcome,
                    Err(MotionError::TargetNotReached(_) | MotionError::Braked(Lapse::Displaced))
                );
                assert!(short && took <= UNDONE, "{what}");
            }
        }
    }
}

/// At the wrist, 60 N on the lever of the hand exceed the torque limit of joint 6.
#[test]
fn a_hand_stronger_than_the_wrist_is_diagnosed_with_its_joint() {
    for kind in RobotKind::ALL {
        for seed in 0..arms() + 1 {
            let mut lockstep = realistic(kind, seed);
            let goal = lockstep.goal(aside(&lockstep), OnArrival::ReportAndFinish);
            let id = lockstep.submit(goal).expect("within reach");
            lockstep.run(700);
            let push = steady([-60.0, 0.0, 0.0]);
            lockstep.robot.touch(push.lasting(10_000));
            let error = lockstep.until_resolved(id, 20_000);
            let error = error.expect_err("the hand is stronger");
            let diagnosis = error.diagnose().expect("ended by the robot");
            let what = format!("{kind:?} {seed}: {diagnosis}");
            let of_wrist = |cause: &Cause| matches!(cause, Cause::Contact { subject, .. } if *subject == Subject::Joint(6));
            let wrist = diagnosis.causes.iter().any(of_wrist);
            assert!(wrist, "{what}");
            assert!(diagnosis.advice.contains(&Advice::GiveWay), "{what}");
            println!("{what}");
        }
    }
}
