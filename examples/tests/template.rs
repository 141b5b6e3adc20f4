//! Tests of a program against simulated robots: a file to copy to the `tests` of your crate.

use std::time::Duration;

use franka_async::MotionError;
use franka_async::prelude::*;
use franka_sim::{Network, Running, Sim};

/// What is tested: the hand goes down by `depth`, in metres, and back.
async fn nod(robot: &Robot, depth: f64) -> Result<(), MotionError> {
    robot.move_by(Offset::base([0.0, 0.0, -depth])).await?;
    robot.move_by(Offset::base([0.0, 0.0, depth])).await?;
    Ok(())
}

/// A robot of its own for each test, in virtual time: as fast as this machine, and never too fast
/// for it. Keep what comes with the connection; dropping it ends the robot.
async fn simulated() -> (Robot, Running) {
    let sim = Sim::fr3().virtual_time(PATIENCE / 2);
    let sim = sim.start().await.expect("a free port");
    let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = robot.link_timeout(PATIENCE).connect().await;
    (robot.expect("it answers"), sim)
}

/// For how long robot and driver wait for each other on a machine that is busy.
const PATIENCE: Duration = Duration::from_secs(10);

#[tokio::test]
async fn a_nod_ends_where_it_began() {
    let (robot, _sim) = simulated().await;
    let before = robot.pose();
    nod(&robot, 0.04).await.expect("it arrives");
    let off = (robot.pose().translation.vector - before.translation.vector).norm();
    assert!(off < 2e-3, "{off} m");
}

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
    let (robot, sim) = simulated().await;
    // The robot trips once its arm moves.
    let tripping = tokio::spawn({
        let mut states = robot.states();
        async move {
            let moving = |state: &franka_async::state::RobotState| state.dq[3].abs() > 0.05;
            states.wait_for(moving).await.expect("states come");
            let trip = |robot: &mut franka_sim::Robot| {
                robot.trip(franka_async::state::RobotError::CartesianReflex);
            };
            sim.with(trip).await.expect("the robot runs");
            sim
        }
    });
    let error = nod(&robot, 0.1).await.expect_err("it is stopped");
    let _sim = tripping.await.expect("no panic");
    assert!(error.to_string().contains("cartesian_reflex"), "{error}");
    robot.recover().await.expect("it recovers");
    nod(&robot, 0.04).await.expect("it arrives");
}

/// Neither states nor commands arrive any more; the connection for requests stands.
#[tokio::test]
async fn a_lost_link_ends_the_nod() {
    let (robot, sim) = simulated().await;
    let mut states = robot.states();
    let cut = async {
        let moving = |state: &franka_async::state::RobotState| state.dq[3].abs() > 0.05;
        states.wait_for(moving).await.expect("states come");
        let cut = |network: &mut Option<Network>, now| {
            let network = network.get_or_insert_with(Network::perfect);
            network.to_client.cut(now..Duration::MAX);
            network.to_robot.cut(now..Duration::MAX);
        };
        sim.with_network(cut).await.expect("the robot runs");
    };
    let (nodded, ()) = tokio::join!(nod(&robot, 0.1), cut);
    let error = nodded.expect_err("nobody knows where the arm is");
    assert!(matches!(error, MotionError::LinkLost { .. }), "{error}");
}
