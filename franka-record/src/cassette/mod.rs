//! Wire cassettes: the bytes of a session between a client and a robot, and what plays them back.
//!
//! ```text
//! client <-- TCP, UDP --> Tap <-- TCP, UDP --> robot      records a Cassette
//! client <-- TCP, UDP --> CassetteServer                  plays it back: the client meets the same robot again
//!            bytes    <-> Player                          the same without sockets and clock, for tests
//! ```
//!
//! | part | content |
//! |---|---|
//! | [`Cassette`], [`Connection`], [`Event`] | the bytes that passed, with time, connection and side |
//! | [`CassetteWriter`] | the file, written while the session goes on; [`Cassette::read`] reads it |
//! | [`Tap`] | stands between client and robot, forwards everything and records it |
//! | [`Player`] | one connection of a cassette as a value: bytes and time in, bytes out |
//! | [`CassetteServer`] | players on sockets |
//!
#![cfg_attr(
    feature = "pcap",
    doc = "With the feature `pcap`, [`pcap`] converts captures of the network to cassettes and back."
)]
//!
//! A cassette is an MCAP file: see [`CassetteWriter`] for its channels.

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

/// What passed between clients and a robot in one session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cassette {
    /// Time of the first event that could have been recorded, in nanoseconds since the Unix epoch.
    pub started: u64,
    /// The connections, in the order in which they were opened.
    pub connections: Vec<Connection>,
    /// How many events the recording thread could not keep up with and that are missing.
    pub dropped: u64,
    /// How many packets of a capture were captured in part only, as with a snap length; what they
    /// carried is missing. It is not written to files.
    pub truncated: u64,
    /// Why the file ends before its end, if it does. What was read before stands in `connections`.
    pub damage: Option<String>,
}

/// One TCP connection of a client, and the datagrams that belong to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Connection {
    /// The device that the client talks to.
    pub device: Device,
    /// What passed, in the order in which it passed.
    pub events: Vec<Event>,
    /// How many pieces of its TCP streams are missing. Such a connection cannot be played.
    pub missing_stream: u64,
    /// How many of its datagrams are missing.
    pub missing_datagrams: u64,
}

/// Something that passed in one direction of a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// When it passed, since [`Cassette::started`] on a monotonic clock.
    pub at: Duration,
    /// Who sent it.
    pub from: Side,
    /// What was sent.
    pub what: Payload,
}

/// A side of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The client.
    Client,
    /// The robot, or its end effector.
    Robot,
}

/// What a side sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Payload {
    /// Bytes of the TCP stream, cut anywhere.
    Stream(Vec<u8>),
    /// The end of the TCP stream.
    End,
    /// One UDP datagram.
    Datagram(Vec<u8>),
}

impl Connection {
    /// A connection without events.
    #[must_use]
    pub fn new(device: Device) -> Self {
        Self {
            device,
            events: Vec::new(),
            missing_stream: 0,
            missing_datagrams: 0,
        }
    }

    /// The bytes that a side sent over TCP, in one piece.
    #[must_use]
    pub fn stream(&self, from: Side) -> Vec<u8> {
        let events = self.events.iter().filter(|event| event.from == from);
        let parts = events.filter_map(|event| match &event.what {
            Payload::Stream(bytes) => Some(bytes.as_slice()),
            Payload::End | Payload::Datagram(_) => None,
        });
        parts.collect::<Vec<_>>().concat()
    }

    /// The datagrams that a side sent, with their times.
    pub fn datagrams(&self, from: Side) -> impl Iterator<Item = (Duration, &[u8])> {
        let events = self.events.iter().filter(move |event| event.from == from);
        events.filter_map(|event| match &event.what {
            Payload::Datagram(bytes) => Some((event.at, bytes.as_slice())),
            Payload::Stream(_) | Payload::End => None,
        })
    }
}
