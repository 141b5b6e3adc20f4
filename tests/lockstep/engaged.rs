//! Sessions that go from goal to goal.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_model::collision::Obstacle;
use franka_model::{READY, Wrench};
use franka_rt::driver::Observer;
use franka_rt::law::{Gains, Law};
use franka_rt::lifecycle::{Engagement, MotionError, Tuning};
use franka_rt::session::{
    Backend, Chunk, Deadman, Free, Goal, GoalError, GoalId, Guard, Lapse, PoseError, Setpoints,
    Stale, Target, Then, Watchdog,
};
use franka_tests::lockstep::{Lockstep, for_each_robot};
use nalgebra::{Isometry3, Translation3};

fn up(lockstep: &Lockstep, metres: f64) -> Isometry3<f64> {
    Translation3::new(0.0, 0.0, metres) * lockstep.true_pose()
}

fn turned(by: f64) -> Target {
    let mut q = READY;
    q[0] += by;
    Target::Joints(q.into())
}

fn assert_stays(lockstep: &mut Lockstep, engaged: GoalId) {
    let before = lockstep.true_pose();
    lockstep.run(500);
    let moved = PoseError::between(&lockstep.true_pose(), &before);
    assert!(moved.translation < 1e-3, "{moved:?}");
    assert_eq!(lockstep.client.outcome(engaged), None, "it goes on");
}

#[test]
fn goals_come_to_their_ends_and_the_session_goes_on_until_it_is_ended() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let pose = up(&lockstep, 0.05);
        for target in [Target::Pose(pose), turned(0.1), Target::Rest] {
            let goal = lockstep.within(engaged, target, Then::Stay).unwrap();
            let report = lockstep.until_resolved(goal, 6000).unwrap();
            assert_eq!(report.final_error.is_none(), target == Target::Rest);
            assert_stays(&mut lockstep, engaged);
        }
        lockstep.disengage(engaged);
        // A motion that comes meanwhile waits for the session to end.
        let next = lockstep.begin(turned(0.05));
        lockstep.until_resolved(engaged, 1000).unwrap();
        lockstep.until_resolved(next, 6000).unwrap();
        assert!(lockstep.client.lifecycle.is_idle());
        let late = lockstep.within(engaged, turned(0.0), Then::Stay);
        assert_eq!(late, Err(MotionError::Disengaged));
    });
}

#[test]
fn a_goal_of_another_kind_takes_over_in_mid_motion() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let pose = up(&lockstep, 0.1);
        let mut before = None;
        for target in [
            Target::Pose(pose),
            turned(0.3),
            Target::Pose(pose),
            turned(0.0),
        ] {
            let goal = lockstep.within(engaged, target, Then::Stay).unwrap();
            if let Some(before) = before.replace(goal) {
                let superseded = lockstep.until_resolved(before, 1);
                assert_eq!(superseded, Err(MotionError::Superseded));
            }
            lockstep.run(400);
        }
        let last = before.expect("there were goals");
        lockstep.until_resolved(last, 6000).unwrap();
        assert_stays(&mut lockstep, engaged);
    });
}

#[test]
fn nobody_else_gets_the_arm_meanwhile_but_anybody_can_stop_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep.goal(turned(0.1), Then::Finish);
        assert_eq!(lockstep.submit(goal), Err(MotionError::Busy));
        let goal = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        lockstep.run(300);
        let stop = lockstep.stop().expect("it moves");
        lockstep.until_resolved(stop, 2000).unwrap();
        for ended in [goal, engaged] {
            let outcome = lockstep.until_resolved(ended, 1);
            assert_eq!(outcome, Err(MotionError::Stopped));
        }
        let late = lockstep.within(engaged, turned(0.0), Then::Stay);
        assert_eq!(late, Err(MotionError::Stopped));
    });
}

#[test]
fn a_goal_that_is_taken_back_leaves_the_arm_held() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        lockstep.run(300);
        lockstep.cancel(goal);
        let outcome = lockstep.until_resolved(goal, 2000);
        assert_eq!(outcome, Err(MotionError::Stopped));
        assert_stays(&mut lockstep, engaged);
        // Dropping the session itself lets the arm go.
        lockstep.cancel(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}

#[test]
fn a_reflex_is_what_every_goal_hears_that_comes_after_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        lockstep.run(300);
        lockstep.robot.press_user_stop(true);
        let outcome = lockstep.until_resolved(goal, 2000);
        let Err(MotionError::Control(error)) = &outcome else {
            panic!("{outcome:?}");
        };
        assert_eq!(lockstep.until_resolved(engaged, 1), outcome);
        let late = lockstep.within(engaged, turned(0.0), Then::Stay);
        assert_eq!(late, Err(MotionError::Control(error.clone())));
    });
}

#[test]
fn a_goal_that_comes_while_the_session_is_ending_hears_how_it_ended() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        lockstep.robot.press_user_stop(true);
        let mut late = Vec::new();
        while lockstep.client.outcome(engaged).is_none() {
            lockstep.tick();
            late.extend(lockstep.within(engaged, turned(0.1), Then::Stay));
        }
        let outcome = lockstep.until_resolved(engaged, 1);
        assert!(matches!(outcome, Err(MotionError::Control(_))));
        for (i, goal) in late.iter().enumerate() {
            let heard = lockstep.until_resolved(*goal, 1);
            let superseded = heard == Err(MotionError::Superseded);
            assert!(superseded || heard == outcome, "{i}: {heard:?}");
        }
    });
}

/// A session that follows a stream which falls silent, and how that ends.
fn silent_stream(ready: &dyn Fn() -> Lockstep, stale: Stale) -> (Lockstep, GoalId, MotionError) {
    let mut lockstep = ready();
    let engaged = lockstep.engage();
    let goal = Goal {
        watchdog: Some(Watchdog {
            silence: Duration::from_millis(100),
            stale,
            then: Then::Stay,
        }),
        ..lockstep.goal(turned(0.01), Then::Hold)
    };
    let goal = lockstep.submit_within(engaged, goal).unwrap();
    for step in 2..12 {
        lockstep.run(90);
        assert_eq!(lockstep.client.outcome(goal), None);
        let taken = lockstep.update(goal, turned(0.06 * f64::from(step)));
        assert_eq!(taken, Ok(true));
    }
    let error = lockstep.until_resolved(goal, 5000).unwrap_err();
    assert!(lockstep.client.record.bindings.contains(Guard::Watchdog));
    assert_eq!(lockstep.update(goal, turned(0.0)), Ok(false));
    (lockstep, engaged, error)
}

#[test]
fn a_stream_that_falls_silent_is_held_or_braked_and_the_outcome_says_which() {
    for_each_robot(|ready| {
        let silence = Duration::from_millis(100);
        let lapse = Lapse::Silent { silence };
        let last = READY[0] + 0.66;

        let (mut lockstep, engaged, error) = silent_stream(ready, Stale::Hold);
        assert_eq!(error, MotionError::Held(lapse));
        assert!(
            (lockstep.robot.q()[0] - last).abs() < 2e-3,
            "at the last target"
        );
        assert_stays(&mut lockstep, engaged);

        let (mut lockstep, engaged, error) = silent_stream(ready, Stale::Brake);
        assert_eq!(error, MotionError::Braked(lapse));
        assert!((lockstep.robot.q()[0] - last).abs() > 0.02, "short of it");
        assert_stays(&mut lockstep, engaged);
        // The session is as good as before.
        let goal = lockstep.within(engaged, turned(0.0), Then::Stay).unwrap();
        lockstep.until_resolved(goal, 5000).unwrap();
    });
}

#[test]
fn a_silent_deadman_holds_the_arm_until_it_lives_again() {
    for_each_robot(|ready| {
        let (token, grip) = Deadman::new(Duration::from_millis(50));
        let mut lockstep = ready();
        let engaged = lockstep.engage_with(Engagement {
            deadman: Some(grip),
            ..Engagement::default()
        });
        let goal = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        for _ in 0..10 {
            lockstep.run(40);
            token.keep_alive();
        }
        let held = Err(MotionError::Held(Lapse::Deadman));
        assert_eq!(lockstep.until_resolved(goal, 1000), held);
        assert!(lockstep.client.record.bindings.contains(Guard::Deadman));
        assert!(lockstep.robot.q()[0] < READY[0] + 0.25, "short of the goal");
        let another = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        assert_eq!(lockstep.until_resolved(another, 1000), held);
        assert_stays(&mut lockstep, engaged);

        let goal = lockstep.within(engaged, turned(0.3), Then::Stay).unwrap();
        for _ in 0..200 {
            token.keep_alive();
            lockstep.run(20);
        }
        lockstep.until_resolved(goal, 1).unwrap();

        drop(token);
        let goal = lockstep.within(engaged, turned(0.0), Then::Stay).unwrap();
        assert_eq!(lockstep.until_resolved(goal, 1000), held);
    });
}

#[test]
fn a_hand_guides_the_arm_along_the_axes_that_are_free() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let free = Free {
            axes: [false, true, false, false, false, false],
            elbow: false,
        };
        lockstep
            .within(engaged, Target::Guide(free), Then::Hold)
            .unwrap();
        lockstep.run(400);
        let start = lockstep.true_pose();
        let push = Wrench::new(4.0, 4.0, 4.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(push, 1500);
        lockstep.run(1500);
        let moved = lockstep.true_pose().translation.vector - start.translation.vector;
        assert!(moved.y > 0.05, "{moved}");
        assert!(moved.x.abs() < 0.01 && moved.z.abs() < 0.01, "{moved}");
        let turned = PoseError::between(&lockstep.true_pose(), &start).rotation;
        assert!(turned < 0.05, "{turned} rad");
        // Taken over while the hand still moves it.
        let hold = lockstep.within(engaged, Target::Rest, Then::Stay).unwrap();
        lockstep.until_resolved(hold, 5000).unwrap();
        assert_stays(&mut lockstep, engaged);
    });
}

#[test]
fn gains_are_tuned_without_a_step_and_only_within_their_bounds() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let push = Wrench::new(0.0, 0.0, -6.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(push, 100_000);
        lockstep.run(1500);
        let before = lockstep.true_pose();
        let soft =
            Gains::cartesian().with_cartesian_stiffness([300.0, 300.0, 300.0, 15.0, 15.0, 15.0]);
        let gains = Some(soft);
        lockstep
            .tune(
                engaged,
                Tuning {
                    gains,
                    ..Tuning::default()
                },
            )
            .unwrap();
        let mut last = lockstep.client.record.tau_c;
        let mut step: f64 = 0.0;
        for _ in 0..1500 {
            lockstep.tick();
            let tau = lockstep.client.record.tau_c;
            for (now, last) in tau.iter().zip(last) {
                step = step.max((now - last).abs());
            }
            last = tau;
        }
        assert!(step < 0.1, "a step of {step} N m");
        let sunk = before.translation.z - lockstep.true_pose().translation.z;
        assert!(sunk > 0.004, "{sunk} m");
        let mut hard = soft;
        hard.cartesian_stiffness[0] = 1e5;
        let gains = Some(hard);
        let refused = lockstep.tune(
            engaged,
            Tuning {
                gains,
                ..Tuning::default()
            },
        );
        assert!(matches!(
            refused,
            Err(MotionError::Goal(GoalError::Gains(_)))
        ));
    });
}

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

/// A policy that predicts a sine of joint 1 at 10 Hz, from observations that are 150 ms old: 16 points, 50 ms apart.
#[test]
fn chunks_of_a_slow_policy_become_one_smooth_motion() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let begin = lockstep.client.state.message_id;
        let sine = |time: f64| 0.05 * (1.0 - (2.0 * time).cos());
        let predicted = |time: f64| {
            let mut q = <[f64; 7]>::from(READY);
            q[0] += sine(time);
            q
        };
        let mut worst: f64 = 0.0;
        for call in 0..60 {
            let now = lockstep.client.state.message_id;
            let observed = now.saturating_sub(150).max(begin);
            let since = (observed - begin) as f64 * 1e-3;
            let points = (0..16).map(|i| {
                let offset = Duration::from_millis(50 * i);
                (offset, predicted(since + offset.as_secs_f64()))
            });
            let chunk = Chunk::joints(points).unwrap().observed_at(observed);
            lockstep.chunk(engaged, chunk).unwrap();
            for _ in 0..100 {
                lockstep.tick();
                let time = (lockstep.client.record.time - begin) as f64 * 1e-3;
                if call >= 10 {
                    worst = worst.max((lockstep.robot.q()[0] - READY[0] - sine(time)).abs());
                }
            }
        }
        println!("off by {worst} rad at most");
        assert!(worst < 4e-3, "{worst} rad");
        // A pose takes over from the last chunk.
        let pose = up(&lockstep, 0.05);
        let goal = lockstep
            .within(engaged, Target::Pose(pose), Then::Stay)
            .unwrap();
        lockstep.until_resolved(goal, 6000).unwrap();
        let stale = Chunk::joints([(Duration::ZERO, predicted(0.0))]).unwrap();
        let late = lockstep.chunk(engaged, stale.observed_at(begin));
        assert!(
            matches!(late, Err(MotionError::Goal(GoalError::Late { .. }))),
            "{late:?}"
        );
    });
}

#[test]
fn a_force_cap_is_tuned_within_its_bounds() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let cap = |newtons| Tuning {
            force_cap: Some(newtons),
            ..Tuning::default()
        };
        for refused in [4.9, 201.0, f64::NAN] {
            let outcome = lockstep.tune(engaged, cap(Some(refused)));
            assert!(
                matches!(outcome, Err(MotionError::Goal(GoalError::ForceCap { .. }))),
                "{outcome:?}"
            );
        }
        // 12 N of push hold against the default cap, and not against one of 8 N, until it is taken away.
        lockstep
            .robot
            .push_end_effector(Wrench::new(0.0, 12.0, 0.0, 0.0, 0.0, 0.0), 1_000_000);
        let bound = |lockstep: &mut Lockstep| {
            lockstep.run(600);
            lockstep.client.record.bindings.contains(Guard::ForceCap)
        };
        assert!(!bound(&mut lockstep));
        lockstep.tune(engaged, cap(Some(8.0))).unwrap();
        assert!(bound(&mut lockstep));
        lockstep.tune(engaged, cap(None)).unwrap();
        assert!(!bound(&mut lockstep));
    });
}

#[test]
fn a_session_keeps_out_of_its_regions_and_refuses_what_is_none() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let floor = Obstacle::floor(lockstep.true_pose().translation.z - 0.1);
        let engaged = lockstep.engage_with(Engagement {
            keep_out: Some(vec![floor]),
            ..Engagement::default()
        });
        let down = up(&lockstep, -0.2);
        let goal = lockstep
            .within(engaged, Target::Pose(down), Then::Stay)
            .unwrap();
        let outcome = lockstep.until_resolved(goal, 20_000);
        assert_eq!(outcome, Err(MotionError::Braked(Lapse::Blocked)));
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
        for regions in [vec![floor; 5], vec![Obstacle::floor(f64::NAN)]] {
            let engagement = Engagement {
                keep_out: Some(regions),
                ..Engagement::default()
            };
            let goal = lockstep.goal(Target::Rest, Then::Hold);
            let client = &mut lockstep.client;
            let (state, now) = (&client.state, client.now);
            let refused = client.lifecycle.engage(goal, engagement, state, now);
            assert!(
                matches!(refused, Err(MotionError::Goal(GoalError::KeepOut { .. }))),
                "{refused:?}"
            );
        }
    });
}

#[test]
fn gains_that_would_not_hold_the_arm_are_refused() {
    let mut lockstep = Lockstep::ready();
    for gains in [
        Gains {
            law: Law::OperationalSpace,
            ..Gains::joint()
        },
        Gains {
            project_joint_gains: true,
            ..Gains::joint()
        },
    ] {
        let goal = lockstep.goal(turned(0.1), Then::Finish);
        let refused = lockstep.submit(Goal { gains, ..goal });
        assert_eq!(refused, Err(MotionError::Goal(GoalError::Unheld)));
    }
}
