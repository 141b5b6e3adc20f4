//! Positions of a recording's chunks, from the summary or from a scan.

use std::collections::BTreeMap;

use mcap::MAGIC;
use mcap::records::{Channel, Record, op};

use super::bytes::Bytes;
use super::error::RecordingError;
use super::wire::{self, CHUNK_HEADER, Fields, HEADER};

/// Positions of all parts of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    pub(super) chunks: Vec<ChunkEntry>,
    pub(super) attachments: Vec<Entry>,
    pub(super) metadata: Vec<Entry>,
    /// Bodies of schema and channel records outside of chunks.
    pub(super) described: Vec<(u8, Vec<u8>)>,
    /// End of the data. Set only if the file was scanned up to this point.
    pub(super) data_end: Option<u64>,
    /// Description of why the file is incomplete or damaged; `None` if it is intact.
    pub(super) damage: Option<String>,
}

/// The position of a chunk's whole record.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChunkEntry {
    pub(super) offset: u64,
    pub(super) length: u64,
    pub(super) begin: u64,
    pub(super) end: u64,
}

/// The position of a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) offset: u64,
    pub(super) length: u64,
}

impl Index {
    /// Returns the index of a file.
    pub(super) fn of(bytes: &Bytes) -> Result<Self, RecordingError> {
        Self::check_magic(bytes)?;
        match Self::of_summary(bytes)? {
            Ok(index) => Ok(index),
            Err(why) => {
                let mut index = Self::of_records(bytes)?;
                index.damage.get_or_insert(why);
                Ok(index)
            }
        }
    }

    fn check_magic(bytes: &Bytes) -> Result<(), RecordingError> {
        let first = bytes.read(0, bytes.length().min(MAGIC.len() as u64))?;
        match first.unwrap_or_default() {
            first if first == MAGIC => Ok(()),
            got => Err(RecordingError::NotMcap { got }),
        }
    }

    /// Returns the index at the end of the file, or the reason why that index cannot be used.
    fn of_summary(bytes: &Bytes) -> Result<Result<Self, String>, RecordingError> {
        let missing = |what: &str| Ok(Err(format!("its end is missing: {what}")));
        let Some(start) = bytes.length().checked_sub(FOOTER_LENGTH) else {
            return missing("it is too short");
        };
        let Some(footer) = bytes.read(start, FOOTER_LENGTH)? else {
            return missing("the file became shorter during reading");
        };
        let Some(Record::Footer(end)) = wire::first(&footer) else {
            return missing("no footer");
        };
        if !footer.ends_with(MAGIC) {
            return missing("no magic bytes");
        }
        let length = start.checked_sub(end.summary_start);
        let Some(length) = length.filter(|_| end.summary_start > 0) else {
            return missing("no summary");
        };
        let Some(summary) = bytes.read(end.summary_start, length)? else {
            return missing("no summary");
        };
        if end.summary_crc != 0 {
            // The checksum covers the footer up to the checksum itself.
            let mut hasher = crc32fast::Hasher::new();
            hasher.update(&summary);
            hasher.update(&footer[..HEADER as usize + 16]);
            if hasher.finalize() != end.summary_crc {
                return Ok(Err("its summary is damaged".to_owned()));
            }
        }
        Ok(Self::read_summary(&summary, end.summary_start)
            .ok_or_else(|| "its summary is damaged".to_owned()))
    }

    fn read_summary(mut summary: &[u8], data_end: u64) -> Option<Self> {
        let mut index = Self::default();
        while !summary.is_empty() {
            let (kind, body, rest) = wire::split(summary)?;
            summary = rest;
            let mut fields = Fields(body);
            match kind {
                op::CHUNK_INDEX => {
                    let (begin, end) = (fields.u64()?, fields.u64()?);
                    let (offset, length) = (fields.u64()?, fields.u64()?);
                    index.chunks.push(ChunkEntry {
                        offset,
                        length,
                        begin,
                        end,
                    });
                }
                op::ATTACHMENT_INDEX => index.attachments.push(entry(&mut fields)?),
                op::METADATA_INDEX => index.metadata.push(entry(&mut fields)?),
                op::SCHEMA | op::CHANNEL => index.described.push((kind, body.to_owned())),
                _ => {}
            }
        }
        // An entry that refers to a position outside of the file does not belong to this index.
        let inside = |offset: u64, length| {
            offset
                .checked_add(length)
                .is_some_and(|end: u64| end <= data_end)
        };
        let chunks = index.chunks.iter().all(|c| inside(c.offset, c.length));
        let mut entries = index.attachments.iter().chain(&index.metadata);
        (chunks && entries.all(|entry| inside(entry.offset, entry.length))).then_some(index)
    }

    /// Scans the file from record to record, up to the last readable record, and returns the index.
    pub(super) fn of_records(bytes: &Bytes) -> Result<Self, RecordingError> {
        Self::check_magic(bytes)?;
        let mut index = Self::default();
        let mut offset = MAGIC.len() as u64;
        loop {
            let Some(header) = bytes.read(offset, HEADER)? else {
                index.damage = Some(format!("its end is missing after byte {offset}"));
                break;
            };
            let Some((kind, body)) = wire::header(&header) else {
                break; // never happens: the length is right
            };
            let end = offset.checked_add(HEADER).and_then(|o| o.checked_add(body));
            let Some(end) = end.filter(|end| *end <= bytes.length() && kind != 0) else {
                index.damage = Some(format!("its end is missing after byte {offset}"));
                break;
            };
            let length = end - offset;
            match kind {
                op::CHUNK => {
                    let part = body.min(CHUNK_HEADER + COMPRESSION_MAX);
                    let part = bytes.read(offset + HEADER, part)?.unwrap_or_default();
                    // A chunk without a readable header is reported as damaged when it is read.
                    let (begin, end) = wire::chunk_header(&part).map_or((0, u64::MAX), |header| {
                        (header.message_start_time, header.message_end_time)
                    });
                    index.chunks.push(ChunkEntry {
                        offset,
                        length,
                        begin,
                        end,
                    });
                }
                op::ATTACHMENT => index.attachments.push(Entry { offset, length }),
                op::METADATA => index.metadata.push(Entry { offset, length }),
                op::SCHEMA | op::CHANNEL => {
                    let body = bytes.read(offset + HEADER, body)?.unwrap_or_default();
                    index.described.push((kind, body));
                }
                op::DATA_END | op::FOOTER => {
                    index.data_end = Some(offset);
                    break;
                }
                _ => {}
            }
            offset = end;
        }
        Ok(index)
    }
}

fn entry(fields: &mut Fields<'_>) -> Option<Entry> {
    Some(Entry {
        offset: fields.u64()?,
        length: fields.u64()?,
    })
}

/// Number of bytes in the footer and the magic bytes after it.
const FOOTER_LENGTH: u64 = HEADER + 8 + 8 + 4 + 8;

/// Longest name of a compression in a chunk whose times are read.
const COMPRESSION_MAX: u64 = 16;

/// The channels of a recording, and the names of their schemas.
#[derive(Clone, Debug, Default)]
pub(super) struct Channels {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
}

impl Channels {
    /// Processes a record that describes a schema or a channel, and ignores other records.
    pub(super) fn take(&mut self, kind: u8, body: &[u8]) {
        match wire::parse(kind, body) {
            Some(Record::Schema { header, .. }) => {
                self.schemas.insert(header.id, header.name);
            }
            Some(Record::Channel(channel)) => {
                self.channels.insert(channel.id, channel);
            }
            _ => {}
        }
    }

    pub(super) fn find(&self, name: &str, schema: &str) -> Option<u16> {
        let mut channels = self.channels.values();
        let found = channels.find(|channel| {
            channel.topic == name
                && channel.message_encoding == "protobuf"
                && self.schemas.get(&channel.schema_id).map(String::as_str) == Some(schema)
        });
        found.map(|channel| channel.id)
    }
}
