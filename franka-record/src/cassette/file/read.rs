//! Reader for cassette files. The file can contain any bytes.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use mcap::records::{MessageHeader, Record};

use super::{CassetteError, END, START, VERSION};
use crate::cassette::{Cassette, Connection, Device, Event, Payload, Side};
use crate::recording::each_record;

impl Cassette {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// Returns [`CassetteError::Io`] if the file cannot be read, and the errors of [`Self::read`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, CassetteError> {
        Self::read(&std::fs::read(path)?)
    }

    /// Reads a cassette from the bytes of a file. If the file is truncated, the cassette contains
    /// the data before the cut, and [`Cassette::damage`] contains the reason.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the bytes are not a cassette.
    pub fn read(file: &[u8]) -> Result<Self, CassetteError> {
        let mut reading = Reading::default();
        let damage = each_record(file, |record| reading.on_record(record))?;
        match reading.started {
            None => Err(CassetteError::NotACassette),
            Some(started) => Ok(reading.cassette(started, damage)),
        }
    }
}

/// The contents that were read so far.
#[derive(Default)]
struct Reading {
    started: Option<u64>,
    channels: BTreeMap<u16, ReadChannel>,
    /// Connections by device and number. The first value is the position in the order of
    /// appearance.
    connections: BTreeMap<(Device, usize), (usize, Connection)>,
    /// Total number of missing events, as recorded at the end of the file.
    dropped: u64,
    /// Number of missing events after the last event of a connection. The key is the connection;
    /// the flag is true for its stream.
    missing_at_end: Vec<((Device, usize), bool, u64)>,
}

struct ReadChannel {
    connection: (Device, usize),
    stream: bool,
    from: Side,
    next: u32,
}

impl Reading {
    fn on_record(&mut self, record: Record<'_>) -> Result<(), CassetteError> {
        match record {
            Record::Metadata(record) => self.on_metadata(&record.name, &record.metadata),
            Record::Channel(channel) => self.on_channel(channel.id, &channel.topic),
            Record::Message { header, data } => self.on_message(&header, &data),
            _ => Ok(()),
        }
    }

    fn on_metadata(
        &mut self,
        name: &str,
        entries: &BTreeMap<String, String>,
    ) -> Result<(), CassetteError> {
        let field = |key| entries.get(key).map(String::as_str);
        match name {
            START => {
                let version = field("version").unwrap_or_default();
                if version != VERSION {
                    let got = version.to_owned();
                    return Err(CassetteError::Version { got });
                }
                let started = field("started").and_then(|text| text.parse().ok());
                self.started = Some(started.ok_or(CassetteError::NotACassette)?);
            }
            END => {
                let dropped = field("dropped").and_then(|text| text.parse().ok());
                self.dropped = dropped.unwrap_or_default();
                self.missing_at_end = entries
                    .iter()
                    .filter_map(|(topic, missing)| {
                        let (stream, connection, _) = parse_topic(topic)?;
                        Some((connection, stream, missing.parse().ok()?))
                    })
                    .collect();
            }
            _ => {}
        }
        Ok(())
    }

    fn on_channel(&mut self, id: u16, topic: &str) -> Result<(), CassetteError> {
        let (stream, connection, from) = parse_topic(topic).ok_or_else(|| {
            let topic = topic.to_owned();
            CassetteError::Channel { topic }
        })?;
        let order = self.connections.len();
        self.connections
            .entry(connection)
            .or_insert_with(|| (order, Connection::new(connection.0)));
        self.channels.entry(id).or_insert(ReadChannel {
            connection,
            stream,
            from,
            next: 0,
        });
        Ok(())
    }

    fn on_message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), CassetteError> {
        let started = self.started.ok_or(CassetteError::NotACassette)?;
        // A message without a channel is a sign of damage and is ignored.
        let Some(channel) = self.channels.get_mut(&header.channel_id) else {
            return Ok(());
        };
        let Some((_, connection)) = self.connections.get_mut(&channel.connection) else {
            return Ok(());
        };
        let missing = u64::from(header.sequence.wrapping_sub(channel.next));
        channel.next = header.sequence.wrapping_add(1);
        connection.note_missing(channel.stream, missing);
        connection.events.push(Event {
            at: Duration::from_nanos(header.log_time.saturating_sub(started)),
            from: channel.from,
            what: match (channel.stream, data.is_empty()) {
                (true, true) => Payload::End,
                (true, false) => Payload::Stream(data.to_vec()),
                (false, _) => Payload::Datagram(data.to_vec()),
            },
        });
        Ok(())
    }

    fn cassette(mut self, started: u64, damage: Option<String>) -> Cassette {
        for (key, stream, missing) in self.missing_at_end {
            if let Some((_, connection)) = self.connections.get_mut(&key) {
                connection.note_missing(stream, missing);
            }
        }
        let mut connections: Vec<_> = self.connections.into_values().collect();
        connections.sort_by_key(|(order, _)| *order);
        let connections = connections.into_iter().map(|(_, mut connection)| {
            // The threads of a tap record events in any order. The times of the events determine
            // the true order.
            connection.events.sort_by_key(|event| event.at);
            connection
        });
        let connections: Vec<_> = connections.collect();
        let counted = connections.iter().fold(0_u64, |sum, connection| {
            sum.saturating_add(connection.missing_stream)
                .saturating_add(connection.missing_datagrams)
        });
        Cassette {
            started,
            connections,
            dropped: self.dropped.max(counted),
            truncated: 0,
            damage,
        }
    }
}

impl Connection {
    fn note_missing(&mut self, stream: bool, count: u64) {
        let counter = match stream {
            true => &mut self.missing_stream,
            false => &mut self.missing_datagrams,
        };
        *counter = counter.saturating_add(count);
    }
}

/// Returns the transport (true for a stream), the connection and the sender that a topic describes.
fn parse_topic(topic: &str) -> Option<(bool, (Device, usize), Side)> {
    let mut parts = topic.strip_prefix('/')?.split('/');
    let stream = match parts.next()? {
        "tcp" => true,
        "udp" => false,
        _ => return None,
    };
    let device = Device::with_port(parts.next()?.parse().ok()?)?;
    let number = parts.next()?.parse().ok()?;
    let from = match parts.next()? {
        "in" => Side::Client,
        "out" => Side::Robot,
        _ => return None,
    };
    let complete = parts.next().is_none();
    complete.then_some((stream, (device, number), from))
}
