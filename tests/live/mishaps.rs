//! Networks that lose, delay or cut, between the simulator's sockets and the driver's.
//!
//! The networks delay by the robots' time, which waits for the client's answer to each state that
//! reaches it. `tests/lockstep/mishaps.rs` tests each effect, its amount, and the limits up to
//! which it is bridged.

use std::future::IntoFuture;
use std::time::Duration;

use franka_async::error::CommandError;
use franka_async::settings::Load;
use franka_async::{Pose, Robot};
use franka_sim::{Network, Running, Sim, Tool};
use franka_tests::mishaps;
use tokio::time::timeout;

use crate::{SOON, alone, at_the_clients_pace, long_way, until};

/// This robot behind this network, which minds no command that comes late or is missing.
async fn behind(network: Network, sim: Sim) -> (Robot, Running) {
    let sim = sim.configure(|config| {
        config.enforce_limits = false;
        config.enforce_communication = false;
    });
    at_the_clients_pace(sim.tool(Tool::hand()).network(network)).await
}

/// States that are a tenth of a second old still have the frames and the load of before.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn setter_resolves_once_the_state_shows_its_value() {
    let _alone = alone();
    for sim in [Sim::fr3(), Sim::fer()] {
        let (robot, _sim) = behind(mishaps::delay(Duration::from_millis(100)), sim).await;
        let frame = Pose::translation(0.0, 0.0, 0.1);
        let z = robot.pose().translation.z;
        robot.set_ee(frame).await.expect("at rest");
        assert!((z - robot.pose().translation.z - 0.1).abs() < 1e-3);
        robot.set_k(frame).await.expect("at rest");
        assert!((robot.state().EE_T_K[14] - 0.1).abs() < 1e-6);
        let load = Load {
            m_load: 0.3,
            F_x_Cload: [0.0, 0.01, 0.1],
            I_load: [0.0; 9],
        };
        robot.set_load(load).await.expect("at rest");
        assert!((robot.state().m_load - 0.3).abs() < 1e-6);
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn lost_datagrams_are_counted_and_the_arm_arrives() {
    let _alone = alone();
    for (sim, network) in [
        (Sim::fr3().ideal(), mishaps::loss(3)),
        (Sim::fer().ideal(), mishaps::bursts(3)),
        (Sim::fer().ideal(), mishaps::halves(3)),
    ] {
        let (robot, _sim) = behind(network, sim).await;
        let mut q = robot.state().q;
        q[0] += 0.4;
        q[5] += 0.2;
        let motion = robot.move_joints(q).speed(0.5).into_future();
        let outcome = timeout(SOON, motion).await.expect("it resolves");
        let report = outcome.expect("it arrives");
        for (is, target) in robot.state().q.iter().zip(q) {
            assert!((is - target).abs() < 5e-3, "{is} for {target}");
        }
        assert!(
            report.lost_states > 10 && report.success_rate_min < 1.0,
            "{report:?}"
        );
        robot.shutdown().await;
    }
}

/// So late, no command is in time either.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn states_are_as_old_as_the_network_makes_them() {
    let _alone = alone();
    let network = mishaps::delay(Duration::from_millis(30));
    let (robot, sim) = behind(network, Sim::fr3().ideal()).await;
    let moving = tokio::spawn(long_way(&robot).into_future());
    for _ in 0..10 {
        let published = sim.state().await.expect("it runs").message_id;
        until(&robot, |state| {
            assert_eq!(state.control_command_success_rate, 0.0);
            state.message_id > published
        })
        .await;
        let seen = robot.state().message_id;
        let published = sim.state().await.expect("it runs").message_id;
        assert!(published >= seen + 30, "{seen} of {published}");
    }
    moving.abort();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_load_that_is_answered_and_never_shown_is_a_lost_link() {
    let _alone = alone();
    let (robot, sim) = behind(Network::perfect(), Sim::fr3().ideal()).await;
    let cut = |network: &mut Option<Network>, now| {
        let network = network.as_mut().expect("there is one");
        network
            .to_client
            .cut(now..now + Duration::from_secs(100_000));
    };
    sim.with_network(cut).await.expect("it runs");
    let load = Load {
        m_load: 0.3,
        F_x_Cload: [0.0; 3],
        I_load: [0.0; 9],
    };
    let lost = timeout(SOON, robot.set_load(load)).await.expect("it ends");
    let lost = lost.unwrap_err();
    assert!(matches!(lost, CommandError::LinkLost { .. }), "{lost}");
    robot.shutdown().await;
}

/// The client's newest state is from before the motion: it has nothing to answer, and virtual time
/// continues.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_motion_whose_first_states_are_lost_begins_after_the_cut() {
    let _alone = alone();
    let (robot, sim) = behind(Network::perfect(), Sim::fr3().ideal()).await;
    let cut = |network: &mut Option<Network>, now| {
        let network = network.as_mut().expect("there is one");
        network.to_client.cut(now..now + Duration::from_millis(300));
    };
    sim.with_network(cut).await.expect("it runs");
    let mut q = robot.state().q;
    q[0] += 0.1;
    let moving = robot.move_joints(q).into_future();
    let arrived = timeout(SOON, moving).await.expect("it resolves");
    arrived.expect("it arrives");
    robot.shutdown().await;
}
