use franka_model::{READY, RobotKind};
use franka_proto::framing::next_message;
use franka_proto::{Request, RobotError as E, RobotMode, SetterStatus, Status, Version, client};
use franka_sim::{Config, Robot, SessionError};

use crate::pair::{Pair, positions, stay};

#[test]
fn a_client_of_protocol_5_connects_to_a_robot_of_protocol_5() {
    for (kind, version) in [
        (RobotKind::Fr3, Version::V10),
        (RobotKind::Fer, Version::V5),
    ] {
        let mut pair = Pair::of(kind);
        assert_eq!(pair.robot.version(), version);
        // The client decodes with the layout of this version only.
        let first = pair.state.message_id;
        pair.idle(3);
        assert_eq!(pair.state.message_id, first + 3);
        pair.start_joints();
        pair.tick(Some(positions(&READY)));
        assert_eq!(pair.state.robot_mode, RobotMode::Move);
    }
}

#[test]
fn connect_checks_the_version_and_tells_its_own() {
    for (kind, own, other) in [
        (RobotKind::Fr3, 10, Version::V5),
        (RobotKind::Fer, 5, Version::V10),
    ] {
        let mut robot = Robot::new(Config {
            kind,
            ..Config::default()
        });
        robot.connect();
        let mut client = client::Session::new(other);
        let announced = other.number();
        assert_eq!(
            robot.receive(client.connect(5000).as_bytes()),
            Err(SessionError::Incompatible { announced })
        );
        let reply = robot.take_reply().expect("an answer before the goodbye");
        let message = next_message(&reply).expect("whole").expect("complete");
        let event = client.on_message(message).expect("an answer");
        assert!(matches!(event, client::Event::Incompatible(v) if v.server_version == own));
        assert!(robot.connect(), "its place is free");
        assert!(robot.tick().is_none(), "no state before a handshake");
    }
}

#[test]
fn second_client_is_refused_instead_of_queued() {
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(async {
        use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
        use tokio::net::TcpStream;
        use tokio::time::{Duration, timeout};

        let sim = franka_sim::Sim::fr3()
            .ideal()
            .start()
            .await
            .expect("a robot");
        let mut hello = client::Session::new(Version::V10);
        let hello = hello.connect(5000);
        let mut first = TcpStream::connect(sim.addr()).await.expect("a listener");
        first.write_all(hello.as_bytes()).await.expect("room");
        first.read_exact(&mut [0; 15]).await.expect("a seat");
        let mut second = TcpStream::connect(sim.addr()).await.expect("a listener");
        second.write_all(hello.as_bytes()).await.expect("room");
        let refused = timeout(Duration::from_secs(30), second.read(&mut [0; 15])).await;
        // The stream ends, or is reset because of unread bytes.
        assert!(!matches!(refused.expect("no wait"), Ok(1..)));
        sim.stop().await;
    });
}

#[test]
fn a_status_reply_has_thirteen_bytes() {
    for mut pair in [Pair::fr3(), Pair::fer()] {
        pair.sizes.clear();
        let status = pair.ask(&Request::SetJointImpedance([1000.0; 7]));
        assert_eq!(status, Status::Setter(SetterStatus::Success));
        pair.ask(&Request::AutomaticErrorRecovery);
        pair.ask_to_move();
        assert_eq!(pair.sizes, [13; 3]);
    }
}

#[test]
fn lateness_counts_in_states_that_wait_for_no_command() {
    let mut pair = Pair::fr3();
    pair.start_joints();
    pair.tick(Some(positions(&READY)));
    let before = pair.state.message_id;
    // Without commands, each call still returns a state.
    pair.idle(19);
    assert_eq!(pair.state.message_id, before + 19);
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    pair.tick(None);
    assert!(
        pair.state
            .errors
            .contains(E::CommunicationConstraintsViolation)
    );
}

#[test]
fn a_late_command_is_dropped_and_the_first_one_begins_the_count() {
    for first in [Some(positions(&READY)), None] {
        let mut pair = Pair::fr3();
        let id = pair.start_joints();
        // No cycle counts before the first command.
        pair.idle(50);
        pair.tick(first);
        for _ in 0..20 {
            assert_eq!(pair.state.robot_mode, RobotMode::Move);
            let mut late = stay(&pair.state);
            late.message_id = pair.state.message_id - 1;
            pair.datagram(&late);
            pair.tick(None);
        }
        pair.assert_reflex(id, &[E::CommunicationConstraintsViolation]);
    }
}

#[test]
fn success_rate_covers_100_cycles_and_is_zero_at_the_end() {
    let mut pair = Pair::fr3();
    pair.start_joints();
    assert_eq!(pair.state.control_command_success_rate, 0.0);
    for cycle in 0..300 {
        let command = (cycle % 10 != 9).then(|| positions(&READY));
        pair.tick(command);
    }
    let rate = pair.state.control_command_success_rate;
    assert!((rate - 0.9).abs() < 1e-6, "{rate}");
    pair.idle(20);
    assert_eq!(pair.state.robot_mode, RobotMode::Reflex);
    assert_eq!(pair.state.control_command_success_rate, 0.0);
}
