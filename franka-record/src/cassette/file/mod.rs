//! The cassette file, an MCAP file with one channel per connection, transport and direction.

mod read;
mod write;

pub use write::CassetteWriter;

use crate::recording::RecordingError;
use crate::schema::CASSETTE_METADATA;

/// Reason why a cassette cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CassetteError {
    /// The file cannot be opened, read or written.
    #[error("cannot access the cassette: {0}")]
    Io(#[from] std::io::Error),
    /// The file is not an MCAP file.
    #[error("not a readable MCAP file: {0}")]
    NotMcap(#[from] RecordingError),
    /// The file cannot be written.
    #[error("cannot write the MCAP file: {0}")]
    Mcap(#[from] mcap::McapError),
    /// The file is an MCAP file, but not a cassette.
    #[error(
        "not a cassette (recorded session): expected the metadata record `{START}` before the \
        first message"
    )]
    NotACassette,
    /// The format version of the file is newer than this library.
    #[error("the cassette has version {got:?} of the format, expected {VERSION}")]
    Version {
        /// The version in the file.
        got: String,
    },
    /// The file contains a channel that does not belong to a cassette.
    #[error(
        "the cassette has the channel {topic:?}, expected /tcp/PORT/CONNECTION/in or out, or the \
         same below /udp"
    )]
    Channel {
        /// The name of the channel.
        topic: String,
    },
}

pub(super) const START: &str = CASSETTE_METADATA;
pub(super) const END: &str = "franka cassette end";
pub(super) const VERSION: &str = "1";
pub(super) const MESSAGE_ENCODING: &str = "franka";

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::io::{Cursor, Seek, Write};
    use std::rc::Rc;
    use std::time::Duration;

    use super::*;
    use crate::cassette::{Cassette, Connection, Device, Event, Payload, Side};

    fn sample() -> Cassette {
        let at = Duration::from_micros;
        let event = |time, from, what| Event {
            at: at(time),
            from,
            what,
        };
        let mut robot = Connection::new(Device::Robot);
        robot.events = vec![
            event(1, Side::Client, Payload::Stream(vec![1, 2, 3])),
            event(2, Side::Robot, Payload::Stream(vec![4])),
            event(2, Side::Robot, Payload::Datagram(vec![])),
            event(3, Side::Client, Payload::Datagram(vec![5; 400])),
            event(9, Side::Client, Payload::End),
        ];
        let mut hand = Connection::new(Device::Hand);
        hand.events = vec![event(4, Side::Client, Payload::Stream(vec![7; 14]))];
        let mut again = Connection::new(Device::Robot);
        again.events = vec![event(10, Side::Robot, Payload::End)];
        let silent = Connection::new(Device::Robot);
        Cassette {
            started: 1_700_000_000_000_000_000,
            connections: vec![robot, silent, hand, again],
            ..Cassette::default()
        }
    }

    #[test]
    fn a_cassette_is_read_as_it_was_written() {
        let cassette = sample();
        let file = cassette.to_bytes().unwrap();
        assert_eq!(Cassette::read(&file).unwrap(), cassette);
    }

    #[test]
    fn missing_events_are_counted_at_their_connection() {
        let cassette = sample();
        let mut writer = CassetteWriter::new(Cursor::new(Vec::new()), 5).unwrap();
        let [first, second, ..] = &cassette.connections[0].events[..] else {
            panic!("five events")
        };
        writer.write(0, Device::Robot, first).unwrap();
        writer
            .note_dropped(0, Device::Robot, Side::Client, true, 2)
            .unwrap();
        writer.write(0, Device::Robot, first).unwrap();
        writer.write(0, Device::Robot, second).unwrap();
        // Both channels contain no later events. One of them contains no events at all.
        for (from, stream) in [(Side::Robot, true), (Side::Client, false)] {
            writer
                .note_dropped(0, Device::Robot, from, stream, 1)
                .unwrap();
        }
        let file = writer.finish().unwrap().into_inner();
        let read = Cassette::read(&file).unwrap();
        assert_eq!(read.connections[0].missing_stream, 3);
        assert_eq!(read.connections[0].missing_datagrams, 1);
        assert_eq!(read.dropped, 4);
        let again = read.to_bytes().unwrap();
        assert_eq!(Cassette::read(&again).unwrap(), read);
    }

    /// A file in memory whose length can be read while it is written.
    #[derive(Clone, Default)]
    struct Shared(Rc<RefCell<Cursor<Vec<u8>>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.borrow_mut().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Shared {
        fn seek(&mut self, to: std::io::SeekFrom) -> std::io::Result<u64> {
            self.0.borrow_mut().seek(to)
        }
    }

    /// The reader returns every whole chunk, regardless of where the file was cut off.
    #[test]
    fn a_file_that_was_cut_off_is_read_as_far_as_it_goes() {
        let file = Shared::default();
        let mut writer = CassetteWriter::new(file.clone(), 0).unwrap();
        let mut ends = Vec::new();
        for number in 0..20_u8 {
            let event = Event {
                at: Duration::from_millis(number.into()),
                from: Side::Robot,
                what: Payload::Datagram(vec![number; 50]),
            };
            writer.write(0, Device::Robot, &event).unwrap();
            writer.flush().unwrap();
            ends.push(file.0.borrow().get_ref().len());
        }
        writer.finish().unwrap();
        let file = file.0.take().into_inner();
        for length in 0..file.len() {
            let whole = ends.iter().filter(|end| **end <= length).count();
            match Cassette::read(&file[..length]) {
                Ok(cassette) => {
                    let read = cassette.connections.first();
                    let events = read.map_or(0, |connection| connection.events.len());
                    assert!(events >= whole, "{events} of {whole} at {length}");
                    assert!(cassette.damage.is_some(), "cut at {length}");
                }
                Err(error) => assert_eq!(whole, 0, "cut at {length}: {error}"),
            }
        }
    }

    /// A text claims a length of 4 GB. The reader allocates no memory for the text, and reads the
    /// rest.
    #[test]
    fn a_length_beyond_the_file_is_not_believed() {
        let cassette = sample();
        let mut file = cassette.to_bytes().unwrap();
        // The length of the profile, after the magic bytes and the start of the first record.
        file[17..21].fill(0xff);
        let read = Cassette::read(&file).unwrap();
        assert_eq!(read.connections, cassette.connections);
        let damage = read.damage.unwrap();
        assert!(damage.contains("checksum of its data"), "{damage}");
    }

    #[test]
    fn foreign_file_is_reported_as_no_cassette() {
        let error = Cassette::read(b"GIF89a").unwrap_err();
        assert!(matches!(error, CassetteError::NotMcap(_)), "{error}");
        let mut other = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
        other.finish().unwrap();
        let error = Cassette::read(&other.into_inner().into_inner()).unwrap_err();
        assert!(matches!(error, CassetteError::NotACassette), "{error}");
    }
}
