//! Futures dropped at any of their polls, and more of them at once than a program would.

use std::pin::pin;
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use franka_async::control::JointPositions;
use franka_async::settings::CollisionBehavior;
use franka_async::state::{RobotMode, RobotState};
use franka_async::{MotionError, Pose};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};
use tokio::sync::watch;
use tokio::task::JoinSet;
use tokio::time::timeout;

use crate::{SOON, alone, connect, long_way, simulated, under_way};

/// Polls a future `polls` times, up to `pause` apart, from a thread without a runtime, and drops
/// it.
fn poll_and_drop<F: Future + Send>(future: F, polls: u32, pause: Duration, random: &mut SmallRng) {
    let pauses: Vec<Duration> = (0..polls)
        .map(|_| pause.mul_f64(random.random::<f64>()))
        .collect();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut future = pin!(future);
            let mut context = Context::from_waker(Waker::noop());
            for pause in pauses {
                if future.as_mut().poll(&mut context).is_ready() {
                    return;
                }
                std::thread::sleep(pause);
            }
        });
    });
}

#[tokio::test(flavor = "multi_thread")]
async fn a_future_may_be_dropped_at_any_poll() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let seed = 7;
    let mut random = SmallRng::seed_from_u64(seed);
    let (_sender, targets) = watch::channel(robot.pose());
    for round in 0..24 {
        let polls = random.random_range(0..4);
        let pause = Duration::from_millis([0, 3, 60][round % 3]);
        let random = &mut random;
        match round % 6 {
            0 | 1 => poll_and_drop(long_way(&robot).into_future(), polls, pause, random),
            2 => poll_and_drop(
                robot.follow(targets.clone()).into_future(),
                polls,
                pause,
                random,
            ),
            3 => poll_and_drop(robot.stop(), polls, pause, random),
            4 => poll_and_drop(robot.set_joint_impedance([3000.0; 7]), polls, pause, random),
            _ => poll_and_drop(
                robot.move_joints(robot.state().q).into_future(),
                polls,
                pause,
                random,
            ),
        }
    }
    // In every case the arm can be stopped, moves again, and accepts parameters.
    let done = timeout(SOON, async {
        robot.stop().await.unwrap();
        assert!(!robot.state().motion_running());
        robot
            .move_to(Pose::translation(0.0, 0.0, 0.01) * robot.pose())
            .await
            .unwrap();
        robot.set_joint_impedance([3000.0; 7]).await.unwrap();
        robot.shutdown().await;
    });
    done.await.unwrap_or_else(|_| panic!("hangs, seed {seed}"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_hundred_motions_at_once_all_resolve() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let mut motions = JoinSet::new();
    for i in 0..100 {
        let target = Pose::translation(0.0, 0.0, 0.001 * f64::from(i)) * start;
        let motion = robot.move_to(target).into_future();
        motions.spawn(async move { (target, motion.await) });
    }
    // A worker may begin its motion after another one has arrived: the last of them counts.
    let mut last = None;
    while let Some(motion) = timeout(SOON, motions.join_next()).await.expect("no hang") {
        match motion.unwrap() {
            (target, Ok(_)) => last = Some(target),
            (_, Err(error)) => assert_eq!(error, MotionError::Superseded),
        }
    }
    let target = last.expect("one arrives");
    let off = (robot.pose().translation.vector - target.translation.vector).norm();
    assert!(
        off < 0.0005,
        "{off} m from the target of the motion that arrived last"
    );
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn handles_of_a_motion_do_not_keep_its_robot() {
    let _alone = alone();
    for is_program in [false, true] {
        let (robot, sim) = simulated().await;
        let (handle, canceller) = match is_program {
            false => {
                let motion = long_way(&robot);
                let handle = motion.handle();
                motion.detach();
                (Some(handle), None)
            }
            true => {
                let hold = |state: &RobotState, _| JointPositions(state.q_d);
                let control = robot.control_joint_positions(hold);
                let canceller = control.canceller();
                control.detach();
                (None, Some(canceller))
            }
        };
        under_way(&robot).await;
        drop(robot);
        let gone = async {
            while sim.with(|robot| robot.is_connected()).await.unwrap() {
                tokio::task::yield_now().await;
            }
        };
        timeout(SOON, gone).await.expect("the connection closes");
        let state = sim.state().await.unwrap();
        assert_eq!(state.robot_mode, RobotMode::Idle, "{is_program}");
        assert!(state.dq.iter().all(|dq| dq.abs() < 0.01), "{:?}", state.dq);
        // Without effect now.
        if let Some(handle) = handle {
            assert_eq!(handle.progress(), None);
            handle.pause();
            handle.cancel();
        }
        if let Some(canceller) = canceller {
            canceller.cancel();
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn clones_of_a_motion_are_motions_of_their_own() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let motion = long_way(&robot);
    let other = motion.clone();
    let handle = motion.handle();
    let first = tokio::spawn(motion.into_future());
    under_way(&robot).await;
    let second = tokio::spawn(other.speed(0.5).into_future());
    assert_eq!(first.await.unwrap(), Err(MotionError::Superseded));
    handle.cancel();
    second.await.unwrap().unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn parameters_from_many_tasks_at_once_are_all_answered() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let mut calls = JoinSet::new();
    for i in 0..100_u32 {
        let robot = robot.clone();
        calls.spawn(async move {
            match i % 3 {
                0 => robot.set_joint_impedance([3000.0; 7]).await,
                1 => robot.set_k(Pose::identity()).await,
                _ => {
                    let behavior =
                        CollisionBehavior::uniform([30.0; 7], [40.0; 7], [40.0; 6], [50.0; 6]);
                    robot.set_collision_behavior(behavior).await
                }
            }
        });
    }
    while let Some(call) = timeout(SOON, calls.join_next()).await.expect("no hang") {
        call.unwrap().unwrap();
    }
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_connection_given_up_at_any_poll_leaves_the_robot_free() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    robot.shutdown().await;
    for micros in [0, 200, 1000, 3000, 8000] {
        let builder = franka_async::Robot::builder(sim.addr());
        let connecting = builder.realtime(franka_async::Realtime::Ignore).connect();
        // Either outcome is fine, and in both the robot is dropped.
        let _ = timeout(Duration::from_micros(micros), connecting).await;
    }
    let gone = async {
        while sim.with(|robot| robot.is_connected()).await.unwrap() {
            tokio::task::yield_now().await;
        }
    };
    timeout(SOON, gone).await.expect("the robot is free");
    connect(&sim).await.shutdown().await;
}

#[test]
fn polling_a_resolved_motion_panics_as_documented() {
    let _alone = alone();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    let (robot, sim) = runtime.block_on(simulated());
    let mut moving = robot.move_to(Pose::identity()).into_future();
    let error = runtime.block_on(&mut moving).unwrap_err();
    assert!(matches!(error, MotionError::Goal(_)), "{error:?}");
    let again = std::panic::AssertUnwindSafe(|| {
        let mut context = Context::from_waker(Waker::noop());
        matches!(pin!(&mut moving).poll(&mut context), Poll::Pending)
    });
    assert!(std::panic::catch_unwind(again).is_err());
    runtime.block_on(async {
        robot.shutdown().await;
        sim.stop().await;
    });
}
