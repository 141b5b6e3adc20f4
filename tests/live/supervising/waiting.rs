//! Motions that wait for their robot.

use std::future::IntoFuture;
use std::time::Duration;

use franka_async::error::Unready;
use franka_async::state::RobotMode;
use franka_async::supervision::Condition;
use franka_async::{Engage, MotionError, Robot};
use franka_sim::Sim;
use tokio::time::{sleep, timeout};

use super::{condition, policy, restart, start, supervised};
use crate::{SOON, alone};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn motions_wait_for_a_robot_and_begin_for_whoever_awaits_them_only() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy().motions_wait(SOON)).await;
    let q = robot.state().q;
    let target = |joint: usize| {
        let mut q = q;
        q[joint] += 0.05;
        q
    };
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let superseded = tokio::spawn(robot.move_joints(target(0)).into_future());
    until_waiting(&robot, &superseded).await;
    let stopped = tokio::spawn(robot.move_joints(target(1)).into_future());
    assert_eq!(superseded.await.unwrap(), Err(MotionError::Superseded));
    // Without a connection it is not known whether the arm rests.
    robot.stop().await.unwrap_err();
    assert_eq!(stopped.await.unwrap(), Err(MotionError::Stopped));
    // Dropped, detached, and cancelled.
    let dropped = tokio::spawn(robot.move_joints(target(2)).into_future());
    until_waiting(&robot, &dropped).await;
    dropped.abort();
    assert!(dropped.await.unwrap_err().is_cancelled());
    let motion = robot.move_joints(target(3));
    let handle = motion.handle();
    let cancelled = tokio::spawn(motion.into_future());
    until_waiting(&robot, &cancelled).await;
    handle.cancel();
    assert_eq!(cancelled.await.unwrap(), Err(MotionError::Stopped));
    robot.move_joints(target(4)).detach();

    let sim = restart(address).await;
    condition(&robot, Condition::Ready).await;
    crate::robot_time(&robot, 300).await;
    let state = sim.state().await.unwrap();
    assert_eq!(state.robot_mode, RobotMode::Idle);
    for (before, now) in q.iter().zip(state.q) {
        assert!((before - now).abs() < 1e-6, "nobody awaits a motion");
    }

    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let waiting = tokio::spawn(robot.move_joints(target(5)).into_future());
    until_waiting(&robot, &waiting).await;
    let sim = restart(address).await;
    let outcome = timeout(SOON, waiting).await.expect("no hang").unwrap();
    outcome.expect("it arrives");
    let moved = sim.state().await.unwrap().q[5] - q[5];
    assert!((moved - 0.05).abs() < 2e-3, "{moved}");

    // A session waits likewise.
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let engaging = tokio::spawn({
        let robot = robot.clone();
        async move { robot.engage(Engage::default()).await }
    });
    let sim = restart(address).await;
    let arm = timeout(SOON, engaging).await.expect("no hang").unwrap();
    let arm = arm.expect("the session begins");
    arm.disengage().await.expect("it ends");
    robot.shutdown().await;
    sim.stop().await;
}

/// Gives a motion of another task the time to be asked for; it is there to stay.
async fn until_waiting<T>(robot: &Robot, motion: &tokio::task::JoinHandle<T>) {
    for _ in 0..50 {
        tokio::task::yield_now().await;
        sleep(Duration::from_millis(1)).await;
    }
    assert!(!motion.is_finished(), "{:?}", robot.health().newest());
}
