//! A cassette instead of a robot.

use std::path::{Path, PathBuf};
use std::time::Duration;

use franka_async::gripper::Gripper;
use franka_proto::{Load, Version};
use franka_record::cassette::{
    Cassette, CassetteServer, Device, Matching, PlayError, PlayOptions, PlayReport,
};

use crate::recorded::{
    Addresses, anywhere, connect, ends_in_a_reflex, moves, reflex, simulated, tap, tapped,
};

/// Time limit; longer means a hang, on a busy machine too.
const LIMIT: Duration = Duration::from_secs(20);

/// Plays a cassette to a client; returns the client's result.
async fn played<T>(
    cassette: Cassette,
    matching: Matching,
    client: impl AsyncFnOnce(Addresses) -> T,
) -> (T, Result<PlayReport, PlayError>) {
    let mut options = PlayOptions::default();
    options.matching = matching;
    // A machine that stops for a while changes no verdict.
    options.patience = LIMIT;
    let server = CassetteServer::start_at(cassette, anywhere, options);
    let server = server.expect("a playable cassette");
    let nowhere = anywhere(Device::Hand);
    let addresses = Addresses {
        robot: server.address(Device::Robot).expect("recorded"),
        hand: server.address(Device::Hand).unwrap_or(nowhere),
    };
    let outcome = client(addresses).await;
    let finish = move || server.finish(LIMIT);
    let report = tokio::task::spawn_blocking(finish).await;
    (outcome, report.expect("no panic"))
}

#[tokio::test(flavor = "multi_thread")]
async fn a_motion_and_a_hand_play_again_to_the_same_end() {
    for version in Version::ALL {
        let mut reached = None;
        let session = async |addresses: Addresses, _: &_| reached = Some(moves(addresses).await);
        let cassette = tapped(version, session).await;
        let (again, report) = played(cassette, Matching::Lenient, moves).await;
        let report = report.expect("played to its end");
        let devices: Vec<_> = report.played.iter().map(|(device, _)| *device).collect();
        assert!(devices.contains(&Device::Hand), "{devices:?}");
        let (_, arm) = report.played[devices.len() - 1];
        let reached = reached.expect("moved");
        for (one, other) in reached.iter().zip(again) {
            assert!((one - other).abs() < 1e-3, "{reached:?}, {again:?}: {arm}");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_reflex_plays_again_with_the_same_error() {
    for version in Version::ALL {
        let (cassette, text) = reflex(version).await;
        let client = async |addresses| ends_in_a_reflex(addresses, async || {}).await;
        let (again, report) = played(cassette, Matching::Lenient, client).await;
        assert_eq!(again, text);
        report.expect("played to its end");
    }
}

/// Recorded reflexes that must end in the same way with every later driver. With
/// `FRANKA_WRITE_CASSETTES` set, the test records them again.
#[tokio::test(flavor = "multi_thread")]
async fn committed_cassettes_end_as_they_did() {
    let expected =
        "libfranka: Move command aborted: motion aborted by reflex! [\"cartesian_reflex\"]";
    for version in Version::ALL {
        let path = committed(version);
        if std::env::var_os("FRANKA_WRITE_CASSETTES").is_some() {
            let (cassette, _) = reflex(version).await;
            std::fs::write(&path, cassette.to_bytes().unwrap()).expect("a writable folder");
        }
        let cassette = Cassette::open(&path).expect("committed");
        assert_eq!(cassette.damage, None);
        let client = async |addresses| ends_in_a_reflex(addresses, async || {}).await;
        let (text, report) = played(cassette, Matching::Lenient, client).await;
        assert!(text.starts_with(expected), "{text}");
        report.expect("played to its end");
    }
}

pub(crate) fn committed(version: Version) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cassettes");
    folder.join(format!("reflex_v{version}.mcap"))
}

/// Sets a load of this mass; the robot may be gone before it answers.
async fn sets_load(addresses: Addresses, mass: f64) {
    let robot = connect(addresses).await;
    let load = Load {
        m_load: mass,
        ..Load::default()
    };
    let _ = robot.set_load(load).await;
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_strict_play_compares_parameters_and_a_lenient_one_does_not() {
    let version = Version::V10;
    let session = async |addresses: Addresses, _: &_| sets_load(addresses, 0.5).await;
    let cassette = tapped(version, session).await;

    let same = async |addresses| sets_load(addresses, 0.5).await;
    let ((), report) = played(cassette.clone(), Matching::Strict, same).await;
    report.expect("the recorded requests");

    let other = async |addresses| sets_load(addresses, 0.25).await;
    let ((), report) = played(cassette.clone(), Matching::Lenient, other).await;
    report.expect("the recorded kinds of request");

    let other = async |addresses| sets_load(addresses, 0.25).await;
    let ((), report) = played(cassette, Matching::Strict, other).await;
    let PlayError::Mismatch(mismatch) = report.expect_err("another load") else {
        panic!("another error")
    };
    assert!(
        mismatch.got.starts_with("Set Load with other parameters"),
        "{mismatch}"
    );
    assert_eq!(mismatch.expected, "Set Load");
}

#[tokio::test(flavor = "multi_thread")]
async fn another_request_is_named_beside_the_recorded_one() {
    let session = async |addresses: Addresses, _: &_| sets_load(addresses, 0.5).await;
    let cassette = tapped(Version::V10, session).await;
    let recovers = async |addresses| {
        let robot = connect(addresses).await;
        let _ = robot.recover().await;
        robot.shutdown().await;
    };
    let ((), report) = played(cassette, Matching::Lenient, recovers).await;
    let error = report.expect_err("another request").to_string();
    assert_eq!(
        error,
        "the client of the robot differs from the recording: got Automatic Error Recovery, \
         expected Set Load"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn tap_ends_connections_with_the_robot_and_keeps_its_file() {
    let sim = simulated(Version::V10).await;
    let (tap, addresses, path) = tap(&sim);
    let robot = connect(addresses).await;
    let hand = Gripper::connect(addresses.hand).await;
    drop(sim);
    let lost = robot.set_joint_impedance([2000.0; 7]).await;
    assert!(lost.is_err());
    drop((robot, hand));
    let report = tap.finish().expect("the file can be written");
    assert_eq!(report.connections, 2);
    let cassette = Cassette::open(&path).expect("just written");
    std::fs::remove_file(path).expect("just written");
    assert_eq!(cassette.damage, None);
}
