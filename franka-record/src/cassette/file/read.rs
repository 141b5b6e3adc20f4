//! Reads the file of a cassette, whatever its bytes.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use mcap::records::MessageHeader;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::{CassetteError, END, START, VERSION};
use crate::cassette::{Cassette, Connection, Device, Event, Payload, Side};

impl Cassette {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// Those of [`Self::read`], and [`CassetteError::Io`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, CassetteError> {
        Self::read(&std::fs::read(path)?)
    }

    /// Reads a file. One that was cut off is read as far as it goes: [`Cassette::damage`] then says
    /// why it ends there.
    ///
    /// # Errors
    /// [`CassetteError`] if the bytes are no cassette, whatever they are.
    pub fn read(file: &[u8]) -> Result<Self, CassetteError> {
        let mut reading = Reading::default();
        let mut rest = file;
        let options = LinearReaderOptions::default()
            .with_record_length_limit(RECORD_LENGTH_MAX)
            .with_prevalidate_chunk_crcs(true)
            .with_validate_data_section_crc(true);
        let mut reader = LinearReader::new_with_options(options);
        let damage = loop {
            match reader.next_event() {
                None => break None,
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                    let count = wanted.min(rest.len());
                    reader.insert(count).copy_from_slice(&rest[..count]);
                    reader.notify_read(count);
                    rest = &rest[count..];
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    match mcap::parse_record(opcode, data) {
                        Ok(record) => reading.on_record(record)?,
                        Err(error) => break Some(error),
                    }
                }
                Some(Err(error)) => break Some(error),
            }
        };
        match (reading.started, damage) {
            (None, Some(error)) => Err(error.into()),
            (None, None) => Err(CassetteError::NotACassette),
            (Some(started), damage) => Ok(reading.cassette(started, damage)),
        }
    }
}

/// What has been read so far.
#[derive(Default)]
struct Reading {
    started: Option<u64>,
    channels: BTreeMap<u16, ReadChannel>,
    /// By device and number; the first is when it was met, for the order.
    connections: BTreeMap<(Device, usize), (usize, Connection)>,
    missing_at_end: u64,
    finished: bool,
}

struct ReadChannel {
    connection: (Device, usize),
    stream: bool,
    from: Side,
    next: u32,
}

impl Reading {
    fn on_record(&mut self, record: mcap::records::Record<'_>) -> Result<(), CassetteError> {
        use mcap::records::Record;
        match record {
            // What follows repeats channels and metadata.
            Record::DataEnd(_) => self.finished = true,
            _ if self.finished => {}
            Record::Metadata(metadata) => self.on_metadata(&metadata)?,
            Record::Channel(channel) => self.on_channel(channel)?,
            Record::Message { header, data } => self.on_message(&header, data)?,
            _ => {}
        }
        Ok(())
    }

    fn on_metadata(&mut self, metadata: &mcap::records::Metadata) -> Result<(), CassetteError> {
        let field = |key| metadata.metadata.get(key).map(String::as_str);
        match metadata.name.as_str() {
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
                self.missing_at_end = dropped.unwrap_or_default();
            }
            _ => {}
        }
        Ok(())
    }

    fn on_channel(&mut self, channel: mcap::records::Channel) -> Result<(), CassetteError> {
        let (stream, connection, from) = parse_topic(&channel.topic).ok_or_else(|| {
            let topic = channel.topic.clone();
            CassetteError::Channel { topic }
        })?;
        let order = self.connections.len();
        self.connections
            .entry(connection)
            .or_insert_with(|| (order, Connection::new(connection.0)));
        self.channels.entry(channel.id).or_insert(ReadChannel {
            connection,
            stream,
            from,
            next: 0,
        });
        Ok(())
    }

    fn on_message(
        &mut self,
        header: &MessageHeader,
        data: Cow<'_, [u8]>,
    ) -> Result<(), CassetteError> {
        let started = self.started.ok_or(CassetteError::NotACassette)?;
        // A message without a channel is damage of the file; there is nothing to put it to.
        let Some(channel) = self.channels.get_mut(&header.channel_id) else {
            return Ok(());
        };
        let Some((_, connection)) = self.connections.get_mut(&channel.connection) else {
            return Ok(());
        };
        let missing = u64::from(header.sequence.wrapping_sub(channel.next));
        channel.next = header.sequence.wrapping_add(1);
        let counter = match channel.stream {
            true => &mut connection.missing_stream,
            false => &mut connection.missing_datagrams,
        };
        *counter = counter.saturating_add(missing);
        connection.events.push(Event {
            at: Duration::from_nanos(header.log_time.saturating_sub(started)),
            from: channel.from,
            what: match (channel.stream, data.is_empty()) {
                (true, true) => Payload::End,
                (true, false) => Payload::Stream(data.into_owned()),
                (false, _) => Payload::Datagram(data.into_owned()),
            },
        });
        Ok(())
    }

    fn cassette(self, started: u64, damage: Option<mcap::McapError>) -> Cassette {
        let mut connections: Vec<_> = self.connections.into_values().collect();
        connections.sort_by_key(|(order, _)| *order);
        let connections = connections.into_iter().map(|(_, mut connection)| {
            // Threads of a tap note events as they can; the stamps say what came first.
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
            dropped: self.missing_at_end.max(counted),
            damage: damage.map(|error| error.to_string()),
        }
    }
}

/// Transport, connection and sender that a topic names.
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

/// The longest record that a reader takes: above any chunk and message written here. Without a
/// bound, a damaged length would have it ask for memory without end.
const RECORD_LENGTH_MAX: usize = 64 << 20;
