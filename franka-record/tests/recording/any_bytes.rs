//! Reads a recording from any bytes. This is the target of the fuzzer in `fuzz/`, with its initial
//! files.
// Public in the library of `fuzz/`, which also compiles this file.
#![allow(unreachable_pub)]

use std::collections::BTreeMap;

use franka_record::schema::{Message as _, franka};
use franka_record::{Cycle, Event, EventKind, HostTime, Recording};
use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, WriteOptions};

/// Reads all contents of `bytes`. This never panics, and no result is larger than the bytes can
/// encode.
pub fn read(bytes: &[u8]) {
    let Ok(recording) = Recording::from_bytes(bytes.to_vec()) else {
        return;
    };
    for name in recording.attachments().unwrap_or_default() {
        let data = recording.attachment(&name).unwrap_or_default();
        assert!(data.is_none_or(|data| data.len() <= bytes.len()));
    }
    let middle = recording.span().map_or(HostTime::default(), |span| span.0);
    // LZ4 produces at most 255 bytes from one, and a message takes more than ten. Each chunk is
    // reported as damaged once, but its index may name the same chunk repeatedly.
    let most = bytes.len() * 255 * (1 + bytes.len() / 50);
    for robot in recording.robots() {
        let Ok(robot) = recording.robot(&robot.name) else {
            continue;
        };
        assert!(robot.cycles().count() <= most);
        assert!(robot.from(middle).resampled(50.0).take(1000).count() <= 1000);
        assert!(robot.events().count() <= most);
        assert!(robot.gripper_states().count() <= most);
    }
}

/// Returns short recordings, complete but without the contents of schemas.
pub fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    vec![("lz4", seed(Some(Compression::Lz4))), ("plain", seed(None))]
}

fn seed(compression: Option<Compression>) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    // Without compression there are no checksums either, so a changed byte reaches the reader.
    let sums = compression.is_some();
    let options = WriteOptions::new()
        .compression(compression)
        .calculate_chunk_crcs(sums)
        .calculate_data_section_crc(sums)
        .calculate_summary_section_crc(sums);
    let mut writer = options.create(&mut bytes).expect("memory takes bytes");
    let metadata = BTreeMap::from([("kind".to_owned(), "Fr3".to_owned())]);
    let name = "robot:".to_owned();
    let metadata = Metadata { name, metadata };
    writer.write_metadata(&metadata).expect("memory");
    let mut channel = |topic: &str, schema: &str| {
        let schema = writer.add_schema(schema, "protobuf", &[]).expect("memory");
        let channel = writer.add_channel(schema, topic, "protobuf", &BTreeMap::new());
        channel.expect("memory")
    };
    let cycles = channel("/cycle", "franka.Cycle");
    let events = channel("/event", "franka.Event");
    let tools = channel("/tool", "franka.Tool");
    channel("/gripper", "franka.Gripper");
    let cycle = Cycle::default();
    let mut message = franka::Cycle::default();
    message.set(&cycle);
    let event = Event {
        time: HostTime::default(),
        robot_time: 1,
        kind: EventKind::Dropped { cycles: 1 },
    };
    let messages = [
        (tools, franka::Tool::of(&cycle.state).encode_to_vec()),
        (cycles, message.encode_to_vec()),
        (events, franka::Event::from(&event).encode_to_vec()),
    ];
    for (time, (channel_id, data)) in messages.into_iter().enumerate() {
        let header = MessageHeader {
            channel_id,
            sequence: 1,
            log_time: time as u64,
            publish_time: time as u64,
        };
        writer
            .write_to_known_channel(&header, &data)
            .expect("memory");
    }
    writer.finish().expect("memory");
    drop(writer);
    bytes.into_inner()
}
