//! The golden messages as inputs of the targets.
// The items are public in the library of `fuzz/`, which also compiles this file.
#![allow(unreachable_pub)]

use std::path::Path;

use serde_json::Value;

/// An input: its target, its name and its bytes.
pub struct Seed {
    /// Name of the target.
    pub target: &'static str,
    /// Name of the input, unique in its target.
    pub name: String,
    /// The bytes for the target.
    pub bytes: Vec<u8>,
}

/// Reads `wire_golden.json`: every message as an input of its target, and all messages of one side
/// as one stream.
pub fn read(golden: &Path) -> Vec<Seed> {
    let text = std::fs::read(golden).expect("the golden messages are there");
    let root: Value = serde_json::from_slice(&text).expect("they are JSON");
    let mut seeds = Vec::new();
    for (service, selector) in [("v5", 0), ("v10", 1), ("gripper", 0), ("vacuum_gripper", 0)] {
        let (mut requests, mut replies) = (Vec::new(), Vec::new());
        let messages = root[service].as_array().expect("a list of messages");
        for (index, message) in messages.iter().enumerate() {
            let kind = message["message"].as_str().expect("a name");
            let bytes = unhex(message["hex"].as_str().expect("hexadecimal bytes"));
            let target = match (service, kind) {
                ("gripper", _) => "gripper",
                ("vacuum_gripper", _) => "vacuum",
                (_, "RobotState") => "robot_state",
                (_, "RobotCommand") => "robot_command",
                (_, reply) if reply.ends_with("reply") => "client_replies",
                _ => "server_requests",
            };
            let stream = if kind.ends_with("reply") {
                &mut replies
            } else {
                &mut requests
            };
            if kind.contains(' ') {
                stream.extend_from_slice(&bytes);
            }
            let name = format!("{service}_{index:02}");
            seeds.push(seed(target, name, selector, &bytes));
        }
        for (side, stream) in [("requests", requests), ("replies", replies)] {
            let name = format!("{service}_{side}");
            let target = match (service, side) {
                ("gripper", _) => "gripper",
                ("vacuum_gripper", _) => "vacuum",
                (_, "requests") => "server_requests",
                _ => "client_replies",
            };
            seeds.push(seed("stream", name.clone(), selector, &stream));
            seeds.push(seed(target, name, selector, &stream));
        }
    }
    seeds
}

/// The targets of the robot's sessions read the version from the first byte.
fn seed(target: &'static str, name: String, selector: u8, bytes: &[u8]) -> Seed {
    let versioned = matches!(target, "client_replies" | "server_requests");
    let prefix = if versioned { &[selector][..] } else { &[] };
    let bytes = [prefix, bytes].concat();
    Seed {
        target,
        name,
        bytes,
    }
}

fn unhex(text: &str) -> Vec<u8> {
    let digit = |at: usize| u8::from_str_radix(&text[at..at + 2], 16).expect("hexadecimal");
    (0..text.len()).step_by(2).map(digit).collect()
}
