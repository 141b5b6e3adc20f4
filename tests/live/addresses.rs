//! Robots at addresses of either family, and by name.

use std::net::{Ipv6Addr, SocketAddr, SocketAddrV6};
use std::time::Duration;

use franka_async::connection::Endpoint;
use franka_async::error::{ConnectError, Party};
use franka_async::gripper::Gripper;
use franka_async::supervision::Policy;
use franka_async::{Pose, Realtime, Robot};
use franka_sim::{Fingers, Sim, Tool};
use franka_tests::PATIENCE;

use crate::alone;

/// Connects to `endpoint`, moves the arm by a centimetre, and ends the connection.
async fn moves(endpoint: impl Into<Endpoint>) -> SocketAddr {
    let builder = Robot::builder(endpoint).realtime(Realtime::Ignore);
    let robot = builder.connect().await.expect("a simulator takes a client");
    let up = Pose::translation(0.0, 0.0, 0.01) * robot.pose();
    let report = robot.move_to(up).await.expect("it arrives");
    let left = report.final_error.expect("a target").translation;
    assert!(left < 1e-3, "{left} m left");
    assert!(robot.stats().commands.get() > 100);
    let address = robot.address();
    robot.shutdown().await;
    address
}

/// Connects, moves and ends on every way to say where a robot is that listens on `bind`.
async fn moves_on(bind: SocketAddr, texts: impl Fn(u16) -> Vec<String>) {
    let sim = Sim::fr3()
        .ideal()
        .tool(Tool::hand())
        .hand(Fingers::new(), 0)
        .bind(bind)
        .virtual_time(PATIENCE)
        .start()
        .await
        .expect("a simulator starts");
    assert_eq!(moves(sim.addr()).await, sim.addr());
    for text in texts(sim.addr().port()) {
        assert_eq!(moves(text.as_str()).await, sim.addr(), "{text}");
    }
    let hand = Gripper::connect(sim.hand().expect("one").addr()).await;
    let hand = hand.expect("a hand takes a client");
    assert!(hand.homing().await.expect("it homes"));
    drop(hand);
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_arm_moves_over_ipv6() {
    let _alone = alone();
    let bind = (Ipv6Addr::LOCALHOST, 0).into();
    moves_on(bind, |port| vec![format!("[::1]:{port}")]).await;
}

/// The link-local address, which is ambiguous without the name or the index of its interface.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_arm_moves_over_a_link_local_address() {
    let _alone = alone();
    let Some((ip, index, interface)) = link_local() else {
        println!("not tried: no interface of this host has a link-local address");
        return;
    };
    let bind = SocketAddrV6::new(ip, 0, 0, index).into();
    moves_on(bind, |port| {
        vec![
            format!("[{ip}%{interface}]:{port}"),
            format!("[{ip}%{index}]:{port}"),
        ]
    })
    .await;
}

/// A link-local address of this host, the index and the name of its interface. Columns of
/// `/proc/net/if_inet6`: address, index, prefix length, scope (0x20 for a link), flags, name.
fn link_local() -> Option<(Ipv6Addr, u32, String)> {
    let table = std::fs::read_to_string("/proc/net/if_inet6").ok()?;
    table.lines().find_map(|line| {
        let columns: Vec<&str> = line.split_whitespace().collect();
        let [address, index, _, "20", _, name] = columns[..] else {
            return None;
        };
        let address = u128::from_str_radix(address, 16).ok()?;
        let index = u32::from_str_radix(index, 16).ok()?;
        Some((Ipv6Addr::from(address), index, name.to_owned()))
    })
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_arm_moves_by_its_host_name() {
    let _alone = alone();
    let bind = ([127, 0, 0, 1], 0).into();
    moves_on(bind, |port| vec![format!("localhost:{port}")]).await;
}

/// A simulator for both families sees an IPv4 client under a mapped address; the client sees an
/// IPv4 robot.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_simulator_for_both_families_serves_both() {
    let _alone = alone();
    let sim = Sim::fr3().ideal().bind((Ipv6Addr::UNSPECIFIED, 0).into());
    let sim = sim.virtual_time(PATIENCE).start().await;
    let sim = sim.expect("a simulator starts");
    let port = sim.addr().port();
    for text in ["127.0.0.1", "[::1]", "[::ffff:127.0.0.1]"] {
        let address = moves(format!("{text}:{port}")).await;
        assert_eq!(address.port(), port);
    }
    sim.stop().await;
}

#[tokio::test]
async fn invalid_address_is_refused_before_anything_is_sent() {
    let _alone = alone();
    let connect = async |endpoint: &str| {
        let builder = Robot::builder(endpoint).realtime(Realtime::Ignore);
        builder.connect().await.expect_err("no server is there")
    };
    for endpoint in ["", "robot:fci", "172.16.2", "fd00:::2", "fe80::2%nowhere0"] {
        let error = connect(endpoint).await;
        assert!(
            matches!(error, ConnectError::Endpoint(_)),
            "{endpoint}: {error}"
        );
        assert_eq!(error.party().to_string(), "caller", "{error}");
    }
}

#[tokio::test]
async fn a_log_of_more_than_ten_seconds_is_refused_with_the_bound() {
    let _alone = alone();
    for (cycles, refused) in [(10_000, false), (10_001, true), (usize::MAX, true)] {
        // No server is needed there.
        let builder = Robot::builder("127.0.0.1:1").log_size(cycles);
        let builder = builder.realtime(Realtime::Ignore);
        let error = builder.connect().await.expect_err("nothing listens");
        if refused {
            let text = format!("the log has {cycles} cycles, expected 10000 at most");
            assert_eq!(error.to_string(), text);
            assert_eq!(error.party(), Party::Caller);
        } else {
            assert!(!matches!(error, ConnectError::LogSize { .. }), "{error}");
        }
    }
}

#[tokio::test]
async fn a_question_before_recoveries_needs_a_policy() {
    let _alone = alone();
    for (is_supervised, refused) in [(true, false), (false, true)] {
        // No server is needed there.
        let builder = Robot::builder("127.0.0.1:1").realtime(Realtime::Ignore);
        let builder = match is_supervised {
            true => builder.supervise(Policy::default()),
            false => builder,
        };
        let asking = builder.ask_before_recovery(|_| true);
        let error = asking.connect().await.expect_err("nothing listens");
        let is_refused = matches!(error, ConnectError::Unsupervised);
        assert_eq!(is_refused, refused, "{error}");
    }
}

#[tokio::test]
async fn a_link_timeout_out_of_range_is_refused_with_the_range() {
    let _alone = alone();
    for timeout in [
        Duration::ZERO,
        Duration::from_millis(19),
        Duration::from_secs(11),
    ] {
        // No server is needed there.
        let builder = Robot::builder("127.0.0.1:1").link_timeout(timeout);
        let error = builder.connect().await.expect_err("out of range");
        assert_eq!(
            error.to_string(),
            format!("the link timeout is {timeout:?}, expected 20ms to 10s")
        );
        assert_eq!(error.party(), Party::Caller);
    }
}
