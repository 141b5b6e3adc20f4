//! Writer for cassette files.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::{Cursor, Seek, Write};
use std::time::Duration;

use mcap::records::MessageHeader;

use super::{CassetteError, END, MESSAGE_ENCODING, START, VERSION};
use crate::cassette::{Cassette, Device, Event, Payload, Side};

/// Writer that creates a cassette file during the session.
///
/// The file is MCAP, so MCAP tools can read it (`mcap info`, `mcap recover`). Version 1:
///
/// | record | content |
/// |---|---|
/// | metadata `franka cassette` | `version` (1), `started` (nanoseconds since the Unix epoch) |
/// | channel `/tcp/1337/1/in` | the stream of the first connection to port 1337, client to robot, in pieces as they arrived; an empty message is its end |
/// | channel `/tcp/1337/1/out` | robot to client |
/// | channels `/udp/1337/1/in`, `/udp/1337/1/out` | the datagrams that belong to the connection |
/// | metadata `franka cassette end` | `dropped`: number of missing events; by channel name, the events missing after its last event |
///
/// Channels have no schema and the message encoding `franka`. `log_time` is `started` plus the time
/// of a monotonic clock, so steps of the wall clock do not change it. `sequence` counts the events
/// of a channel, including missing events.
#[derive(Debug)]
pub struct CassetteWriter<W: Write + Seek> {
    mcap: Mcap<W>,
    started: u64,
    channels: BTreeMap<Key, Channel>,
    devices: BTreeMap<usize, (Device, usize)>,
    dropped: u64,
}

struct Mcap<W: Write + Seek>(mcap::Writer<W>);

impl<W: Write + Seek> std::fmt::Debug for Mcap<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Writer").finish_non_exhaustive()
    }
}

#[derive(Clone, Debug)]
struct Channel {
    id: u16,
    topic: String,
    sequence: u32,
    /// Number of missing events since the last recorded event.
    missing: u64,
}

/// Number of a connection, true for its stream, and true for its client.
type Key = (usize, bool, bool);

impl<W: Write + Seek> CassetteWriter<W> {
    /// Creates a writer for a cassette that begins at `started`, in nanoseconds since the Unix
    /// epoch.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the beginning of the file cannot be written.
    pub fn new(file: W, started: u64) -> Result<Self, CassetteError> {
        let options = mcap::WriteOptions::new()
            .compression(Some(mcap::Compression::Lz4))
            .chunk_size(Some(CHUNK_SIZE))
            .library(concat!("franka-record ", env!("CARGO_PKG_VERSION")));
        let mut writer = options.create(file)?;
        writer.write_metadata(&metadata(
            START,
            [
                ("version", VERSION.to_owned()),
                ("started", started.to_string()),
            ],
        ))?;
        Ok(Self {
            mcap: Mcap(writer),
            started,
            channels: BTreeMap::new(),
            devices: BTreeMap::new(),
            dropped: 0,
        })
    }

    /// Writes an event of connection `number`. Each connection must have a different number. The
    /// first event of a connection determines its device.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the file cannot be written.
    pub fn write(
        &mut self,
        connection: usize,
        device: Device,
        event: &Event,
    ) -> Result<(), CassetteError> {
        let (stream, bytes) = match &event.what {
            // In the file, an empty message represents the end of a stream.
            Payload::Stream(bytes) if bytes.is_empty() => return Ok(()),
            Payload::Stream(bytes) => (true, bytes.as_slice()),
            Payload::End => (true, &[][..]),
            Payload::Datagram(bytes) => (false, bytes.as_slice()),
        };
        let started = self.started;
        let channel = self.channel((connection, stream, event.from == Side::Client), device)?;
        let time = started.saturating_add(nanoseconds(event.at));
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time: time,
            publish_time: time,
        };
        channel.sequence = channel.sequence.wrapping_add(1);
        channel.missing = 0;
        self.mcap.0.write_to_known_channel(&header, bytes)?;
        Ok(())
    }

    /// Records how many events of a connection are missing.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the file cannot be written.
    pub fn note_dropped(
        &mut self,
        connection: usize,
        device: Device,
        from: Side,
        stream: bool,
        count: u32,
    ) -> Result<(), CassetteError> {
        self.note_missing(
            (connection, stream, from == Side::Client),
            device,
            count.into(),
        )
    }

    fn note_missing(&mut self, key: Key, device: Device, count: u64) -> Result<(), CassetteError> {
        let channel = self.channel(key, device)?;
        channel.sequence = channel.sequence.wrapping_add(count as u32);
        channel.missing = channel.missing.saturating_add(count);
        self.dropped = self.dropped.saturating_add(count);
        Ok(())
    }

    /// Ends the chunk. All data written so far is then readable, even if the process crashes.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the file cannot be written.
    pub fn flush(&mut self) -> Result<(), CassetteError> {
        Ok(self.mcap.0.flush()?)
    }

    /// Writes the end of the file.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the file cannot be written.
    pub fn finish(mut self) -> Result<W, CassetteError> {
        let mut end = metadata(END, [("dropped", self.dropped.to_string())]);
        let missing = self.channels.into_values();
        let missing = missing.filter(|channel| channel.missing > 0);
        end.metadata
            .extend(missing.map(|channel| (channel.topic, channel.missing.to_string())));
        self.mcap.0.write_metadata(&end)?;
        self.mcap.0.finish()?;
        Ok(self.mcap.0.into_inner())
    }

    fn channel(&mut self, key: Key, device: Device) -> Result<&mut Channel, CassetteError> {
        let (connection, stream, client) = key;
        let channel = match self.channels.entry(key) {
            Entry::Occupied(known) => return Ok(known.into_mut()),
            Entry::Vacant(channel) => channel,
        };
        let same = self.devices.values().filter(|(other, _)| *other == device);
        let number = same.count() + 1;
        let (device, number) = *self.devices.entry(connection).or_insert((device, number));
        let transport = if stream { "tcp" } else { "udp" };
        let direction = if client { "in" } else { "out" };
        let topic = format!("/{transport}/{}/{number}/{direction}", device.port());
        let nothing = BTreeMap::new();
        let added = self
            .mcap
            .0
            .add_channel(0, &topic, MESSAGE_ENCODING, &nothing);
        Ok(channel.insert(Channel {
            id: added?,
            topic,
            sequence: 0,
            missing: 0,
        }))
    }
}

impl Cassette {
    /// Returns the contents of a cassette file for this cassette.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the cassette needs more channels than a file can contain.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CassetteError> {
        let mut writer = CassetteWriter::new(Cursor::new(Vec::new()), self.started)?;
        let mut order: Vec<_> = Vec::new();
        for (number, connection) in self.connections.iter().enumerate() {
            // The file must also contain connections without events.
            writer.channel((number, true, true), connection.device)?;
            order.extend(connection.events.iter().map(|event| (number, event)));
        }
        // The sort is stable, so simultaneous events keep their order.
        order.sort_by_key(|(_, event)| event.at);
        for (number, event) in order {
            writer.write(number, self.connections[number].device, event)?;
        }
        for (number, connection) in self.connections.iter().enumerate() {
            for (stream, missing) in [
                (true, connection.missing_stream),
                (false, connection.missing_datagrams),
            ] {
                if missing > 0 {
                    writer.note_missing((number, stream, true), connection.device, missing)?;
                }
            }
        }
        writer.dropped = self.dropped;
        Ok(writer.finish()?.into_inner())
    }
}

fn metadata<const N: usize>(name: &str, fields: [(&str, String); N]) -> mcap::records::Metadata {
    let fields = fields.map(|(key, value)| (key.to_owned(), value));
    mcap::records::Metadata {
        name: name.to_owned(),
        metadata: BTreeMap::from(fields),
    }
}

/// Returns a time in nanoseconds for the file. 64 bits are enough for 584 years.
fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

/// Uncompressed size of a chunk, `[bytes]`. It corresponds to half a second of a robot's states.
const CHUNK_SIZE: u64 = 1 << 20;
