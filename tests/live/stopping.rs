//! Stops that hold until they are released, and stops that outlive their connection.

use std::future::{Future as _, poll_fn};
use std::pin::pin;
use std::task::Poll;
use std::time::Duration;

use franka_async::control::{Finish as _, Torques};
use franka_async::error::Unready;
use franka_async::goal::Chunk;
use franka_async::supervision::Condition;
use franka_async::{Engage, MotionError, Pose, Robot};
use franka_sim::Sim;
use tokio::time::timeout;

use crate::supervising::{condition, policy, restart, small_motion, start, supervised};
use crate::team::{two, up};
use crate::{SOON, alone, long_way, robot_time, simulated, under_way};

fn latched<T>() -> Result<T, MotionError> {
    Err(MotionError::NotReady {
        why: Unready::StopLatched,
        waited: Duration::ZERO,
    })
}

/// Requests every kind of motion.
async fn nothing_is_admitted(robot: &Robot) {
    assert_eq!(long_way(robot).await, latched());
    let way = [robot.pose(), up(0.01) * robot.pose()];
    assert_eq!(robot.move_through(way).await, latched());
    let function = robot.control_torques(|_, _| Torques([0.0; 7]).finish());
    assert_eq!(function.await, latched());
    let engaged = robot.engage(Engage::default()).await;
    assert_eq!(engaged.map(drop), latched());
    let active = robot.active_torques().await;
    assert_eq!(active.map(drop), latched());
    robot.move_to(up(0.02) * robot.pose()).detach();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn latched_stop_admits_nothing_until_it_is_released() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let arm = robot.engage(Engage::default()).await.expect("it is ready");
    let target = up(0.1) * robot.pose();
    arm.set(target).await.expect("a goal");
    under_way(&robot).await;
    robot.latch_stop().await.expect("it comes to rest");
    assert!(robot.is_stop_latched());
    assert!(!robot.state().motion_running());
    let rests = robot.state().q;

    nothing_is_admitted(&robot).await;
    assert_eq!(arm.set(target).await, latched());
    assert_eq!(arm.try_set(target), latched());
    assert_eq!(arm.move_to(target).await, latched());
    let chunk = Chunk::joints([(Duration::from_millis(300), rests)]).expect("a point");
    assert_eq!(arm.chunk(chunk).await, latched());
    // Calls without motion still work, and do not release the stop.
    robot.stop().await.expect("it rests");
    robot.recover().await.expect("nothing to recover from");
    robot
        .set_joint_impedance([3000.0; 7])
        .await
        .expect("no motion runs");
    robot_time(&robot, 300).await;
    assert!(!robot.state().motion_running());
    for (joint, (before, now)) in rests.iter().zip(robot.state().q).enumerate() {
        assert!((before - now).abs() < 1e-3, "joint {joint} has moved");
    }

    assert!(robot.release_stop());
    assert!(!robot.release_stop(), "it was released");
    robot_time(&robot, 300).await;
    assert!(!robot.state().motion_running(), "nothing begins by itself");
    small_motion(&robot)
        .await
        .expect("motions are admitted again");
    robot.shutdown().await;
}

/// The goal follows a stream, whose targets continue while the arm brakes.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn latched_stop_ends_a_goal_whose_targets_go_on() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let (sender, targets) = tokio::sync::watch::channel(start);
    let following = tokio::spawn(std::future::IntoFuture::into_future(robot.follow(targets)));
    let moving = tokio::spawn(async move {
        for step in 0..u32::MAX {
            let on = Pose::translation(0.0, 1e-4 * f64::from(step % 500), 0.0) * start;
            if sender.send(on).is_err() {
                return;
            }
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
    });
    under_way(&robot).await;
    robot.latch_stop().await.expect("it comes to rest");
    let outcome = timeout(SOON, following).await.expect("no hang");
    assert_eq!(outcome.expect("no panic"), Err(MotionError::Stopped));
    assert!(!robot.state().motion_running());
    moving.await.expect("nobody takes targets");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn latched_stop_of_a_team_refuses_rounds_and_single_motions() {
    let _alone = alone();
    let two = two().await;
    let [left, right] = &two.robots;
    let targets = [up(0.1) * left.pose(), up(-0.1) * right.pose()];
    let moving = tokio::spawn(two.team.move_to(targets));
    under_way(left).await;
    for stopped in two.team.latch_stop().await {
        stopped.expect("it comes to rest");
    }
    for outcome in moving.await.expect("no panic") {
        outcome.expect_err("it was stopped");
    }
    assert_eq!(two.team.move_to(targets).await, [latched(), latched()]);
    assert_eq!(two.team.arms()[1].move_to(targets[1]).await, latched());
    nothing_is_admitted(left).await;
    assert!(two.team.release_stop());
    small_motion(right)
        .await
        .expect("motions are admitted again");
    for robot in &two.robots {
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn stop_waits_for_the_next_connection_and_a_latch_outlives_it() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy().motions_wait(SOON)).await;
    let moving = tokio::spawn(std::future::IntoFuture::into_future(long_way(&robot)));
    under_way(&robot).await;
    sim.stop().await;
    let outcome = timeout(SOON, moving).await.expect("no hang");
    outcome
        .expect("no panic")
        .expect_err("the connection is lost");
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;

    let waiting = tokio::spawn(std::future::IntoFuture::into_future(long_way(&robot)));
    let stopping = robot.clone();
    let mut stop = pin!(async move { stopping.latch_stop().await });
    let first = poll_fn(|context| Poll::Ready(stop.as_mut().poll(context))).await;
    assert!(first.is_pending(), "{first:?}");
    let outcome = timeout(SOON, waiting)
        .await
        .expect("no hang")
        .expect("no panic");
    // Cancelled if it was requested first.
    assert!(
        [latched(), Err(MotionError::Stopped)].contains(&outcome),
        "{outcome:?}"
    );
    nothing_is_admitted(&robot).await;
    let sim = restart(address).await;
    timeout(SOON, stop)
        .await
        .expect("no hang")
        .expect("a state shows that it rests");
    condition(&robot, Condition::Unready(Unready::StopLatched)).await;
    nothing_is_admitted(&robot).await;
    robot_time(&robot, 300).await;
    assert!(!sim.state().await.expect("it runs").motion_running());
    assert!(robot.release_stop());
    condition(&robot, Condition::Ready).await;
    small_motion(&robot)
        .await
        .expect("motions are admitted again");

    // A robot that is lost for good does not delay the stop.
    drop(robot);
    let robot = supervised(&sim, policy().without_reconnecting()).await;
    sim.stop().await;
    let lost = timeout(SOON, robot.stop()).await.expect("no hang");
    assert!(
        matches!(lost, Err(MotionError::ConnectionClosed { .. })),
        "{lost:?}"
    );
}
