//! Motions that continue until a condition is true, over sockets. tests/lockstep/reactions tests
//! their cycles.

use std::future::IntoFuture;
use std::time::Duration;

use franka_async::condition::{elapsed, force_z};
use franka_async::goal::Budget;
use franka_async::{Engage, Motion, Pose, Robot};
use franka_sim::{Running, Sim, Touch};
use nalgebra::Vector3;
use tokio::sync::watch;
use tokio::time::timeout;

use crate::{SOON, alone, at_the_clients_pace};

/// An arm that sticks and lags as real ones do, above a table that is 3 cm away.
async fn above_a_table() -> (Robot, Running) {
    let (robot, sim) = at_the_clients_pace(Sim::fr3()).await;
    let most = [500.0; 6];
    let tolerant =
        franka_async::settings::CollisionBehavior::uniform([100.0; 7], [100.0; 7], most, most);
    robot.set_collision_behavior(tolerant).await.expect("idle");
    let table = |robot: &mut franka_sim::Robot| {
        let hand = robot.true_pose().translation.vector;
        let table = Touch::wall(hand - Vector3::z() * 0.03, Vector3::z());
        robot.touch(table.stiffness(5000.0));
    };
    sim.with(table).await.expect("it runs");
    (robot, sim)
}

/// At most 5 cm/s.
fn gently(motion: Motion, robot: &Robot) -> Motion {
    let mut budget = Budget::of(robot.model().joint_limits());
    budget.translation.velocity = 0.05;
    motion.limits(budget)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_guarded_move_ends_at_the_table_or_where_it_goes_on_to() {
    let _alone = alone();
    let (robot, _sim) = above_a_table().await;
    let start = robot.pose();
    let down = Pose::translation(0.0, 0.0, -0.1) * start;
    let touched = force_z(8.0).relative() & elapsed(Duration::from_millis(200));

    let motion = gently(robot.move_to(down), &robot).until(touched);
    let report = timeout(SOON, motion.into_future()).await.expect("no hang");
    let contact = report.expect("a contact").reacted.expect("a contact");
    let way = start.translation.z - contact.pose.translation.z;
    assert!((0.028..0.045).contains(&way), "{way} m");
    assert!(contact.wrench[2] < -5.0, "{contact:?}");
    assert!(contact.after > Duration::from_millis(200));

    robot.move_to(start).await.expect("nothing is above it");
    let motion = gently(robot.move_to(down), &robot).until(touched.then(start));
    let report = timeout(SOON, motion.into_future()).await.expect("no hang");
    let report = report.expect("a contact, and a way back");
    assert!(report.reacted.is_some() && report.final_error.is_some());
    let off = robot.pose().translation.vector - start.translation.vector;
    assert!(off.norm() < 5e-3, "{} m", off.norm());
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn reaction_ends_a_stream_and_holds_the_engaged_arm() {
    let _alone = alone();
    let (robot, _sim) = at_the_clients_pace(Sim::fer()).await;
    let arm = robot.engage(Engage::default()).await.expect("it is free");
    let start = robot.pose();
    let (sender, targets) = watch::channel(Pose::translation(0.0, 0.0, 0.2) * start);
    let due = Duration::from_millis(400);
    let following = arm.follow(targets).until(elapsed(due)).into_future();
    let report = timeout(SOON, following).await.expect("no hang");
    let reacted = report.expect("in time").reacted.expect("in time");
    assert_eq!(reacted.after, due);
    drop(sender);
    let held = robot.pose();
    let went = held.translation.z - start.translation.z;
    assert!((0.005..0.15).contains(&went), "{went} m");
    crate::robot_time(&robot, 500).await;
    let moved = robot.pose().translation.vector - held.translation.vector;
    assert!(moved.norm() < 3e-3, "{} m", moved.norm());
    arm.disengage()
        .await
        .expect("the session goes on until then");
}
