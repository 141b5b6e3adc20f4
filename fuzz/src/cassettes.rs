//! Short sessions that the target `cassette` starts from.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::time::Duration;

use franka_proto::client::Session;
use franka_proto::{RobotCommand, Version, gripper};
use franka_record::cassette::{Cassette, Connection, Device, Event, Payload, Side, pcap};
use mcap::records::Metadata;
use mcap::{MessageStream, WriteOptions};

/// A session with an arm and its Hand: as a tap writes it, without the sums that a changed byte
/// fails, and as a capture.
pub fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let cassette = session();
    let file = cassette.to_bytes().expect("few channels");
    let plain = plain(&file);
    let read = Cassette::read(&plain).expect("a cassette");
    assert_eq!(read.connections, cassette.connections);
    let capture = pcap::to_capture(&cassette);
    vec![("session", file), ("plain", plain), ("capture", capture)]
}

fn session() -> Cassette {
    let hello = Session::new(Version::V10).connect(4711);
    let mut command = [0; RobotCommand::MAX_SIZE];
    let ending = RobotCommand {
        motion_generation_finished: true,
        ..RobotCommand::default()
    };
    let size = ending.encode(Version::V10, &mut command).expect("it fits");
    let mut robot = Connection::new(Device::Robot);
    robot.events = events([
        (Side::Client, Payload::Stream(hello.as_bytes().to_vec())),
        (Side::Robot, Payload::Stream(vec![0; 16])),
        (Side::Robot, Payload::Datagram(vec![0; 16])),
        (Side::Client, Payload::Datagram(command[..size].to_vec())),
        (Side::Client, Payload::End),
        (Side::Robot, Payload::End),
    ]);
    let hello = Session::new(gripper::Version::V3).connect(4712);
    let mut hand = Connection::new(Device::Hand);
    hand.events = events([
        (Side::Client, Payload::Stream(hello.as_bytes().to_vec())),
        (Side::Robot, Payload::Datagram(vec![7; 23])),
    ]);
    Cassette {
        connections: vec![robot, hand],
        ..Cassette::default()
    }
}

fn events<const N: usize>(events: [(Side, Payload); N]) -> Vec<Event> {
    let event = |(at, (from, what))| Event {
        at: Duration::from_millis(at),
        from,
        what,
    };
    (0..).zip(events).map(event).collect()
}

/// The same file without compression and sums.
fn plain(file: &[u8]) -> Vec<u8> {
    let options = WriteOptions::new()
        .compression(None)
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false);
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = options.create(&mut bytes).expect("memory takes bytes");
    let entries = [("version", "1"), ("started", "0")];
    let entries = entries.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let metadata = Metadata {
        name: "franka cassette".to_owned(),
        metadata: BTreeMap::from(entries),
    };
    writer.write_metadata(&metadata).expect("memory");
    for message in MessageStream::new(file).expect("just written") {
        let message = message.expect("just written");
        writer.write(&message).expect("memory");
    }
    writer.finish().expect("memory");
    drop(writer);
    bytes.into_inner()
}
