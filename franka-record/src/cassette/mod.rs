//! Wire cassettes: recorded bytes of a session between a client and a robot, and their playback.
//!
//! ```text
//! client <-- TCP, UDP --> Tap <-- TCP, UDP --> robot      records a Cassette
//! client <-- TCP, UDP --> CassetteServer                  plays it back: the client meets the same robot again
//!            bytes    <-> Player                          the same without sockets and clock, for tests
//! ```
//!
//! | part | content |
//! |---|---|
//! | [`Cassette`], [`Connection`], [`Event`] | the transmitted bytes, with time, connection and side |
//! | [`CassetteWriter`] | the file, written during the session; [`Cassette::read`] reads it |
//! | [`Tap`] | a proxy between client and robot that forwards and records everything |
//! | [`Player`] | one connection of a cassette as a state machine: bytes and time in, bytes out |
//! | [`CassetteServer`] | players on sockets |
//!
#![cfg_attr(
    feature = "pcap",
    doc = "With the feature `pcap`, [`pcap`] converts captures of the network to cassettes and back."
)]
//!
//! A cassette is an MCAP file. See [`CassetteWriter`] for its channels.

mod device;
mod file;
mod options;
#[cfg(feature = "pcap")]
pub mod pcap;
mod player;
mod polling;
mod script;
mod server;
mod tap;

use std::time::Duration;

pub use device::Device;
pub use file::{CassetteError, CassetteWriter};
pub use options::{Matching, Pace, PlayOptions};
pub use player::{Mismatch, Output, Player, Tally};
pub use script::Unplayable;
pub use server::{CassetteServer, PlayError, PlayReport};
pub use tap::{Route, Tap, TapReport};

/// Data that clients and a robot exchanged in one session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cassette {
    /// Start of the recording, in nanoseconds since the Unix epoch.
    pub started: u64,
    /// The connections, in the order in which they were opened.
    pub connections: Vec<Connection>,
    /// Number of events that are missing because the recording thread was too slow.
    pub dropped: u64,
    /// Number of packets that a network capture contains only in part, for example because of a
    /// snap length. The contents of these packets are missing. Cassette files do not store this
    /// number.
    pub truncated: u64,
    /// Reason why the file is truncated; `None` if it is complete. `connections` contains the
    /// events before the cut.
    pub damage: Option<String>,
}

/// One TCP connection of a client, and the datagrams that belong to the connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Connection {
    /// The device to which the client connected.
    pub device: Device,
    /// The events of the connection, in order.
    pub events: Vec<Event>,
    /// Number of missing pieces in the connection's TCP streams. A connection with missing pieces
    /// cannot be played back.
    pub missing_stream: u64,
    /// Number of missing datagrams of the connection.
    pub missing_datagrams: u64,
}

/// One transmission on a connection, in one direction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// Time since [`Cassette::started`] on a monotonic clock.
    pub at: Duration,
    /// The sender.
    pub from: Side,
    /// The data.
    pub what: Payload,
}

/// A side of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The client.
    Client,
    /// The robot, or one of its end effectors.
    Robot,
}

/// The data sent by a side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Payload {
    /// Bytes of the TCP stream. The boundaries between pieces have no meaning.
    Stream(Vec<u8>),
    /// The sender closed its direction of the TCP stream.
    End,
    /// One UDP datagram.
    Datagram(Vec<u8>),
}

impl Connection {
    /// Creates a connection without events.
    #[must_use]
    pub fn new(device: Device) -> Self {
        Self {
            device,
            events: Vec::new(),
            missing_stream: 0,
            missing_datagrams: 0,
        }
    }

    /// Returns all bytes that a side sent over TCP.
    #[must_use]
    pub fn stream(&self, from: Side) -> Vec<u8> {
        let events = self.events.iter().filter(|event| event.from == from);
        let parts = events.filter_map(|event| match &event.what {
            Payload::Stream(bytes) => Some(bytes.as_slice()),
            Payload::End | Payload::Datagram(_) => None,
        });
        parts.collect::<Vec<_>>().concat()
    }

    /// Returns the datagrams that a side sent and their times.
    pub fn datagrams(&self, from: Side) -> impl Iterator<Item = (Duration, &[u8])> {
        let events = self.events.iter().filter(move |event| event.from == from);
        events.filter_map(|event| match &event.what {
            Payload::Datagram(bytes) => Some((event.at, bytes.as_slice())),
            Payload::Stream(_) | Payload::End => None,
        })
    }
}
