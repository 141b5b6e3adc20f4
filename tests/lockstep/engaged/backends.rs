//! Sessions under the robot's own controller, and observers.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{turned, up};
use franka_model::{READY, RobotKind, Wrench};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::driver::Observer;
use franka_rt::lifecycle::{Engagement, MotionError, NewMotion, Tuning};
use franka_rt::session::{
    Backend, ForceCap, Free, Goal, GoalError, Guard, Lead, OnArrival, Setpoints, Target,
};
use franka_sim::Config;
use franka_tests::lockstep::{Lockstep, for_each_robot};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

#[test]
fn the_robot_controller_follows_joints_through_every_kind_of_goal() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage_with(Engagement {
            backend: Backend::RobotController(Setpoints::Joints),
            ..Engagement::default()
        });
        let pose = up(&lockstep, 0.05);
        for target in [
            turned(0.2),
            Target::Pose(pose),
            turned(-0.1),
            Target::Pose(pose),
        ] {
            lockstep.within(engaged, target, OnArrival::Hold).unwrap();
            lockstep.run(350);
        }
        for target in [Target::Pose(pose), turned(0.0), Target::Rest] {
            let goal = lockstep
                .within(engaged, target, OnArrival::ReportAndHold)
                .unwrap();
            lockstep.until_resolved(goal, 6000).unwrap();
        }
        let guide = lockstep.within(engaged, Target::Guide(Free::ALL), OnArrival::Hold);
        let refused = MotionError::Goal(GoalError::Backend {
            why: "takes no guiding hand",
        });
        assert_eq!(guide, Err(refused));
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}

#[test]
fn the_robot_controller_follows_poses() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage_with(Engagement {
            backend: Backend::RobotController(Setpoints::Poses),
            ..Engagement::default()
        });
        let pose = up(&lockstep, 0.05);
        let goal = lockstep
            .within(engaged, Target::Pose(pose), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.run(500);
        assert_eq!(lockstep.client.outcome(goal), None);
        let back = Translation3::new(0.0, 0.05, -0.05) * pose;
        let goal = lockstep
            .within(engaged, Target::Pose(back), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.until_resolved(goal, 6000).unwrap();
        let joints = lockstep.within(engaged, turned(0.0), OnArrival::ReportAndHold);
        assert!(matches!(
            joints,
            Err(MotionError::Goal(GoalError::Backend { .. }))
        ));
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}

#[test]
fn poses_with_an_elbow_move_the_robots_joints_like_the_reference() {
    for_each_robot(|ready| {
        for lost in [0, 1, 2, 5, 12] {
            let mut lockstep = ready();
            let engaged = lockstep.engage_with(Engagement {
                backend: Backend::RobotController(Setpoints::Poses),
                ..Engagement::default()
            });
            let aside = Translation3::new(0.0, 0.1, 0.05) * up(&lockstep, 0.05);
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.2, -0.1, 0.3));
            let goal = Target::Pose(aside * turn);
            let goal = lockstep
                .within(engaged, goal, OnArrival::ReportAndHold)
                .unwrap();
            let (mut sent, mut off) = ([0.0; 7], 0.0_f64);
            for cycle in 0..900 {
                if cycle % 200 == 150 {
                    lockstep.link.drop_commands(lost);
                }
                lockstep.tick();
                if cycle > 0 && lost == 0 {
                    let q_d = lockstep.client.state.q_d;
                    let apart = (0..7).map(|i| (q_d[i] - sent[i]).abs());
                    off = apart.fold(off, f64::max);
                }
                sent = lockstep.client.record.q_ref;
            }
            // The rounding of a robot's state.
            assert!(off < 3e-7, "{off} rad");
            lockstep.until_resolved(goal, 6000).unwrap();
        }
    });
}

/// The robot's controller with each kind of setpoint.
const CONTROLLERS: [Backend; 2] = [
    Backend::RobotController(Setpoints::Joints),
    Backend::RobotController(Setpoints::Poses),
];

#[test]
fn a_force_cap_that_the_robot_controller_cannot_keep_is_refused() {
    for_each_robot(|ready| {
        for backend in CONTROLLERS {
            let mut lockstep = ready();
            let refused = MotionError::Goal(GoalError::Backend {
                why: "keeps no force cap: its stiffness is set on the robot",
            });
            let capped = Goal {
                force_cap: ForceCap::Newtons(20.0),
                ..lockstep.goal(Target::Rest, OnArrival::Hold)
            };
            let engagement = Engagement {
                backend,
                ..Engagement::default()
            };
            let begun = lockstep.client.begin(NewMotion::Session {
                goal: Box::new(capped),
                engagement,
            });
            assert_eq!(begun, Err(refused.clone()));

            let engaged = lockstep.engage_with(Engagement {
                backend,
                ..Engagement::default()
            });
            let up = up(&lockstep, 0.05).into();
            let capped = Goal {
                force_cap: ForceCap::Newtons(20.0),
                ..lockstep.goal(up, OnArrival::ReportAndHold)
            };
            let submitted = lockstep.submit_within(engaged, capped);
            assert_eq!(submitted, Err(refused.clone()));
            let tuning = Tuning {
                force_cap: Some(ForceCap::Newtons(20.0)),
                ..Tuning::default()
            };
            assert_eq!(lockstep.tune(engaged, tuning), Err(refused));
            let goal = lockstep
                .within(engaged, up, OnArrival::ReportAndHold)
                .unwrap();
            lockstep
                .until_resolved(goal, 6000)
                .expect("nothing of it was taken");
        }
    });
}

/// During the motion the arm is pushed, hard enough for the force cap, the leash and the deviation
/// guard of the session's own law to bind.
#[test]
fn only_guards_of_the_backend_bind_when_the_arm_is_pushed() {
    for_each_robot(|ready| {
        for backend in [Backend::Torques].into_iter().chain(CONTROLLERS) {
            let mut lockstep = ready();
            let most =
                CollisionBehavior::uniform([1000.0; 7], [1000.0; 7], [1000.0; 6], [1000.0; 6]);
            lockstep.request(&Request::SetCollisionBehavior(most));
            lockstep.run(5);
            let engaged = lockstep.engage_with(Engagement {
                backend,
                ..Engagement::default()
            });
            let aside = Translation3::new(0.0, 0.1, 0.0) * up(&lockstep, 0.0);
            let goal = Goal {
                lead: Some(Lead {
                    translation: 0.05,
                    rotation: 0.2,
                    joints: 0.1,
                }),
                ..lockstep.goal(aside.into(), OnArrival::Hold)
            };
            lockstep.submit_within(engaged, goal).unwrap();
            let push = Wrench::new(0.0, -60.0, 0.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(push, 800);
            let mut bound = HashSet::new();
            for _ in 0..1000 {
                lockstep.tick();
                bound.extend(lockstep.client.record.bindings.iter());
            }
            let foreign = bound.iter().find(|guard| !backend.has(**guard));
            assert_eq!(foreign, None, "{backend:?}");
            assert!(bound.contains(&Guard::Lead), "{backend:?}: {bound:?}");
            let own = [Guard::ForceCap, Guard::Leash];
            let binds = own.map(|guard| bound.contains(&guard));
            assert_eq!(binds, own.map(|guard| backend.has(guard)), "{backend:?}");
        }
    });
}

#[test]
fn poses_are_refused_to_a_stretched_arm() {
    for kind in RobotKind::ALL {
        let mut q = READY;
        q[3] = -0.3;
        let mut lockstep = Lockstep::new(Config {
            q,
            ..Lockstep::config_of(kind)
        });
        let goal = lockstep.goal(Target::Rest, OnArrival::Hold);
        let engagement = Engagement {
            backend: Backend::RobotController(Setpoints::Poses),
            ..Engagement::default()
        };
        let begun = lockstep.client.begin(NewMotion::Session {
            goal: Box::new(goal),
            engagement,
        });
        let refused = MotionError::Goal(GoalError::Backend {
            why: "takes no stretched arm",
        });
        assert_eq!(begun, Err(refused));
    }
}

#[test]
fn setpoints_continue_from_the_robots_own_extrapolation() {
    for_each_robot(|ready| {
        for lost in [1, 2, 5, 12] {
            let mut lockstep = ready();
            let engaged = lockstep.engage_with(Engagement {
                backend: Backend::RobotController(Setpoints::Joints),
                ..Engagement::default()
            });
            let goal = lockstep
                .within(engaged, turned(0.4), OnArrival::ReportAndHold)
                .unwrap();
            for _ in 0..4 {
                lockstep.run(200);
                lockstep.link.drop_commands(lost);
            }
            lockstep.until_resolved(goal, 6000).unwrap();
            assert!((lockstep.robot.q()[0] - READY[0] - 0.4).abs() < 1e-3);
        }
    });
}

#[test]
fn an_observer_sees_every_cycle_and_its_panic_ends_nothing_else() {
    for_each_robot(|ready| {
        let (seen, cycles) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
        let mut lockstep = ready();
        let count = seen.clone();
        let newest = cycles.clone();
        let engaged = lockstep.engage_with(Engagement {
            observer: Some(Observer::new(move |record, state| {
                assert!(count.fetch_add(1, Ordering::Relaxed) < 2000, "enough");
                assert_eq!(record.time, state.message_id);
                newest.store(record.time, Ordering::Relaxed);
            })),
            ..Engagement::default()
        });
        let (before, time) = (seen.load(Ordering::Relaxed), lockstep.client.record.time);
        lockstep.run(500);
        assert_eq!(seen.load(Ordering::Relaxed) - before, 500);
        assert_eq!(cycles.load(Ordering::Relaxed), time + 500);
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(|_| {}));
        lockstep.run(2000);
        std::panic::set_hook(hook);
        assert_eq!(seen.load(Ordering::Relaxed), 2001);
        let goal = lockstep
            .within(engaged, turned(0.1), OnArrival::ReportAndHold)
            .unwrap();
        lockstep.until_resolved(goal, 5000).unwrap();
    });
}
