//! The bytes of one MCAP file, built in memory.

use std::collections::BTreeMap;
use std::io::{self, Seek, SeekFrom, Write};
use std::mem;
use std::sync::{Arc, Mutex, PoisonError};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, McapError, WriteOptions, Writer};

use super::encoder::Message;
use super::error::RecordError;
use super::options::Robot;
use super::session::Session;
use crate::HostTime;
use crate::recorded_model;
use crate::schema::{DESCRIPTORS, METADATA, ROBOT_METADATA, Topic};

/// MCAP file that grows in memory. The flushed part consists of whole chunks, so a reader can use
/// it without later data.
pub(super) struct McapFile {
    writer: Writer<Buffer>,
    buffer: Buffer,
    channels: Vec<[u16; Topic::ALL.len()]>,
    /// Number of messages so far, by channel.
    sequences: BTreeMap<u16, u32>,
    /// Time of the newest message. A message with an earlier time gets this time.
    newest: HostTime,
    /// Start of the recording.
    began: HostTime,
}

impl McapFile {
    /// Creates a file for `session` that contains all robots attached so far.
    pub(super) fn begin(session: &Session) -> Result<Self, RecordError> {
        let buffer = Buffer::default();
        let options = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(CHUNK_MAX))
            // This option makes the writer put whole chunks into the buffer.
            .disable_seeking(true)
            .library(concat!("franka-record ", env!("CARGO_PKG_VERSION")));
        let mut file = Self {
            writer: options.create(buffer.clone()).map_err(encode)?,
            buffer,
            channels: Vec::new(),
            sequences: BTreeMap::new(),
            newest: HostTime::default(),
            began: session.began(),
        };
        file.describe(METADATA, session.metadata())?;
        for attachment in session.attachments() {
            let time = session.began().as_nanos();
            file.attach(
                time,
                &attachment.name,
                &attachment.media_type,
                &attachment.data,
            )?;
        }
        for robot in session.robots() {
            file.add_robot(robot)?;
        }
        Ok(file)
    }

    /// Adds the channels and the description of the next robot.
    pub(super) fn add_robot(&mut self, robot: &Robot) -> Result<(), RecordError> {
        let mut metadata = robot.metadata.clone();
        metadata.insert("name".to_owned(), robot.name.clone());
        metadata.insert("kind".to_owned(), format!("{:?}", robot.kind));
        recorded_model::write_lengths(&robot.lengths, &mut metadata);
        self.describe(&format!("{ROBOT_METADATA}{}", robot.name), metadata)?;
        if let Some(urdf) = &robot.urdf {
            let name = recorded_model::description(&robot.name, robot.kind);
            let time = self.newest.max(self.began).as_nanos();
            self.attach(time, &name, "application/xml", urdf.as_bytes())?;
        }
        let mut channels = [0; Topic::ALL.len()];
        for topic in Topic::ALL {
            let schema = self
                .writer
                .add_schema(&topic.schema(), "protobuf", DESCRIPTORS)
                .map_err(encode)?;
            let name = topic.channel(&robot.name);
            channels[topic as usize] = self
                .writer
                .add_channel(schema, &name, "protobuf", &BTreeMap::new())
                .map_err(encode)?;
        }
        self.channels.push(channels);
        Ok(())
    }

    fn describe(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), RecordError> {
        let metadata = Metadata {
            name: name.to_owned(),
            metadata,
        };
        self.writer.write_metadata(&metadata).map_err(encode)
    }

    fn attach(
        &mut self,
        time: u64,
        name: &str,
        media_type: &str,
        data: &[u8],
    ) -> Result<(), RecordError> {
        let attachment = Attachment {
            log_time: time,
            create_time: time,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: data.into(),
        };
        self.writer.attach(&attachment).map_err(encode)
    }

    /// Appends a message. A message of an unknown robot is ignored.
    pub(super) fn write(&mut self, message: &Message) -> Result<(), RecordError> {
        let Some(channels) = self.channels.get(message.robot) else {
            return Ok(());
        };
        let channel_id = channels[message.topic as usize];
        let sequence = self.sequences.entry(channel_id).or_default();
        *sequence = sequence.wrapping_add(1);
        self.newest = self.newest.max(message.time);
        let header = MessageHeader {
            channel_id,
            sequence: *sequence,
            log_time: self.newest.as_nanos(),
            publish_time: message.time.as_nanos(),
        };
        self.writer
            .write_to_known_channel(&header, &message.data)
            .map_err(encode)
    }

    /// Ends the chunk and returns the bytes since the last call.
    pub(super) fn flush(&mut self) -> Result<Vec<u8>, RecordError> {
        self.writer.flush().map_err(encode)?;
        Ok(self.buffer.take())
    }

    /// Ends the file and returns its last bytes.
    pub(super) fn finish(mut self) -> Result<Vec<u8>, RecordError> {
        self.writer.finish().map_err(encode)?;
        Ok(self.buffer.take())
    }
}

fn encode(error: McapError) -> RecordError {
    RecordError::Encode {
        reason: error.to_string(),
    }
}

/// Size in bytes at which a chunk ends before the next flush, for example with several robots.
const CHUNK_MAX: u64 = 4 << 20;

/// Bytes of a file that have not been taken yet. The buffer only supports appending.
#[derive(Clone, Default)]
struct Buffer(Arc<Mutex<Pending>>);

#[derive(Default)]
struct Pending {
    bytes: Vec<u8>,
    /// Number of bytes that have been taken so far.
    taken: u64,
}

impl Buffer {
    fn take(&self) -> Vec<u8> {
        let mut pending = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pending.taken += pending.bytes.len() as u64;
        mem::take(&mut pending.bytes)
    }
}

impl Write for Buffer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut pending = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pending.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Buffer {
    /// Returns the position at the end. Seeking to any other position fails.
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        let pending = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let end = pending.taken + pending.bytes.len() as u64;
        match position {
            SeekFrom::Current(0) | SeekFrom::End(0) => Ok(end),
            SeekFrom::Start(start) if start == end => Ok(end),
            _ => Err(io::ErrorKind::Unsupported.into()),
        }
    }
}
