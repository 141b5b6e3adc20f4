//! Connections that are lost and made again, and those that are not.

use std::future::IntoFuture;
use std::sync::Arc;
use std::time::Duration;

use franka_async::error::{CloseReason, Unready};
use franka_async::settings::{CollisionBehavior, Load};
use franka_async::state::RobotMode;
use franka_async::supervision::{Condition, Differences, EventKind};
use franka_async::{Engage, MotionError, Pose, Realtime, Robot};
use franka_model::geometry::Lengths;
use franka_proto::Command;
use franka_sim::arm::StateGeometry;
use franka_sim::{Config, Sim, Tool};
use franka_tests::PATIENCE;
use tokio::time::{sleep, timeout};

use super::{
    condition, connected, policy, restart, small_motion, start, started_at, supervised, told,
};
use crate::{SOON, alone, under_way};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_robot_that_was_restarted_is_there_again_and_stands_still() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    let mut states = robot.states();
    let (model, stats) = (robot.model() as *const _, robot.stats());

    let arm = robot.engage(Engage::default()).await.expect("it is ready");
    let up = Pose::translation(0.0, 0.0, 0.1) * robot.pose();
    let moving = tokio::spawn(arm.move_to(up).speed(0.05).into_future());
    under_way(&robot).await;
    sim.stop().await;
    let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::ConnectionClosed { .. })),
        "{outcome:?}"
    );
    let lost = |kind: &EventKind| match kind {
        EventKind::Lost { reason } => Some(reason.clone()),
        _ => None,
    };
    assert_eq!(told(&mut events, lost).await, CloseReason::ClosedByPeer);
    assert_ne!(robot.health().newest().condition, Condition::Ready);
    // A command has no connection, and a motion does not wait.
    let error = robot.recover().await.unwrap_err();
    assert_eq!(error.to_string(), "libfranka: server closed connection");
    let why = Unready::Disconnected;
    let refused = robot.move_to(up).await.unwrap_err();
    let waited = Duration::ZERO;
    assert_eq!(refused, MotionError::NotReady { why, waited });

    let sim = restart(address).await;
    let after = told(&mut events, connected).await;
    condition(&robot, Condition::Ready).await;
    let health = robot.health().newest();
    assert_eq!(health.last_reconnect, Some(after));
    assert_eq!((health.reconnects, health.attempts), (1, 0));
    assert_eq!(robot.model() as *const _, model, "goals are made for it");
    assert!(!Arc::ptr_eq(&robot.stats(), &stats), "another thread");
    let seen = timeout(SOON, states.changed()).await.expect("no hang");
    seen.expect("the newest states go on");

    // The previous session answers with its end, and nothing moves.
    let ended = arm.set(up).await.unwrap_err();
    assert!(
        matches!(ended, MotionError::ConnectionClosed { .. }),
        "{ended}"
    );
    assert!(arm.ended().await.is_err());
    let before = sim.state().await.unwrap().q;
    crate::robot_time(&robot, 500).await;
    let state = sim.state().await.unwrap();
    assert_eq!(state.robot_mode, RobotMode::Idle);
    for (before, now) in before.iter().zip(state.q) {
        assert!((before - now).abs() < 1e-6, "the arm has moved");
    }
    small_motion(&robot).await.expect("the next one works");
    drop(arm);
    let closed = tokio::spawn({
        let robot = robot.clone();
        async move { robot.closed().await }
    });
    robot.shutdown().await;
    assert_eq!(closed.await.unwrap(), CloseReason::ClosedByUs);
    let end = async { while states.changed().await.is_ok() {} };
    timeout(SOON, end).await.expect("they end");
    let closed = |kind: &EventKind| matches!(kind, EventKind::Closed { .. }).then_some(());
    told(&mut events, closed).await;
    assert!(events.next().await.is_none());
    assert_eq!(robot.health().newest().condition, Condition::Closed);
}

/// At rest, so that the robot does not count missing commands. The cut is longer than the link
/// timeout, and than the supervisor's patience.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn cut_network_is_told_and_its_connection_given_up() {
    let _alone = alone();
    let mut network = franka_sim::Network::perfect();
    let cut = Duration::from_secs(2)..Duration::from_secs(4);
    network.to_client.cut(cut);
    let sim = Sim::fr3().ideal().tool(Tool::hand()).network(network);
    let sim = sim.start().await.expect("it starts");
    let builder = Robot::builder(sim.addr())
        .realtime(Realtime::Ignore)
        .link_timeout(Duration::from_millis(300))
        .connect_timeout(Duration::from_millis(300));
    let silence = Duration::from_millis(300);
    let robot = builder.supervise(policy().silence(silence)).connect().await;
    let robot = robot.expect("the network is there");
    let mut events = robot.events();
    let silent = |kind: &EventKind| matches!(kind, EventKind::Silent { .. }).then_some(());
    told(&mut events, silent).await;
    let lost = |kind: &EventKind| match kind {
        EventKind::Lost { reason } => Some(reason.clone()),
        _ => None,
    };
    let reason = told(&mut events, lost).await;
    assert!(matches!(reason, CloseReason::Silent { .. }), "{reason}");
    let after = told(&mut events, connected).await;
    assert!(after > silence, "{after:?}");
    condition(&robot, Condition::Ready).await;
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn settings_hold_on_a_restarted_robot() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    let load = Load {
        m_load: 0.05,
        F_x_Cload: [0.0, 0.0, 0.05],
        I_load: [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1e-3],
    };
    let tool = Pose::translation(0.0, 0.0, 0.05);
    robot
        .set_load(Load {
            m_load: 0.02,
            ..load
        })
        .await
        .unwrap();
    robot.set_load(load).await.unwrap();
    robot.set_ee(tool).await.unwrap();
    let thresholds = CollisionBehavior::careful();
    robot.set_collision_behavior(thresholds).await.unwrap();
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let sim = restart(address).await;
    condition(&robot, Condition::Ready).await;
    let state = sim.state().await.unwrap();
    assert_eq!((state.m_load, state.F_x_Cload), (0.05, load.F_x_Cload));
    assert!(
        (state.NE_T_EE[14] - 0.05).abs() < 1e-6,
        "{:?}",
        state.NE_T_EE
    );
    small_motion(&robot).await.expect("it begins");

    // A robot that refuses the load gets no motion until it gets another load.
    let mut events = robot.events();
    sim.stop().await;
    let sim = timeout(SOON, async {
        loop {
            let light = |config: &mut franka_sim::Config| {
                config.unpublished.setter_bounds.mass = 0.03;
            };
            let sim = Sim::fr3().ideal().tool(Tool::hand()).configure(light);
            match sim.virtual_time(PATIENCE).bind(address).start().await {
                Ok(sim) => return sim,
                Err(_) => sleep(Duration::from_millis(5)).await,
            }
        }
    });
    let sim = sim.await.expect("the port is free again");
    let not_set = |kind: &EventKind| match kind {
        EventKind::NotConfigured { command, .. } => Some(*command),
        _ => None,
    };
    assert_eq!(told(&mut events, not_set).await, Command::SetLoad);
    let why = Unready::NotConfigured(Command::SetLoad);
    condition(&robot, Condition::Unready(why)).await;
    let waited = Duration::ZERO;
    let refused = small_motion(&robot).await.unwrap_err();
    assert_eq!(refused, MotionError::NotReady { why, waited });
    robot
        .set_load(Load {
            m_load: 0.02,
            ..load
        })
        .await
        .unwrap();
    condition(&robot, Condition::Ready).await;
    let state = sim.state().await.unwrap();
    assert!(
        (state.NE_T_EE[14] - 0.05).abs() < 1e-6,
        "{:?}",
        state.NE_T_EE
    );
    small_motion(&robot).await.expect("it begins");
    robot.shutdown().await;
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn another_robot_in_the_place_of_the_first_is_refused() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    sim.stop().await;
    let _other = started_at(address, || Sim::fer().ideal()).await;
    let reason = timeout(SOON, robot.closed()).await.expect("it gives up");
    assert!(
        matches!(reason, CloseReason::AnotherRobot { .. }),
        "{reason}"
    );
    let error = robot.move_to(robot.pose()).await.unwrap_err();
    assert!(matches!(error, MotionError::ConnectionClosed { .. }));
}

/// Returns how a robot differs if `second`, without a tool, answers at the address of `first`.
async fn differences(first: impl Fn() -> Sim, second: impl Fn() -> Sim) -> Differences {
    let sim = start(first()).await;
    let address = sim.addr();
    let builder = Robot::builder(address).realtime(Realtime::Ignore);
    let builder = builder.nominal_model(true).supervise(policy());
    let robot = builder.connect().await.expect("it takes a client");
    let mut events = robot.events();
    sim.stop().await;
    let sim = started_at(address, || second().ideal().tool(Tool::NONE)).await;
    let differences = |kind: &EventKind| match kind {
        EventKind::Unrecognised { differences } => Some(*differences),
        _ => None,
    };
    let differences = told(&mut events, differences).await;
    robot.shutdown().await;
    sim.stop().await;
    differences
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn robots_whose_model_is_not_used_are_compared_by_it() {
    let _alone = alone();
    let fer = |library: Option<u8>| {
        let library = library.map(|byte| vec![byte; 2 << 20].into());
        move || Sim::fer().configure(|config| config.model_library = library.clone())
    };
    let fr3 = |remark: &'static str| {
        let as_described = franka_sim::Robot::new(Config::default());
        let urdf = as_described
            .description()
            .map(|text| format!("{text}{remark}"));
        move || Sim::fr3().configure(|config| config.urdf = urdf.clone())
    };
    let retooled = differences(fer(Some(1)), fer(Some(1))).await;
    assert!(retooled.frames && !retooled.description, "{retooled}");
    assert!(!differences(fer(None), fer(None)).await.description);
    for (first, second) in [(Some(1), Some(2)), (Some(1), None), (None, Some(2))] {
        let differences = differences(fer(first), fer(second)).await;
        assert!(differences.description, "{first:?}, {second:?}");
    }
    assert!(!differences(fr3(""), fr3("")).await.description);
    assert!(differences(fr3(""), fr3("<!-- -->")).await.description);
}

/// A robot that describes other lengths than those that it computes its poses with.
fn at_odds(tool: Tool) -> Sim {
    let as_described = franka_sim::Robot::new(Config::default());
    let urdf = as_described.description().map(str::to_owned);
    let sim = Sim::fr3().ideal().virtual_time(PATIENCE).tool(tool);
    sim.state_geometry(StateGeometry::RECORDED_FR3)
        .configure(|config| config.urdf = urdf)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn robot_back_without_a_pose_is_the_same_robot() {
    let _alone = alone();
    let sim = at_odds(Tool::hand()).start().await.expect("it starts");
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    let found = robot.geometry_check();
    assert_eq!(found.described, Lengths::DESCRIBED);
    assert_eq!(found.used, Lengths::RECORDED_FR3);
    let mut events = robot.events();
    sim.stop().await;

    let mut unreported = Tool::hand();
    unreported.f_t_ne[(0, 0)] = 2.0; // No rotation, and none in the robot's report.
    let sim = started_at(address, || at_odds(unreported)).await;
    told(&mut events, connected).await;
    let after = robot.geometry_check();
    assert_eq!(after.residual, None, "{after}");
    assert_eq!((after.described, after.used), (found.described, found.used));
    assert!(after.to_string().contains("0.3162 m"), "{after}");
    assert_eq!(robot.model().lengths(), &found.used);
    robot.shutdown().await;
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_robot_with_poses_of_other_lengths_is_another_one() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    sim.stop().await;
    let _other = started_at(address, || at_odds(Tool::hand())).await;
    let reason = timeout(SOON, robot.closed()).await.expect("it gives up");
    let text = reason.to_string();
    assert!(
        matches!(reason, CloseReason::AnotherRobot { .. }) && text.contains("link lengths"),
        "{text}"
    );
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn last_handle_ends_supervisor_even_when_disconnected() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    drop(robot);
    let closed = |kind: &EventKind| match kind {
        EventKind::Closed { reason } => Some(reason.clone()),
        _ => None,
    };
    assert_eq!(told(&mut events, closed).await, CloseReason::ClosedByUs);

    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    drop(robot);
    assert_eq!(told(&mut events, closed).await, CloseReason::ClosedByUs);
    let sim = restart(address).await;
    sleep(Duration::from_millis(300)).await;
    assert!(!sim.with(|robot| robot.is_connected()).await.unwrap());

    let robot = supervised(&sim, policy()).await;
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    timeout(SOON, robot.shutdown()).await.expect("no hang");
    assert_eq!(robot.closed().await, CloseReason::ClosedByUs);
}
