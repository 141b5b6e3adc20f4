//! Recovery of a file whose end is missing.

use std::fs::{self, File, OpenOptions};
use std::io::BufWriter;
use std::path::Path;

use mcap::records::{Record, op};
use mcap::{Attachment, Compression, McapError, WriteOptions};

use super::Recording;
use super::bytes::Bytes;
use super::chunk::Chunk;
use super::error::RecordingError;
use super::index::Index;
use super::wire;

/// Result of a recovery.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Recovery {
    /// Number of messages in the new file.
    pub messages: u64,
    /// Number of whole chunks that were copied.
    pub chunks: u64,
    /// Number of damaged chunks, which were omitted.
    pub lost: u64,
    /// Description of the damage; `None` if the file was not damaged.
    pub damage: Option<String>,
}

impl Recording {
    /// Writes the intact parts of the MCAP file `damaged` to the new file `whole`, with the missing
    /// index. The intact parts are every message in every whole chunk, the attachments and the
    /// metadata, as with `mcap recover` of the standard tool. The function accepts any MCAP file
    /// that is uncompressed or compressed with LZ4. It omits messages outside of chunks.
    ///
    /// # Errors
    /// Returns [`RecordingError::NotMcap`] if `damaged` is not an MCAP file,
    /// [`RecordingError::Compression`] if its compression is not supported, and
    /// [`RecordingError::Read`] if it cannot be read. Returns [`RecordingError::File`] if `damaged`
    /// cannot be opened, or if `whole` exists or cannot be written. An incomplete new file is
    /// removed.
    pub fn recover(
        damaged: impl AsRef<Path>,
        whole: impl AsRef<Path>,
    ) -> Result<Recovery, RecordingError> {
        let (damaged, whole) = (damaged.as_ref(), whole.as_ref());
        let of_file = |path: &Path, source: std::io::Error| RecordingError::File {
            path: path.to_owned(),
            source: source.into(),
        };
        let bytes = File::open(damaged)
            .and_then(Bytes::of_file)
            .map_err(|error| of_file(damaged, error))?;
        let index = Index::of(&bytes)?;
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(whole)
            .map_err(|error| of_file(whole, error))?;
        let written = write(&bytes, &index, file);
        if written.is_err() {
            // The incomplete file is useless, and its error has been reported.
            let _ = fs::remove_file(whole);
        }
        written.map_err(|failure| match failure {
            Failure::Read(error) => error,
            Failure::Write(error) => of_file(whole, std::io::Error::other(error)),
        })
    }
}

enum Failure {
    Read(RecordingError),
    Write(McapError),
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        Self::Read(error)
    }
}

impl From<McapError> for Failure {
    fn from(error: McapError) -> Self {
        Self::Write(error)
    }
}

type Writer = mcap::Writer<BufWriter<File>>;

fn write(bytes: &Bytes, index: &Index, file: File) -> Result<Recovery, Failure> {
    let options = WriteOptions::new()
        .compression(Some(Compression::Lz4))
        .library(concat!("franka-record ", env!("CARGO_PKG_VERSION")));
    let mut writer = options.create(BufWriter::new(file))?;
    let mut recovery = Recovery {
        messages: 0,
        chunks: 0,
        lost: 0,
        damage: index.damage.clone(),
    };
    for entry in index.metadata.iter().chain(&index.attachments) {
        if let Some(record) = bytes
            .read(entry.offset, entry.length)
            .map_err(RecordingError::from)?
        {
            copy(&mut writer, wire::first(&record))?;
        }
    }
    for (kind, body) in &index.described {
        copy(&mut writer, wire::parse(*kind, body))?;
    }
    for entry in &index.chunks {
        let mut chunk = match Chunk::read(bytes, entry) {
            Ok(chunk) => chunk,
            Err(RecordingError::Chunk { .. }) => {
                recovery.lost += 1;
                continue;
            }
            Err(error) => return Err(error.into()),
        };
        recovery.chunks += 1;
        while let Some((kind, body)) = chunk.next() {
            if let op::MESSAGE | op::SCHEMA | op::CHANNEL = kind {
                recovery.messages += u64::from(copy(&mut writer, wire::parse(kind, body))?);
            }
        }
    }
    writer.finish()?;
    Ok(recovery)
}

/// Copies a record. Omits damaged records, records that contradict earlier records, and messages
/// without a channel. Returns true if it copied a message.
fn copy(writer: &mut Writer, record: Option<Record<'_>>) -> Result<bool, McapError> {
    let copied = match record {
        Some(Record::Message { header, data }) => {
            let copied = writer.write_to_known_channel(&header, &data);
            return match copied {
                Err(McapError::UnknownChannel(..)) => Ok(false),
                copied => copied.map(|()| true),
            };
        }
        Some(Record::Metadata(metadata)) => writer.write_metadata(&metadata),
        Some(Record::Attachment { header, data, .. }) => writer.attach(&Attachment {
            log_time: header.log_time,
            create_time: header.create_time,
            name: header.name,
            media_type: header.media_type,
            data,
        }),
        Some(Record::Schema { header, data }) => {
            accepted(writer.add_schema_with_id(header.id, &header.name, &header.encoding, &data))
        }
        Some(Record::Channel(channel)) => accepted(writer.add_channel_with_id(
            channel.id,
            channel.schema_id,
            &channel.topic,
            &channel.message_encoding,
            &channel.metadata,
        )),
        _ => Ok(()),
    };
    copied.map(|()| false)
}

/// Ignores that the writer refused a description.
fn accepted<T>(added: Result<T, McapError>) -> Result<(), McapError> {
    match added {
        Err(error @ McapError::Io(_)) => Err(error),
        _ => Ok(()),
    }
}
