//! The dissector against franka-proto: every field of every message and datagram of a session, as
//! tshark prints it and as franka-proto decodes it.

use std::collections::BTreeMap;
use std::process::Command;
use std::time::Duration;

use franka_proto::{RobotCommand, RobotState, Version, gripper};
use franka_record::cassette::{Cassette, Connection, Device, Event, Payload, Side, pcap};
use serde_json::Value;

use crate::playing::committed;
use crate::recorded::{moves, tapped};
use crate::tables::dissector;

/// tshark's output for each frame: names of fields with their values.
type Frames = Vec<BTreeMap<String, Vec<String>>>;

/// Output of tshark for a capture with the dissector; `None` if tshark is not installed, or loads
/// no dissector.
fn tshark(cassette: &Cassette, name: &str, arguments: &[&str]) -> Option<String> {
    let path = std::env::temp_dir().join(format!("franka-{name}-{}.pcap", std::process::id()));
    std::fs::write(&path, pcap::to_capture(cassette)).expect("a writable folder");
    let output = Command::new("tshark")
        .args(arguments)
        .arg("-X")
        .arg(format!("lua_script:{}", dissector().display()))
        .arg("-r")
        .arg(&path)
        .output();
    std::fs::remove_file(&path).expect("just written");
    let output = match output {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            println!("skipped: tshark is not installed (apt install tshark)");
            return None;
        }
        output => output.expect("tshark runs"),
    };
    let complaints = String::from_utf8_lossy(&output.stderr);
    let root = complaints.contains("Running as user \"root\"");
    if root && complaints.contains("is not a valid protocol") {
        println!("skipped: this tshark loads no Lua as root");
        return None;
    }
    assert!(output.status.success(), "{complaints}");
    assert!(!complaints.to_lowercase().contains("lua"), "{complaints}");
    Some(String::from_utf8(output.stdout).expect("text"))
}

/// The frames of a capture that the dissector knows; `None` as [`tshark`].
fn dissected(cassette: &Cassette, name: &str) -> Option<Frames> {
    let arguments = ["-2", "-T", "json", "--no-duplicate-keys", "-Y", "franka"];
    let frames: Value = serde_json::from_str(&tshark(cassette, name, &arguments)?).expect("JSON");
    let frames = frames.as_array().expect("a list of frames").iter();
    Some(frames.map(fields).collect())
}

/// Without a filter tshark makes no tree in its first pass, as Wireshark does.
#[test]
fn the_dissector_knows_every_frame_without_a_filter() {
    for version in Version::ALL {
        let cassette = Cassette::open(committed(version)).expect("committed");
        let name = format!("unfiltered-{version}");
        let Some(frames) = dissected(&cassette, &name) else {
            return;
        };
        for passes in [&["-2"][..], &[]] {
            let listed = tshark(&cassette, &name, passes).expect("as with a filter");
            let known = listed.lines().filter(|line| line.contains("FRANKA"));
            assert_eq!(known.count(), frames.len(), "{version}, {passes:?}");
        }
    }
}

/// All fields of a frame, however deep in its tree.
fn fields(frame: &Value) -> BTreeMap<String, Vec<String>> {
    fn add(into: &mut BTreeMap<String, Vec<String>>, name: &str, value: &Value) {
        match value {
            Value::Object(tree) => tree.iter().for_each(|(name, value)| add(into, name, value)),
            Value::Array(values) => values.iter().for_each(|value| add(into, name, value)),
            Value::String(text) => into.entry(name.to_owned()).or_default().push(text.clone()),
            _ => {}
        }
    }
    let mut all = BTreeMap::new();
    add(&mut all, "", &frame["_source"]["layers"]);
    all
}

/// Asserts that the fields of a datagram are these of its JSON by serde.
fn assert_fields(
    version: Version,
    frame: &BTreeMap<String, Vec<String>>,
    prefix: &str,
    decoded: &Value,
) -> usize {
    let mut compared = 0;
    for (name, value) in decoded.as_object().expect("a struct") {
        let shown = frame.get(&format!("{prefix}.{name}"));
        let expected = numbers(value);
        let Some(expected) = expected else {
            continue; // an enumeration or a list of errors: see below
        };
        let newer = name.starts_with("accelerometer") || name == "torque_command_finished";
        if shown.is_none() && newer && version == Version::V5 {
            continue;
        }
        let shown = shown.unwrap_or_else(|| panic!("{prefix}.{name} is not shown"));
        assert_eq!(shown.len(), expected.len(), "{name}");
        for (shown, expected) in shown.iter().zip(expected) {
            let got: f64 = match shown.as_str() {
                "True" => 1.0,
                "False" => 0.0,
                text => text.parse().expect("a number"),
            };
            // tshark prints 15 digits.
            let tolerance = 1e-14 * expected.abs();
            assert!(
                (got - expected).abs() <= tolerance,
                "{name}: {got}, {expected}"
            );
            compared += 1;
        }
    }
    compared
}

/// The numbers of a value, nested or not; `None` if there are others.
fn numbers(value: &Value) -> Option<Vec<f64>> {
    match value {
        Value::Number(number) => Some(vec![number.as_f64()?]),
        Value::Bool(flag) => Some(vec![f64::from(u8::from(*flag))]),
        Value::Array(values) if !values.is_empty() => {
            let nested: Option<Vec<_>> = values.iter().map(numbers).collect();
            Some(nested?.concat())
        }
        _ => None,
    }
}

/// The datagrams of a connection in the order of a capture.
fn datagrams(connection: &Connection, from: Side) -> Vec<&[u8]> {
    connection.datagrams(from).map(|(_, bytes)| bytes).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_dissector_shows_what_franka_proto_decodes() {
    for version in Version::ALL {
        let session = async |addresses, _: &_| {
            moves(addresses).await;
        };
        let cassette = tapped(version, session).await;
        let Some(frames) = dissected(&cassette, &format!("moves-{version}")) else {
            return;
        };
        let robot = cassette
            .connections
            .iter()
            .rfind(|one| one.device == Device::Robot);
        let robot = robot.expect("a robot");
        let of = |field: &'static str| {
            let frames = frames.iter().filter(move |frame| frame.contains_key(field));
            frames.collect::<Vec<_>>()
        };

        let shown = of("franka.state.O_T_EE");
        let states = datagrams(robot, Side::Robot);
        assert_eq!(shown.len(), states.len());
        for (frame, bytes) in shown.iter().zip(states) {
            let state = RobotState::decode(version, bytes).expect("a state");
            let json = serde_json::to_value(state).expect("JSON");
            let compared = assert_fields(version, frame, "franka.state", &json);
            assert!(compared > 270, "{compared} numbers");
            let errors = frame
                .get("franka.state.error")
                .map_or(&[][..], Vec::as_slice);
            assert!(
                errors
                    .iter()
                    .eq(state.errors.iter().map(|error| error.name()))
            );
        }

        let shown = of("franka.command.tau_J_d");
        let commands = datagrams(robot, Side::Client);
        assert_eq!(shown.len(), commands.len());
        assert!(commands.len() > 50);
        for (frame, bytes) in shown.iter().zip(commands) {
            let command = RobotCommand::decode(version, bytes).expect("a command");
            let json = serde_json::to_value(command).expect("JSON");
            assert!(assert_fields(version, frame, "franka.command", &json) > 30);
            assert!(frame.contains_key("franka.turnaround"));
        }

        let hand = cassette
            .connections
            .iter()
            .find(|one| one.device == Device::Hand);
        let states = datagrams(hand.expect("a hand"), Side::Robot);
        let shown = of("franka.hand.state.width");
        assert_eq!(shown.len(), states.len());
        for (frame, bytes) in shown.iter().zip(states) {
            let state = gripper::State::decode(bytes).expect("a state");
            assert_eq!(frame["franka.hand.state.width"][0].parse(), Ok(state.width));
        }

        // Connect, the model of protocol 10, an impedance and a motion, which has two replies.
        let requests = of("franka.reply_in");
        let replies: usize = requests
            .iter()
            .map(|one| one["franka.reply_in"].len())
            .sum();
        assert_eq!(of("franka.request_in").len(), replies);
        let moved = requests
            .iter()
            .find(|frame| frame["franka.message"] == ["Move"]);
        assert_eq!(moved.expect("a motion")["franka.reply_in"].len(), 2);
        // A machine that stood still may have lost or delayed some.
        let (gaps, late) = lost_and_late(robot);
        assert_eq!(of("franka.gap").len(), gaps);
        assert_eq!(of("franka.late").len(), late);
        for finding in ["franka.unasked", "franka.length", "franka.order"] {
            assert!(of(finding).is_empty(), "{finding}");
        }
    }
}

/// Number of states after a gap, and of commands after the next state.
fn lost_and_late(connection: &Connection) -> (usize, usize) {
    let (mut gaps, mut late) = (0, 0);
    let mut newest: Option<u64> = None;
    for event in &connection.events {
        let Payload::Datagram(bytes) = &event.what else {
            continue;
        };
        let id = u64::from_le_bytes(bytes[..8].try_into().expect("eight bytes"));
        match (event.from, newest) {
            (Side::Robot, last) => {
                gaps += usize::from(last.is_some_and(|last| id > last + 1));
                newest = Some(id);
            }
            (Side::Client, Some(last)) => late += usize::from(id < last),
            (Side::Client, None) => panic!("a command before any state"),
        }
    }
    (gaps, late)
}

/// Lost states, late and missing commands, a failed request and a reflex.
#[test]
fn the_dissector_finds_what_went_wrong() {
    let mut cassette = Cassette::open(committed(Version::V10)).expect("committed");
    let robot = cassette.connections.last_mut().expect("a robot");
    let running =
        |event: &Event| event.from == Side::Client && matches!(event.what, Payload::Datagram(_));
    // The first command of the motion comes two states later.
    let first = robot.events.iter().position(running).expect("a motion");
    let late = robot.events[first].at + Duration::from_micros(2500);
    robot.events[first].at = late;
    robot.events.sort_by_key(|event| event.at);
    // The capture lacks one state.
    let state =
        |event: &Event| event.from == Side::Robot && matches!(event.what, Payload::Datagram(_));
    let states: Vec<_> = (0..robot.events.len())
        .filter(|&i| state(&robot.events[i]))
        .collect();
    robot.events.remove(states[2]);
    let Some(frames) = dissected(&cassette, "findings") else {
        return;
    };
    for finding in [
        "franka.gap",
        "franka.late",
        "franka.unanswered",
        "franka.failed",
        "franka.reflex",
    ] {
        let found = frames.iter().any(|frame| frame.contains_key(finding));
        assert!(found, "{finding}");
    }
}

/// Any bytes behind a Connect are shown or marked, and none stop the dissector.
#[test]
fn the_dissector_survives_any_bytes() {
    let mut cassette = Cassette::open(committed(Version::V5)).expect("committed");
    let robot = cassette.connections.last_mut().expect("a robot");
    let mut seed = 7_u64;
    for event in robot.events.iter_mut().skip(4) {
        let (Payload::Stream(bytes) | Payload::Datagram(bytes)) = &mut event.what else {
            continue;
        };
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(99);
        bytes.truncate((seed >> 33) as usize % (bytes.len() + 1));
        for byte in bytes.iter_mut().step_by(3) {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(99);
            *byte = (seed >> 33) as u8;
        }
    }
    if let Some(frames) = dissected(&cassette, "garbage") {
        assert!(
            frames
                .iter()
                .any(|frame| frame.contains_key("franka.length"))
        );
        for frame in frames {
            assert!(!frame.contains_key("_ws.lua.error"), "{frame:?}");
        }
    }
}
