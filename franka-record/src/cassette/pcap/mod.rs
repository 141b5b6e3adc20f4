//! Conversion between network captures (pcap, pcapng) and cassettes.
//!
//! ```text
//! file -> packets:  time, addresses, TCP segment or UDP datagram
//!      -> sessions: streams in order, datagrams by Connect -> Cassette
//! Cassette -> packets of raw IPv4 -> pcap
//! ```

mod packets;
mod sessions;
mod write;

use self::packets::Packets;
use self::sessions::Sessions;
use super::Cassette;

pub use write::to_capture;

/// Reason why a capture cannot be converted to a cassette.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The bytes are not a network capture.
    #[error("not a readable pcap or pcapng file: {what}")]
    Format {
        /// Description of the problem.
        what: String,
    },
    /// The capture contains no connection between a client and a robot.
    #[error(
        "none of the {packets} packets belongs to a connection to TCP port 1337, 1338 or 1339{}",
        captured_in_part(*truncated)
    )]
    NoConnection {
        /// Number of packets in the capture.
        packets: usize,
        /// Number of packets that were captured only in part.
        truncated: u64,
    },
}

/// Converts a network capture (pcap or pcapng) to a cassette. Supported link types are Ethernet,
/// Linux cooked (versions 1 and 2), loopback, and raw IP.
///
/// The conversion sorts TCP segments, drops repeated segments, and reassembles IP fragments. States
/// of protocol 5 arrive in fragments.
///
/// [`Connection::missing_stream`](super::Connection::missing_stream) counts the segments that were
/// not captured. [`Cassette::truncated`] counts the packets that were captured only in part, for
/// example because of a snap length. A datagram belongs to the connection whose `Connect` message
/// announced the datagram's port, so the capture must contain this message. If the file is
/// truncated, the cassette contains the data before the cut (see [`Cassette::damage`]).
///
/// # Errors
/// Returns [`CaptureError`] if the bytes are not a capture, or if the capture contains no client
/// and robot.
pub fn from_capture(file: &[u8]) -> Result<Cassette, CaptureError> {
    let mut packets = Packets::new(file)?;
    let mut sessions = Sessions::default();
    let mut count = 0;
    while let Some(packet) = packets.next() {
        count += 1;
        sessions.on_packet(&packet);
    }
    let mut cassette = sessions.finish();
    cassette.truncated = packets.truncated();
    if cassette.connections.is_empty() {
        return Err(CaptureError::NoConnection {
            packets: count,
            truncated: cassette.truncated,
        });
    }
    cassette.damage = packets.damage();
    Ok(cassette)
}

/// Returns the last part of an error text, which reports packets that were captured only in part.
fn captured_in_part(packets: u64) -> String {
    match packets {
        0 => String::new(),
        packets => format!("; {packets} packets were captured only in part (snap length)"),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use franka_proto::client::Session;
    use franka_proto::{Version, gripper};

    use super::*;
    use crate::cassette::{
        Connection, Device, Event, Payload, PlayOptions, Player, Side, Unplayable,
    };

    fn event(at: u64, from: Side, what: Payload) -> Event {
        let at = Duration::from_nanos(at);
        Event { at, from, what }
    }

    /// Returns two simultaneous connections, with datagrams longer than an Ethernet packet and the
    /// end of a stream.
    fn sample() -> Cassette {
        let hello = Session::new(Version::V5).connect(4711).as_bytes().to_vec();
        let mut robot = Connection::new(Device::Robot);
        robot.events = vec![
            event(0, Side::Client, Payload::Stream(hello)),
            event(1000, Side::Robot, Payload::Stream(vec![4; 15])),
            event(2000, Side::Robot, Payload::Datagram(vec![6; 2373])),
            event(3001, Side::Client, Payload::Datagram(vec![5; 370])),
            event(9000, Side::Client, Payload::End),
            event(9500, Side::Robot, Payload::End),
        ];
        let hello = Session::new(gripper::Version::V3).connect(4712);
        let mut hand = Connection::new(Device::Hand);
        hand.events = vec![
            event(
                500,
                Side::Client,
                Payload::Stream(hello.as_bytes().to_vec()),
            ),
            event(600, Side::Robot, Payload::Datagram(vec![7; 23])),
        ];
        Cassette {
            started: 1_700_000_000_123_456_789,
            connections: vec![robot, hand],
            ..Cassette::default()
        }
    }

    #[test]
    fn a_capture_of_a_cassette_is_that_cassette() {
        let cassette = sample();
        let capture = to_capture(&cassette);
        assert_eq!(from_capture(&capture).unwrap(), cassette);
    }

    /// The connection cannot be played, neither before nor after it is written.
    #[test]
    fn a_segment_that_was_not_captured_is_missing_in_the_file_too() {
        let mut cassette = sample();
        cassette.connections.pop();
        let events = &mut cassette.connections[0].events;
        events.insert(2, event(1500, Side::Robot, Payload::Stream(vec![5; 9])));
        events.insert(3, event(1600, Side::Robot, Payload::Stream(vec![6; 9])));
        let whole = to_capture(&cassette);
        let packet = whole.windows(9).position(|bytes| bytes == [5; 9]).unwrap() - 40;
        let captured = [&whole[..packet - 16], &whole[packet + 49..]].concat();
        let cassette = from_capture(&captured).unwrap();
        assert_eq!(cassette.connections[0].missing_stream, 1);
        let file = cassette.to_bytes().unwrap();
        let read = Cassette::read(&file).unwrap();
        assert_eq!((read.dropped, read.connections[0].missing_stream), (1, 1));
        let player = Player::new(&read.connections[0], PlayOptions::default(), Duration::ZERO);
        let error = player.unwrap_err();
        assert!(
            matches!(error, Unplayable::Missing { missing: 1, .. }),
            "{error}"
        );
    }

    #[test]
    fn a_capture_that_was_cut_off_is_read_as_far_as_it_goes() {
        let capture = to_capture(&sample());
        for length in 0..capture.len() {
            match from_capture(&capture[..length]) {
                Ok(cassette) => assert!(!cassette.connections.is_empty()),
                Err(CaptureError::Format { .. }) => assert!(length < 24, "{length}"),
                Err(CaptureError::NoConnection { packets, .. }) => assert!(packets < 4, "{length}"),
            }
        }
    }

    /// Returns the capture that `tcpdump -s` would write, with at most `length` bytes of each
    /// packet.
    fn with_a_snap_length(capture: &[u8], length: usize) -> Vec<u8> {
        let (header, mut rest) = capture.split_at(24);
        let mut cut = header.to_vec();
        while let Some((record, behind)) = rest.split_at_checked(16) {
            let size = u32::from_le_bytes(record[8..12].try_into().expect("four bytes")) as usize;
            let kept = size.min(length);
            cut.extend_from_slice(&record[..8]);
            cut.extend_from_slice(&(kept as u32).to_le_bytes());
            cut.extend_from_slice(&record[12..]);
            cut.extend_from_slice(&behind[..kept]);
            rest = &behind[size..];
        }
        cut
    }

    #[test]
    fn packets_that_were_cut_by_a_snap_length_are_counted() {
        let capture = to_capture(&sample());
        assert_eq!(with_a_snap_length(&capture, 65_535), capture);
        let cassette = from_capture(&with_a_snap_length(&capture, 200)).unwrap();
        // The state and the command.
        assert_eq!(cassette.truncated, 2);
        assert_eq!(cassette.connections[0].missing_datagrams, 2);
        assert_eq!(cassette.dropped, 2);
        let read = Cassette::read(&cassette.to_bytes().unwrap()).unwrap();
        assert_eq!(read.dropped, 2);
        let error = from_capture(&with_a_snap_length(&capture, 30)).unwrap_err();
        assert!(
            error.to_string().contains("captured only in part"),
            "{error}"
        );
        for snapped in 0..200 {
            // An error is a valid result; a panic is not.
            let _ = from_capture(&with_a_snap_length(&capture, snapped));
        }
    }

    #[test]
    fn a_compressed_capture_is_named_as_such() {
        for (begin, name) in [
            (&[0x1f, 0x8b, 8, 0][..], "gzip"),
            (&[0x28, 0xb5, 0x2f, 0xfd], "zstd"),
            (&[0x04, 0x22, 0x4d, 0x18], "lz4"),
        ] {
            let file = [begin, &[0; 100]].concat();
            let error = from_capture(&file).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
    }

    #[test]
    fn any_bytes_are_an_error_or_a_cassette() {
        let capture = to_capture(&sample());
        let mut seed = 7_u64;
        for _ in 0..3000 {
            let mut damaged = capture.clone();
            for _ in 0..4 {
                seed = seed
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(99);
                let position = (seed >> 33) as usize % damaged.len();
                damaged[position] = (seed >> 24) as u8;
            }
            // An error is a valid result; a panic is not.
            let _ = from_capture(&damaged);
        }
    }
}
