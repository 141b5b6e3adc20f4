//! The external wrench, without the part that a robot shows with nothing attached.

use std::future::IntoFuture;
use std::time::Duration;

use franka_async::condition::{elapsed, force, force_z};
use franka_async::error::{Party, TareError};
use franka_async::settings::CollisionBehavior;
use franka_async::state::{TareRefused, Taring, WrenchTare};
use franka_async::{Pose, Robot};
use franka_sim::{Running, Sim, Touch};
use futures::StreamExt;
use nalgebra::Vector3;
use tokio::time::timeout;

use crate::{SOON, alone, at_the_clients_pace, long_way, robot_time, under_way, until};

/// An arm that sticks and is off as real ones are, and reports no contact.
async fn realistic() -> (Robot, Running) {
    let (robot, sim) = at_the_clients_pace(Sim::fr3()).await;
    let most = [500.0; 6];
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], most, most);
    robot.set_collision_behavior(tolerant).await.expect("idle");
    (robot, sim)
}

/// Pulls at the hand, in addition to the current load.
async fn pull(sim: &Running, force: Vector3<f64>) {
    let pull = move |robot: &mut franka_sim::Robot| {
        robot.touch(Touch::force(force));
    };
    sim.with(pull).await.expect("it runs");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_tare_takes_off_what_an_untouched_arm_shows() {
    let _alone = alone();
    let (robot, sim) = realistic().await;
    // An undeclared kilogram.
    pull(&sim, Vector3::new(0.0, 0.0, -10.0)).await;
    robot_time(&robot, 400).await;
    let tare = robot.tare().await.expect("it rests");
    println!("{tare:?}");
    let offset = Vector3::from_row_slice(&tare.wrench[..3]).norm();
    assert!(offset > 3.0, "{offset} N");
    let again = robot.tare_over(Duration::from_millis(100)).await;
    let again = again.expect("it rests");
    for i in 0..3 {
        let left = again.wrench[i] - tare.wrench[i];
        assert!(left.abs() < 0.3, "{left} N along axis {i}");
    }
    assert!(tare.turned(&robot.state()) < WrenchTare::NEAR);
    // Later loads appear as the force that the arm exerts against them, except for friction.
    pull(&sim, Vector3::new(0.0, 0.0, -15.0)).await;
    robot_time(&robot, 400).await;
    let state = robot.state();
    let [.., force, _, _, _] = tare.compensate(&state).expect("an estimate");
    let without = state.O_F_ext_hat_K[2];
    println!("{force:.2} N along z, {without:.2} N without the tare");
    assert!((8.0..18.0).contains(&force), "{force} N");
    assert!((without - force - tare.wrench[2]).abs() < 1e-9);
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn tared_states_follow_the_arm_and_end_with_its_connection() {
    let _alone = alone();
    let (robot, _sim) = realistic().await;
    let tare = robot.tare().await.expect("it rests");
    let mut states = robot.tared_states(&tare);
    assert!(states.newest().turned < WrenchTare::NEAR);
    let motion = tokio::spawn(long_way(&robot).into_future());
    let mut last = 0;
    loop {
        let tared = states.next().await.expect("a state");
        let state = tared.state;
        assert!(state.message_id > last, "{} after {last}", state.message_id);
        last = state.message_id;
        assert_eq!(tared.wrench, tare.compensate(&state));
        assert_eq!(tared.turned, tare.turned(&state));
        let off = tared.wrench.expect("an estimate")[2] - state.O_F_ext_hat_K[2];
        assert!((off + tare.wrench[2]).abs() < 1e-9, "{off} N");
        if tared.turned > 2.0 * WrenchTare::NEAR {
            break;
        }
    }
    robot.stop().await.expect("it brakes");
    drop(motion.await.expect("no panic"));
    robot.shutdown().await;
    // At most one state is left.
    let left = timeout(SOON, states.count()).await.expect("an end");
    assert!(left <= 1, "{left}");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_arm_that_moves_is_not_tared() {
    let _alone = alone();
    let (robot, _sim) = realistic().await;
    let motion = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    let error = robot
        .tare()
        .await
        .expect_err("it is to move, and sticks yet");
    assert_eq!(error, TareRefused::UnderWay.into());
    let refused = TareError::from(pushed_through(&robot).await);
    assert_eq!(refused.party(), Party::Caller);
    assert_eq!(refused.entry(), "tare-refused");
    // A dropped tare leaves nothing behind: the next one is as good.
    robot.stop().await.expect("it brakes");
    drop(motion.await.expect("no panic"));
    robot_time(&robot, 500).await;
    assert!(timeout(Duration::ZERO, robot.tare()).await.is_err());
    robot.tare().await.expect("it rests");
    robot.shutdown().await;
}

/// Reason why states of an arm that has begun to move make no tare.
async fn pushed_through(robot: &Robot) -> TareRefused {
    let mut taring = Taring::over(WrenchTare::DURATION).expect("a duration");
    let mut refused = None;
    until(robot, |state| {
        refused = taring.push(state).err();
        refused.is_some()
    })
    .await;
    let refused = refused.expect("it moves");
    assert!(matches!(refused, TareRefused::Moves { .. }), "{refused}");
    refused
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_tared_condition_ends_a_motion_at_a_table() {
    let _alone = alone();
    let (robot, sim) = realistic().await;
    let table = |robot: &mut franka_sim::Robot| {
        let hand = robot.true_pose().translation.vector;
        let table = Touch::wall(hand - Vector3::z() * 0.03, Vector3::z());
        robot.touch(table.stiffness(5000.0));
    };
    sim.with(table).await.expect("it runs");
    let tare = robot.tare().await.expect("it rests");
    let start = robot.pose();
    let down = Pose::translation(0.0, 0.0, -0.1) * start;
    let touched = (force_z(8.0) | force(40.0)).tared(&tare) & elapsed(Duration::from_millis(200));
    let motion = robot.move_to(down).speed(0.1).until(touched);
    let report = timeout(SOON, motion.into_future()).await.expect("no hang");
    let contact = report.expect("a contact").reacted.expect("a contact");
    let way = start.translation.z - contact.pose.translation.z;
    assert!((0.028..0.045).contains(&way), "{way} m");
    robot.shutdown().await;
}
