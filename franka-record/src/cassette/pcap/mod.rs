//! Captures of the network (pcap, pcapng) to cassettes and back.
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

/// Why a capture gives no cassette.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The bytes are no capture.
    #[error("not a readable pcap or pcapng file: {what}")]
    Format {
        /// What is wrong with them.
        what: String,
    },
    /// No connection of a client is in it.
    #[error("none of {packets} packets belongs to a connection to TCP port 1337, 1338 or 1339")]
    NoConnection {
        /// How many packets the capture has.
        packets: usize,
    },
}

/// The cassette of a capture, pcap or pcapng. Link types: Ethernet, Linux cooked (also version 2),
/// loopback, and raw IP.
///
/// Segments of TCP are put in order and repeated ones left out; fragments of IP, in which states of
/// protocol 5 come, are put together. Segments that were not captured are counted in
/// [`Connection::missing_stream`](super::Connection::missing_stream). Datagrams belong to the
/// connection whose `Connect` announced their port, which therefore has to be in the capture. A
/// file that was cut off is read as far as it goes: see [`Cassette::damage`].
///
/// # Errors
/// [`CaptureError`] if the bytes are no capture, or none of a client and a robot.
pub fn from_capture(file: &[u8]) -> Result<Cassette, CaptureError> {
    let mut packets = Packets::new(file)?;
    let mut sessions = Sessions::default();
    let mut count = 0;
    while let Some(packet) = packets.next() {
        count += 1;
        sessions.on_packet(&packet);
    }
    let mut cassette = sessions.finish();
    if cassette.connections.is_empty() {
        return Err(CaptureError::NoConnection { packets: count });
    }
    cassette.damage = packets.damage();
    Ok(cassette)
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

    /// Two connections at once, datagrams longer than a packet of Ethernet, and an end.
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
            dropped: 0,
            damage: None,
        }
    }

    #[test]
    fn a_capture_of_a_cassette_is_that_cassette() {
        let cassette = sample();
        let capture = to_capture(&cassette);
        assert_eq!(from_capture(&capture).unwrap(), cassette);
    }

    /// It cannot be played, neither before nor after it was written.
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
                Err(CaptureError::NoConnection { packets }) => assert!(packets < 4, "{length}"),
            }
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
            // Either is fine; a panic is not.
            let _ = from_capture(&damaged);
        }
    }
}
