//! Sessions of the driver with the simulator through a tap.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use franka_async::gripper::Gripper;
use franka_async::state::RobotError;
use franka_async::{Realtime, Robot};
use franka_proto::Version;
use franka_record::cassette::{Cassette, Device, Route, Tap};
use franka_sim::{Fingers, Running, Sim};
use franka_tests::PATIENCE;

/// Any free port of this machine.
pub(crate) fn anywhere(_: Device) -> SocketAddr {
    (Ipv4Addr::LOCALHOST, 0).into()
}

/// The addresses of an arm and its hand, for any server.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Addresses {
    pub(crate) robot: SocketAddr,
    pub(crate) hand: SocketAddr,
}

/// A simulated robot with a hand, which waits for the client's commands.
pub(crate) async fn simulated(version: Version) -> Running {
    let sim = match version {
        Version::V5 => Sim::fer(),
        Version::V10 => Sim::fr3(),
    };
    let sim = sim.ideal().hand(Fingers::new(), 0);
    let sim = sim.wait_for_commands(PATIENCE).start().await;
    sim.expect("a simulator starts")
}

/// Records a session with a simulator.
pub(crate) async fn tapped(
    version: Version,
    session: impl AsyncFnOnce(Addresses, &Running),
) -> Cassette {
    let sim = simulated(version).await;
    let (tap, addresses, path) = tap(&sim);
    session(addresses, &sim).await;
    let report = tap.finish().expect("the file can be written");
    let cassette = Cassette::open(&path).expect("just written");
    std::fs::remove_file(path).expect("just written");
    assert_eq!(cassette.damage, None);
    assert_eq!(cassette.dropped, report.dropped);
    assert_eq!(cassette.connections.len(), report.connections);
    let events = cassette.connections.iter().map(|one| one.events.len());
    assert_eq!(events.sum::<usize>() as u64, report.events);
    cassette
}

/// A tap in front of a simulator, and its new file.
pub(crate) fn tap(sim: &Running) -> (Tap, Addresses, PathBuf) {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = format!("franka-cassette-{}-{number}.mcap", std::process::id());
    let path = std::env::temp_dir().join(name);
    let hand = sim.hand().expect("a hand").addr();
    let routes = [(Device::Robot, sim.addr()), (Device::Hand, hand)];
    let routes = routes.map(|(device, robot)| Route {
        device,
        listen: anywhere(device),
        robot,
    });
    let tap = Tap::start(&routes, &path).expect("free ports and a new file");
    let at = |device| tap.address(device).expect("a route");
    let addresses = Addresses {
        robot: at(Device::Robot),
        hand: at(Device::Hand),
    };
    (tap, addresses, path)
}

/// Connects the driver.
pub(crate) async fn connect(addresses: Addresses) -> Robot {
    let robot = Robot::builder(addresses.robot).realtime(Realtime::Ignore);
    robot.connect().await.expect("a robot answers")
}

/// Sets parameters, moves joints and the hand, and returns where the joints end.
pub(crate) async fn moves(addresses: Addresses) -> [f64; 7] {
    let robot = connect(addresses).await;
    let hand = Gripper::connect(addresses.hand).await;
    let hand = hand.expect("a hand answers");
    robot
        .set_joint_impedance([2000.0; 7])
        .await
        .expect("allowed values");
    let mut q = robot.state().q;
    q[6] += 0.02;
    let report = robot.move_joints(q).await.expect("it arrives");
    assert!(report.duration.as_millis() > 50, "{report:?}");
    assert!(hand.stop().await.expect("a stop"));
    let reached = robot.state().q;
    assert!((reached[6] - q[6]).abs() < 5e-3, "{reached:?} for {q:?}");
    robot.shutdown().await;
    drop(hand);
    reached
}

/// Moves until a reflex, which `trip` causes, and returns the error's text.
pub(crate) async fn ends_in_a_reflex(addresses: Addresses, trip: impl AsyncFnOnce()) -> String {
    let robot = connect(addresses).await;
    let mut q = robot.state().q;
    q[6] += 0.5;
    // Before the motion, because the cassette may end before this task continues.
    let mut states = robot.state_stream();
    let motion = robot.move_joints(q).speed(0.1).into_future();
    let motion = tokio::spawn(motion);
    while !states
        .next()
        .await
        .expect("connected")
        .state
        .motion_running()
    {}
    for _ in 0..20 {
        states.next().await.expect("connected");
    }
    trip().await;
    let error = motion.await.expect("no panic").expect_err("a reflex");
    robot.shutdown().await;
    error.to_string()
}

/// A session that a reflex ends, and the text of its error.
pub(crate) async fn reflex(version: Version) -> (Cassette, String) {
    let mut text = String::new();
    let cassette = tapped(version, async |addresses, sim| {
        let trip = async || {
            let tripped = sim.with(|robot| robot.trip(RobotError::CartesianReflex));
            tripped.await.expect("the simulator runs");
        };
        text = ends_in_a_reflex(addresses, trip).await;
    });
    (cassette.await, text)
}
