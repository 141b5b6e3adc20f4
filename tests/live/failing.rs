//! Connections that fail in the middle of a motion.

use std::time::{Duration, Instant};

use franka_async::MotionError;
use franka_async::error::CommandError;
use franka_async::state::RobotMode;
use franka_sim::Network;

use crate::{SOON, alone, connect, long_way, simulated, under_way, until};

#[tokio::test(flavor = "multi_thread")]
async fn silent_robot_is_lost_and_serves_again_once_back() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    // The cycle of the simulator stands still until the motion has ended; its TCP connection lives
    // on.
    let (release, held) = std::sync::mpsc::channel::<()>();
    let silence = sim.with(move |_| held.recv().is_err());
    let begun = Instant::now();
    let (silent, outcome) = tokio::join!(silence, async {
        let outcome = moving.await.unwrap();
        // No motion is left to stop, and it is unknown whether the arm rests.
        let stop = robot.stop().await;
        assert!(
            matches!(stop, Err(MotionError::LinkLost { .. })),
            "{stop:?}"
        );
        drop(release);
        outcome
    });
    silent.unwrap();
    let after = begun.elapsed();
    let error = outcome.unwrap_err();
    assert!(matches!(error, MotionError::LinkLost { .. }), "{error:?}");
    assert!(
        error
            .to_string()
            .starts_with("libfranka: UDP receive: Timeout"),
        "{error}"
    );
    // Not before its time; when exactly is for tests/lockstep/silence.rs.
    assert!(after >= Duration::from_millis(900), "{after:?}");

    // The same connection serves again once the robot has ended the motion, too.
    until(&robot, |state| state.robot_mode != RobotMode::Move).await;
    robot.recover().await.unwrap();
    assert_eq!(robot.state().robot_mode, RobotMode::Idle);
    robot.stop().await.unwrap();
    robot.move_to(robot.pose()).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_that_dies_ends_the_motion_and_everything_after_it() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    sim.stop().await;
    let outcome = tokio::time::timeout(SOON, moving)
        .await
        .expect("no hang")
        .unwrap();
    let error = outcome.unwrap_err();
    assert!(
        matches!(error, MotionError::ConnectionClosed { .. }),
        "{error:?}"
    );
    let text = error.to_string();
    assert!(
        text == "libfranka: server closed connection"
            || text.starts_with("libfranka: TCP receive: "),
        "{text}"
    );
    let refused = robot.move_to(robot.pose()).await.unwrap_err();
    assert!(
        matches!(refused, MotionError::ConnectionClosed { .. }),
        "{refused:?}"
    );
    let refused = robot.recover().await.unwrap_err();
    assert!(
        matches!(refused, CommandError::ConnectionClosed { .. }),
        "{refused:?}"
    );
    robot.shutdown().await;
    let (robot, _sim) = simulated().await;
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn the_last_handle_dropped_in_mid_motion_brakes_and_closes() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    long_way(&robot).detach();
    under_way(&robot).await;
    drop(robot);
    let gone = async {
        while sim.with(|robot| robot.is_connected()).await.unwrap() {
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    };
    tokio::time::timeout(SOON, gone)
        .await
        .expect("the connection is closed");
    let state = sim.state().await.unwrap();
    assert_eq!(
        state.robot_mode,
        RobotMode::Idle,
        "it ended without a reflex: {}",
        state.reflex_reason
    );
    let robot = connect(&sim).await;
    robot.shutdown().await;
}

/// A frozen computer, as the network shows it: the connection is open, and nothing is sent.
#[tokio::test(flavor = "multi_thread")]
async fn recovery_of_a_silent_robot_ends_with_a_lost_link() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let (release, held) = std::sync::mpsc::channel::<()>();
    let (freeze, frozen) = tokio::sync::oneshot::channel();
    let silence = sim.with(move |_| {
        freeze.send(()).unwrap();
        held.recv().is_err()
    });
    let (silent, recovered) = tokio::join!(silence, async {
        frozen.await.unwrap();
        let recovered = robot.recover().await;
        drop(release);
        recovered
    });
    silent.unwrap();
    let Err(CommandError::LinkLost { silence }) = recovered else {
        panic!("{recovered:?}");
    };
    assert!(silence >= Duration::from_secs(4), "{silence:?}");
    robot.shutdown().await;
}

/// Commands are answered and carried out; the states are lost on their way.
#[tokio::test(flavor = "multi_thread")]
async fn a_recovery_that_no_state_confirms_is_no_success() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    let cut = |network: &mut Option<Network>, now| {
        let network = network.get_or_insert_with(Network::perfect);
        network.to_client.cut(now..Duration::MAX);
    };
    sim.with_network(cut).await.unwrap();
    let lost = moving.await.unwrap().unwrap_err();
    assert!(matches!(lost, MotionError::LinkLost { .. }), "{lost:?}");
    let recovered = robot.recover().await.unwrap_err();
    assert!(
        matches!(recovered, CommandError::LinkLost { .. }),
        "{recovered:?}"
    );
    robot.shutdown().await;
}
