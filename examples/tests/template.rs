//! Tests of a program against simulated robots: a file to copy to the `tests` of your crate.

// ANCHOR: nod
use std::time::Duration;

use franka_async::MotionError;
use franka_async::prelude::*;
use franka_sim::{Running, Sim};

/// The program under test: the hand moves down by `depth`, in metres, and back.
async fn nod(robot: &Robot, depth: f64) -> Result<(), MotionError> {
    robot.move_by(Offset::base([0.0, 0.0, -depth])).await?;
    robot.move_by(Offset::base([0.0, 0.0, depth])).await?;
    Ok(())
}

/// Starts a separate robot for each test, in virtual time: as fast as this machine, and never too
/// fast for it. Keep the second value; dropping it ends the robot.
async fn simulated() -> (Robot, Running) {
    disturbed(|_| ()).await
}

/// Starts a robot that runs `job` before each of its milliseconds. Events in mid-motion belong
/// there: a task that watches the robot can be too late, or never see it move.
async fn disturbed(job: impl FnMut(&mut franka_sim::Robot) + Send + 'static) -> (Robot, Running) {
    let sim = Sim::fr3().virtual_time(PATIENCE / 2).every_millisecond(job);
    let sim = sim.start().await.expect("a free port");
    let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = robot.link_timeout(PATIENCE).connect().await;
    (robot.expect("it answers"), sim)
}

/// Time for which robot and driver wait for each other on a busy machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// True if the arm moves. At rest the noise of a joint stays below 0.01 rad/s.
fn moves(robot: &franka_sim::Robot) -> bool {
    robot.dq().amax() > 0.05
}

#[tokio::test]
async fn a_nod_ends_where_it_began() {
    let (robot, _sim) = simulated().await;
    let before = robot.pose();
    nod(&robot, 0.04).await.expect("it arrives");
    let off = (robot.pose().translation.vector - before.translation.vector).norm();
    assert!(off < 2e-3, "{off} m");
}
// ANCHOR_END: nod

// ANCHOR: failures
#[tokio::test]
async fn a_pressed_user_stop_is_reported() {
    let (robot, sim) = simulated().await;
    let pressed = sim.with(|robot| robot.press_user_stop(true)).await;
    pressed.expect("the robot runs");
    let error = nod(&robot, 0.04).await.expect_err("nothing moves");
    assert!(error.to_string().contains("User stopped"), "{error}");
}

#[tokio::test]
async fn a_collision_is_not_hidden_and_can_be_recovered_from() {
    let mut tripped = false;
    let (robot, _sim) = disturbed(move |robot| {
        if moves(robot) && !std::mem::replace(&mut tripped, true) {
            robot.trip(franka_async::state::RobotError::CartesianReflex);
        }
    })
    .await;
    let error = nod(&robot, 0.1).await.expect_err("it is stopped");
    assert!(error.to_string().contains("cartesian_reflex"), "{error}");
    robot.recover().await.expect("it recovers");
    nod(&robot, 0.04).await.expect("it arrives");
}
// ANCHOR_END: failures

// ANCHOR: links
/// The robot's computer stops from then on: neither states nor answers arrive. The driver detects
/// this after the link timeout, and not before.
#[tokio::test]
async fn a_lost_link_ends_the_nod() {
    let (release, held) = std::sync::mpsc::channel::<()>();
    let (robot, _sim) = disturbed(move |robot| {
        if moves(robot) {
            let _ = held.recv();
        }
    })
    .await;
    let error = nod(&robot, 0.1).await.expect_err("the link is lost");
    assert!(matches!(error, MotionError::LinkLost { .. }), "{error}");
    drop(release);
}

/// The network is cut for 100 ms of the robot's time, in both directions. Only a task can cut it:
/// the robot stops in its first moving millisecond until a task has requested the cut.
#[tokio::test]
async fn a_cut_network_ends_the_nod() {
    let (tell, moving) = tokio::sync::oneshot::channel();
    let (go_on, held) = std::sync::mpsc::channel::<()>();
    let mut tell = Some(tell);
    let (robot, sim) = disturbed(move |robot| {
        if moves(robot)
            && let Some(tell) = tell.take()
        {
            let _ = tell.send(());
            let _ = held.recv();
        }
    })
    .await;
    let cut = async {
        moving.await.expect("it moves");
        let cut = sim.with_network(|network, now| {
            let network = network.get_or_insert_with(franka_sim::Network::perfect);
            network.to_client.cut(now..now + Duration::from_millis(100));
            network.to_robot.cut(now..now + Duration::from_millis(100));
        });
        // In this order: the cut is requested, and then the robot continues.
        let (cut, ()) = tokio::join!(biased; cut, async { drop(go_on) });
        cut.expect("the robot runs");
    };
    let (nodded, ()) = tokio::join!(nod(&robot, 0.1), cut);
    let error = nodded.expect_err("its commands are lost").to_string();
    assert!(
        error.contains("communication_constraints_violation"),
        "{error}"
    );
}

/// The simulation ends in mid-motion, with its sockets, as in a power failure of the robot.
#[tokio::test]
async fn a_robot_that_is_gone_ends_the_nod() {
    let (robot, sim) = disturbed(|robot| {
        if moves(robot) {
            // Like `panic!`, but prints nothing.
            std::panic::resume_unwind(Box::new("the robot is gone"));
        }
    })
    .await;
    let error = nod(&robot, 0.1).await.expect_err("the robot is gone");
    assert!(
        matches!(error, MotionError::ConnectionClosed { .. }),
        "{error}"
    );
    sim.ended().await;
}
// ANCHOR_END: links
