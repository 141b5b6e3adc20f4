//! Sessions under the robot's own controller, and observers.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{turned, up};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::{JointVector, READY, RobotKind, Wrench};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::driver::Observer;
use franka_rt::lifecycle::{Engagement, MotionError, NewMotion, Tuning};
use franka_rt::session::{
    Backend, ForceCap, Free, Goal, GoalError, GoalId, Guard, Lead, OnArrival, Setpoints, Target,
};
use franka_sim::Config;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Runs `test` for every controller of the robot with every kind of setpoint, on both robots, with
/// a session under it.
fn for_each_controller(test: impl Fn(Backend, &mut Lockstep, GoalId)) {
    for_each_robot(|ready| {
        for backend in Backend::ROBOT_CONTROLLERS {
            println!("{backend}");
            let mut lockstep = ready();
            let engaged = lockstep.engage_with(Engagement {
                backend,
                ..Engagement::default()
            });
            test(backend, &mut lockstep, engaged);
        }
    });
}

#[test]
fn every_controller_follows_every_kind_of_goal_that_it_takes() {
    for_each_controller(|backend, lockstep, engaged| {
        let pose = up(lockstep, 0.05);
        let aside = Translation3::new(0.0, 0.05, -0.05) * pose;
        let joints = |by, pose: Isometry3<f64>| match backend.is_cartesian() {
            true => Target::Pose(pose),
            false => turned(by),
        };
        for target in [
            joints(0.2, aside),
            pose.into(),
            joints(-0.1, aside),
            pose.into(),
        ] {
            lockstep.within(engaged, target, OnArrival::Hold).unwrap();
            lockstep.run(350);
        }
        for target in [pose.into(), joints(0.0, aside), Target::Rest] {
            let goal = lockstep
                .within(engaged, target, OnArrival::ReportAndHold)
                .unwrap();
            lockstep.until_resolved(goal, 6000).unwrap();
        }
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}

#[test]
fn unsupported_target_is_refused_naming_a_supported_one() {
    for_each_controller(|backend, lockstep, engaged| {
        let refused = |got, expected| {
            Err(MotionError::Goal(GoalError::Backend {
                backend,
                got,
                expected,
            }))
        };
        let guide = lockstep.within(engaged, Target::Guide(Free::ALL), OnArrival::Hold);
        assert_eq!(guide, refused("hand guiding", "Backend::Torques"));
        let joints = lockstep.within(engaged, turned(0.0), OnArrival::ReportAndHold);
        let expected = "a pose, joint setpoints or Backend::Torques";
        match backend.is_cartesian() {
            true => {
                assert_eq!(joints, refused("joint positions as target", expected));
                let text = joints.unwrap_err().to_string();
                assert!(text.contains(&backend.to_string()), "{text}");
                let chunk = lockstep.chunk(engaged, super::chunk(0.0, 0.1));
                let chunk = chunk.map(|()| engaged);
                assert_eq!(chunk, refused("joint positions as target", expected));
            }
            false => assert!(joints.is_ok()),
        }
    });
}

#[test]
fn setpoints_with_elbow_move_joints_like_the_reference() {
    for_each_robot(|ready| {
        let cartesian = [Setpoints::CartesianPoses, Setpoints::CartesianVelocities];
        for (setpoints, lost) in cartesian
            .into_iter()
            .flat_map(|setpoints| [0, 1, 2, 5, 12].map(|lost| (setpoints, lost)))
        {
            let mut lockstep = ready();
            let engaged = lockstep.engage_with(Engagement {
                backend: Backend::cartesian_impedance(setpoints),
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
            assert!(off < 3e-7, "{setpoints}: {off} rad");
            lockstep.until_resolved(goal, 6000).unwrap();
        }
    });
}

#[test]
fn a_force_cap_that_the_robot_controller_cannot_keep_is_refused() {
    for_each_robot(|ready| {
        for backend in Backend::ROBOT_CONTROLLERS {
            let mut lockstep = ready();
            let refused = MotionError::Goal(GoalError::Backend {
                backend,
                got: "a force cap",
                expected: "the robot's own impedance settings, or Backend::Torques",
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
        for backend in [Backend::Torques]
            .into_iter()
            .chain(Backend::ROBOT_CONTROLLERS)
        {
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
fn setpoints_of_the_end_effector_are_refused_to_a_stretched_arm() {
    for kind in RobotKind::ALL {
        for backend in Backend::ROBOT_CONTROLLERS {
            let mut q = READY;
            q[3] = -0.3;
            let mut lockstep = Lockstep::new(Config {
                q,
                ..Lockstep::config_of(kind)
            });
            let begun = lockstep.try_engage(Engagement {
                backend,
                ..Engagement::default()
            });
            if !backend.is_cartesian() {
                assert!(begun.is_ok(), "{backend}");
                continue;
            }
            let refused = MotionError::Goal(GoalError::Backend {
                backend,
                got: "a start from a stretched arm, with joint 4 above -0.467 rad",
                expected: "joint setpoints or Backend::Torques",
            });
            assert_eq!(begun, Err(refused));
        }
    }
}

#[test]
fn setpoints_continue_from_the_robots_own_extrapolation() {
    for lost in [1, 2, 5, 12] {
        for_each_controller(|backend, lockstep, engaged| {
            let home = lockstep.arm_pose();
            let target = match backend.is_cartesian() {
                true => Target::Pose(Translation3::new(0.0, 0.15, 0.05) * home),
                false => turned(0.4),
            };
            let goal = lockstep
                .within(engaged, target, OnArrival::ReportAndHold)
                .unwrap();
            for _ in 0..4 {
                lockstep.run(200);
                lockstep.link.drop_commands(lost);
            }
            let report = lockstep.until_resolved(goal, 6000).unwrap();
            assert!(report.final_error.is_some(), "{backend}: {report:?}");
            let off = off_setpoint(lockstep, target);
            assert!(off < 1e-5, "{backend}, {lost}: {off}");
        });
    }
}

/// Distance of the robot's own setpoint from `target`, `[rad]` or `[m]`.
fn off_setpoint(lockstep: &Lockstep, target: Target) -> f64 {
    let q_d = JointVector::from(lockstep.client.state.q_d);
    match target {
        Target::Joints(q) => (q_d - JointVector::from(q)).amax(),
        Target::Pose(pose) => {
            let off = lockstep.pose_at(&q_d).translation.vector - pose.translation.vector;
            off.norm()
        }
        other => unreachable!("{other:?} is no place"),
    }
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
