//! Teleoperation over WebSockets: the lease, and its end with its client.

use std::net::TcpStream;
use std::time::Instant;

use franka_async::state::{RobotError, RobotMode};
use nix::sys::signal::Signal;
use serde_json::{Value, json};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

use crate::arm::{Arm, SOON};
use crate::program::Beside;

/// A client in this process.
struct Client(WebSocket<MaybeTlsStream<TcpStream>>);

impl Client {
    fn connect(address: &str) -> Self {
        let url = format!("ws://{address}/teleoperation");
        Self(tungstenite::connect(url).expect("a socket").0)
    }

    fn send(&mut self, message: Value) {
        self.0
            .send(message.to_string().into())
            .expect("the service reads");
    }

    /// Returns the next message of any type.
    fn receive(&mut self) -> Value {
        loop {
            let message = self.0.read().expect("the service goes on");
            if let Message::Text(text) = message {
                return serde_json::from_str(&text).expect("JSON");
            }
        }
    }

    /// Returns the next message that is not a state.
    fn answer(&mut self) -> Value {
        loop {
            let message = self.receive();
            if message["type"] != "state" {
                return message;
            }
        }
    }

    /// Takes the lease as soon as it is free.
    fn take(&mut self) {
        let end = Instant::now() + SOON;
        while Instant::now() < end {
            self.send(json!({ "type": "take" }));
            let answer = self.answer();
            if answer["type"] == "taken" {
                return;
            }
            let why = answer["why"].as_str().expect("a reason");
            assert!(why.contains("holds the lease"), "{why}");
        }
        panic!("the lease was never free");
    }

    /// Returns the newest state, with `z` metres added to its position, as a target.
    fn target_above(&mut self, z: f64) -> Value {
        let mut target = loop {
            let message = self.receive();
            if message["type"] == "state" {
                break message;
            }
        };
        target["type"] = "target".into();
        target["position"][2] = (target["position"][2].as_f64().expect("a number") + z).into();
        target
    }
}

/// Starts a service whose leases allow this silence, `[s]`.
fn serve(arm: &Arm, silence: &str) -> (Beside, String) {
    Beside::serve("axum_teleoperation", &arm.address, &["--silence", silence])
}

#[test]
fn one_socket_has_the_lease_until_it_is_killed() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = serve(&arm, "60");
    let mut leader = Beside::start("client", &["lead", &address]);
    leader.said("leading");
    arm.wait_until_it_moves();
    let mut other = Client::connect(&address);
    assert_eq!(other.receive()["mode"], "Move", "everyone sees the states");
    for (request, refused) in [
        ("take", "\"the client\" holds the lease"),
        ("recover", "\"the client\" holds the lease"),
        ("release", "this socket does not have the lease"),
        ("alive", "this socket does not have the lease"),
    ] {
        other.send(json!({ "type": request }));
        let answer = other.answer();
        let why = answer["why"].as_str().expect("a reason");
        assert!(why.starts_with(refused), "{request}: {answer}");
    }
    // The lease does not end because of silence, which would take a minute.
    leader.kill();
    other.take();
    other.send(json!({ "type": "release" }));
    assert_eq!(other.answer()["type"], "released");
    arm.rests();
}

#[test]
fn a_frozen_client_loses_the_lease_and_the_arm_brakes() {
    let arm = Arm::by_the_clock("fer");
    let (_service, address) = serve(&arm, "0.5");
    let mut leader = Beside::start("client", &["lead", &address]);
    leader.said("leading");
    arm.wait_until_it_moves();
    leader.signal(Signal::SIGSTOP);
    arm.rests();
    Client::connect(&address).take();
    leader.signal(Signal::SIGCONT);
}

#[test]
fn a_silent_socket_is_told_that_its_lease_is_lost() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = serve(&arm, "1");
    let mut client = Client::connect(&address);
    client.take();
    let target = client.target_above(0.05);
    client.send(target);
    // The automatic answers of its library keep nothing alive.
    client
        .0
        .send(Message::Ping("".into()))
        .expect("the service reads");
    let lost = client.answer();
    assert_eq!(lost["type"], "lost", "{lost}");
    assert!(
        lost["why"]
            .as_str()
            .is_some_and(|why| why.contains("without a heartbeat")),
        "{lost}"
    );
    arm.rests();
    client.take();
}

#[test]
fn stop_is_open_to_every_socket_and_ends_the_lease() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = serve(&arm, "60");
    let mut leader = Beside::start("client", &["lead", &address]);
    leader.said("leading");
    arm.wait_until_it_moves();
    let mut other = Client::connect(&address);
    other.send(json!({ "type": "stop" }));
    assert_eq!(other.answer()["type"], "stopped");
    arm.rests();
    assert!(
        !leader.ended().success(),
        "it is told that its lease is lost"
    );
    other.take();
}

#[test]
fn refused_target_ends_nothing_and_reflex_is_explained() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = serve(&arm, "60");
    let mut client = Client::connect(&address);
    client.take();
    let start = arm.state();
    let wild = client.target_above(3.0);
    client.send(wild);
    let refused = client.answer();
    assert_eq!(refused["type"], "refused", "{refused}");
    client.send(json!("nonsense"));
    assert_eq!(client.answer()["type"], "refused");
    let target = client.target_above(0.05);
    client.send(target);
    arm.wait_for("there", |state| state.O_T_EE[14] - start.O_T_EE[14] > 0.045);
    arm.trip(RobotError::CartesianReflex);
    let lost = client.answer();
    assert_eq!(lost["type"], "lost", "{lost}");
    assert!(
        lost["why"]
            .as_str()
            .is_some_and(|why| why.contains("cartesian_reflex")),
        "{lost}"
    );
    assert_eq!(arm.state().robot_mode, RobotMode::Reflex);
}

#[test]
fn a_service_that_is_told_to_end_rests_an_arm_that_is_led() {
    let arm = Arm::by_the_clock("fr3");
    let deadline = ["--deadline", "60", "--silence", "60"];
    let (mut service, address) = Beside::serve("axum_teleoperation", &arm.address, &deadline);
    let mut leader = Beside::start("client", &["lead", &address]);
    leader.said("leading");
    arm.wait_until_it_moves();
    service.signal(Signal::SIGTERM);
    assert!(service.ended().success());
    arm.rests();
    assert!(!leader.ended().success(), "its socket was closed");
}
