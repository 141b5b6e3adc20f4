//! Motions that wait for their robot.

use std::fmt::Debug;
use std::future::{IntoFuture as _, poll_fn};
use std::pin::Pin;
use std::task::Poll;

use franka_async::error::{GoalError, Unready};
use franka_async::state::RobotMode;
use franka_async::supervision::Condition;
use franka_async::{Engage, Motion, MotionError, MotionReport, Pose};
use franka_sim::Sim;
use tokio::sync::watch;
use tokio::task::JoinHandle;
use tokio::time::timeout;

use super::{condition, policy, relayed, restart, small_motion, start, supervised, supervised_at};
use crate::{SOON, alone};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn motions_wait_for_a_robot_and_begin_only_if_awaited() {
    let _alone = alone();
    let (sim, mut way) = relayed(Sim::fr3()).await;
    let robot = supervised_at(way.addr(), policy().motions_wait(SOON)).await;
    let q = robot.state().q;
    let target = |joint: usize| {
        let mut q = q;
        q[joint] += 0.05;
        q
    };
    way.cut().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let superseded = asked_for(robot.move_joints(target(0))).await;
    let stopped = asked_for(robot.move_joints(target(1))).await;
    assert_eq!(superseded.await.unwrap(), Err(MotionError::Superseded));
    // Without a connection the arm's motion is unknown: the stop waits for a connection.
    let mut stop = Box::pin(robot.stop());
    waits(&mut stop).await;
    drop(stop);
    assert_eq!(stopped.await.unwrap(), Err(MotionError::Stopped));
    // Dropped, detached, and cancelled.
    let dropped = asked_for(robot.move_joints(target(2))).await;
    dropped.abort();
    assert!(dropped.await.unwrap_err().is_cancelled());
    let motion = robot.move_joints(target(3));
    let handle = motion.handle();
    let cancelled = asked_for(motion).await;
    handle.cancel();
    assert_eq!(cancelled.await.unwrap(), Err(MotionError::Stopped));
    robot.move_joints(target(4)).detach();

    way.mend().await;
    condition(&robot, Condition::Ready).await;
    crate::robot_time(&robot, 300).await;
    let state = sim.state().await.unwrap();
    assert_eq!(state.robot_mode, RobotMode::Idle);
    for (before, now) in q.iter().zip(state.q) {
        assert!((before - now).abs() < 1e-6, "nobody awaits a motion");
    }

    way.cut().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let waiting = asked_for(robot.move_joints(target(5))).await;
    way.mend().await;
    let outcome = timeout(SOON, waiting).await.expect("no hang").unwrap();
    outcome.expect("it arrives");
    let moved = sim.state().await.unwrap().q[5] - q[5];
    assert!((moved - 0.05).abs() < 2e-3, "{moved}");

    // A session waits likewise.
    way.cut().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let engaging = tokio::spawn({
        let robot = robot.clone();
        async move { robot.engage(Engage::default()).await }
    });
    way.mend().await;
    let arm = timeout(SOON, engaging).await.expect("no hang").unwrap();
    let arm = arm.expect("the session begins");
    arm.disengage().await.expect("it ends");
    robot.shutdown().await;
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_motion_that_waits_begins_paused_if_it_was_paused_last() {
    let _alone = alone();
    let (sim, mut way) = relayed(Sim::fr3()).await;
    let q = sim.state().await.unwrap().q;
    let robot = supervised_at(way.addr(), policy().motions_wait(SOON)).await;
    let mut target = q;
    target[6] += 0.05;
    for resumed in [false, true] {
        way.cut().await;
        condition(&robot, Condition::Unready(Unready::Disconnected)).await;
        let motion = robot.move_joints(target);
        let handle = motion.handle();
        let moving = asked_for(motion).await;
        handle.pause();
        if resumed {
            handle.resume();
        }
        way.mend().await;
        condition(&robot, Condition::Ready).await;
        if !resumed {
            crate::shown(&robot, || handle.progress()).await;
            crate::robot_time(&robot, 2000).await;
            let reference = crate::shown(&robot, || robot.reference()).await;
            for (stands, q) in reference.q.iter().zip(q) {
                assert!((stands - q).abs() < 1e-6, "{stands} rad, begun at {q}");
            }
            handle.resume();
        }
        let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
        outcome.expect("it arrives");
        let moved = sim.state().await.unwrap().q[6] - q[6];
        assert!((moved - 0.05).abs() < 2e-3, "{moved}");
    }
    robot.shutdown().await;
    sim.stop().await;
}

/// A stream of targets that changes and ends while its motion waits.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn waiting_stream_begins_with_its_last_target_and_its_end() {
    let _alone = alone();
    let (sim, mut way) = relayed(Sim::fr3()).await;
    let robot = supervised_at(way.addr(), policy().motions_wait(SOON)).await;
    let q = robot.state().q;
    let mut last = q;
    last[5] += 0.05;
    way.cut().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let (sender, targets) = watch::channel(q);
    let mut following = robot.follow(targets).into_future();
    waits(&mut following).await;
    sender.send(last).unwrap();
    drop(sender);
    waits(&mut following).await;
    way.mend().await;
    let outcome = timeout(SOON, following).await.expect("it ends");
    outcome.expect("it arrives");
    let moved = sim.state().await.unwrap().q[5] - q[5];
    assert!((moved - 0.05).abs() < 2e-3, "{moved}");
    robot.shutdown().await;
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn waiting_motion_does_not_begin_on_a_restarted_robot() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy().motions_wait(SOON)).await;
    small_motion(&robot).await.expect("it is ready");
    let mut target = robot.state().q;
    target[5] += 0.05;
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let waiting = asked_for(robot.move_joints(target)).await;
    let sim = restart(address).await;
    let outcome = timeout(SOON, waiting).await.expect("no hang").unwrap();
    let Err(MotionError::NotReady {
        why: Unready::Unrecognised(what),
        ..
    }) = outcome
    else {
        panic!("{outcome:?}")
    };
    assert!(what.clock && !what.description && !what.frames, "{what}");
    condition(&robot, Condition::Ready).await;
    // A request at this time gets the robot in its current state.
    small_motion(&robot).await.expect("motions are admitted");
    robot.shutdown().await;
    sim.stop().await;
}

/// The straight line to the other side of the base collides with the arm itself.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_line_that_is_refused_leaves_the_motion_that_waits() {
    let _alone = alone();
    let (sim, mut way) = relayed(Sim::fr3()).await;
    let robot = supervised_at(way.addr(), policy().motions_wait(SOON)).await;
    let (mut q, start) = (robot.state().q, robot.pose());
    q[5] += 0.05;
    way.cut().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let waiting = asked_for(robot.move_joints(q)).await;
    let there = Pose::translation(-2.0 * start.translation.x, 0.0, -0.2) * start;
    let refused = timeout(SOON, robot.move_to(there).into_future()).await;
    let refused = refused.expect("it does not wait");
    assert!(
        matches!(refused, Err(MotionError::Goal(GoalError::NoLine { .. }))),
        "{refused:?}"
    );
    assert!(!waiting.is_finished());
    way.mend().await;
    let outcome = timeout(SOON, waiting).await.expect("no hang").unwrap();
    outcome.expect("it arrives");
    robot.shutdown().await;
    sim.stop().await;
}

/// Has a motion asked for by its first poll, and awaits it in another task. It waits for its robot.
async fn asked_for(motion: Motion) -> JoinHandle<Result<MotionReport, MotionError>> {
    let mut moving = motion.into_future();
    waits(&mut moving).await;
    tokio::spawn(moving)
}

/// Polls a future, which must not be ready.
async fn waits<F: Future<Output: Debug> + Unpin>(future: &mut F) {
    let polled = poll_fn(|context| Poll::Ready(Pin::new(&mut *future).poll(context))).await;
    assert!(polled.is_pending(), "{polled:?}");
}
