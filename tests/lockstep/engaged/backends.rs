//! Sessions whose setpoints the robot's own controller takes, and observers.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{turned, up};
use franka_model::{READY, RobotKind};
use franka_rt::driver::Observer;
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{Backend, Free, GoalError, Setpoints, Target, Then};
use franka_sim::Config;
use franka_tests::lockstep::{Lockstep, for_each_robot};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

#[test]
fn the_robot_controller_takes_joints_through_every_kind_of_goal() {
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
            lockstep.within(engaged, target, Then::Hold).unwrap();
            lockstep.run(350);
        }
        for target in [Target::Pose(pose), turned(0.0), Target::Rest] {
            let goal = lockstep.within(engaged, target, Then::Stay).unwrap();
            lockstep.until_resolved(goal, 6000).unwrap();
        }
        let guide = lockstep.within(engaged, Target::Guide(Free::ALL), Then::Hold);
        let refused = MotionError::Goal(GoalError::Backend {
            why: "takes no guiding hand",
        });
        assert_eq!(guide, Err(refused));
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}

#[test]
fn the_robot_controller_takes_poses() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage_with(Engagement {
            backend: Backend::RobotController(Setpoints::Poses),
            ..Engagement::default()
        });
        let pose = up(&lockstep, 0.05);
        let goal = lockstep
            .within(engaged, Target::Pose(pose), Then::Stay)
            .unwrap();
        lockstep.run(500);
        assert_eq!(lockstep.client.outcome(goal), None);
        let back = Translation3::new(0.0, 0.05, -0.05) * pose;
        let goal = lockstep
            .within(engaged, Target::Pose(back), Then::Stay)
            .unwrap();
        lockstep.until_resolved(goal, 6000).unwrap();
        let joints = lockstep.within(engaged, turned(0.0), Then::Stay);
        assert!(matches!(
            joints,
            Err(MotionError::Goal(GoalError::Backend { .. }))
        ));
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}

#[test]
fn poses_with_their_elbow_move_the_joints_of_the_robot_as_the_reference() {
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
            let goal = lockstep.within(engaged, goal, Then::Stay).unwrap();
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
            // What a robot's state is rounded by.
            assert!(off < 3e-7, "{off} rad");
            lockstep.until_resolved(goal, 6000).unwrap();
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
        let goal = lockstep.goal(Target::Rest, Then::Hold);
        let engagement = Engagement {
            backend: Backend::RobotController(Setpoints::Poses),
            ..Engagement::default()
        };
        let client = &mut lockstep.client;
        let begun = client
            .lifecycle
            .engage(goal, engagement, &client.state, client.now);
        let refused = MotionError::Goal(GoalError::Backend {
            why: "takes no stretched arm",
        });
        assert_eq!(begun, Err(refused));
    }
}

#[test]
fn a_setpoint_goes_on_from_where_the_robot_went_without_commands() {
    for_each_robot(|ready| {
        for lost in [1, 2, 5, 12] {
            let mut lockstep = ready();
            let engaged = lockstep.engage_with(Engagement {
                backend: Backend::RobotController(Setpoints::Joints),
                ..Engagement::default()
            });
            let goal = lockstep.within(engaged, turned(0.4), Then::Stay).unwrap();
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
fn an_observer_sees_every_cycle_and_its_panic_is_its_own() {
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
        let goal = lockstep.within(engaged, turned(0.1), Then::Stay).unwrap();
        lockstep.until_resolved(goal, 5000).unwrap();
    });
}
