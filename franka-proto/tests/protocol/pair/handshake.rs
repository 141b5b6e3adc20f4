//! The handshake: compatible and incompatible versions.

use franka_proto::framing::next_message;
use franka_proto::{
    Command, CommandId, ConnectStatus, IncompatibleVersion, Reply, Request, RequestError, Version,
    Violation, client, server,
};

use super::{Pair, joint_motion, message, raw_reply};

#[test]
fn another_version_is_told_and_can_be_followed() {
    let mut pair = Pair::new(Version::V10, Version::V5);
    let hello = pair.client.connect(1);
    let event = pair.deliver(&hello).unwrap();
    let server::Event::Incompatible { version, reply } = event else {
        panic!("{event:?}");
    };
    assert_eq!(version, 10);
    let event = pair.client.on_message(message(&reply)).unwrap();
    let incompatible = IncompatibleVersion {
        server_version: 5,
        library_version: Version::V10,
    };
    assert_eq!(event, client::Event::Incompatible(incompatible));
    assert!(!pair.client.is_connected() && !pair.server.is_connected());
    // A fresh connection with the robot's version.
    let version = Version::from_number(incompatible.server_version).unwrap();
    Pair::connected(version);
}

#[test]
fn accepted_connect_of_another_version_is_a_violation() {
    let mut client = client::Session::new(Version::V10);
    client.connect(1);
    let bytes = raw_reply(0, &[0, 5, 0]);
    let error = client.on_message(next_message(&bytes).unwrap().unwrap());
    let expected = Violation::ForeignVersion {
        announced: 10,
        reported: 5,
    };
    assert_eq!(error, Err(expected));
    assert!(!client.is_connected());

    client.connect(1);
    let bytes = raw_reply(0, &[2, 10, 0]);
    let error = client.on_message(next_message(&bytes).unwrap().unwrap());
    assert_eq!(
        error.unwrap_err().to_string(),
        "libfranka: Protocol error during connection attempt"
    );
}

#[test]
fn requests_before_the_handshake_are_refused_on_both_sides() {
    let mut client = client::Session::new(Version::V10);
    let error = client.request(&Request::StopMove).unwrap_err();
    assert_eq!(error, RequestError::NotConnected);

    let stop = Request::StopMove
        .encode(Version::V10, CommandId(0))
        .unwrap();
    let mut pair = Pair::new(Version::V10, Version::V10);
    let got = Command::StopMove;
    assert_eq!(pair.deliver(&stop), Err(Violation::NotConnect { got }));
}

#[test]
fn connecting_again_starts_over() {
    let mut pair = Pair::connected(Version::V10);
    pair.request(&joint_motion());
    let hello = pair.client.connect(1);
    assert_eq!(hello.id(), CommandId(0));
    assert!(!pair.client.is_connected());
    let accepted = Reply::Connect {
        status: ConnectStatus::Success,
        version: 10,
    };
    assert!(accepted.suits(Command::Connect));
    let bytes = raw_reply(0, &[0, 10, 0]);
    let event = pair.receive(&bytes);
    let version = Version::V10;
    assert_eq!(event, Ok(client::Event::Connected { version }));
    assert_eq!(pair.client.pending(), 0);
}
