//! The records of one chunk.

use std::io::Read as _;

use mcap::records::Record;

use super::bytes::Bytes;
use super::error::RecordingError;
use super::index::ChunkEntry;
use super::wire::{self, HEADER};

#[derive(Clone, Debug)]
pub(super) struct Chunk {
    pub(super) offset: u64,
    records: Vec<u8>,
    next: usize,
}

impl Chunk {
    pub(super) fn read(bytes: &Bytes, entry: &ChunkEntry) -> Result<Self, RecordingError> {
        let offset = entry.offset;
        let damaged = |reason: &str| {
            Err(RecordingError::Chunk {
                offset,
                reason: reason.to_owned(),
            })
        };
        let Some(record) = bytes.read(offset, entry.length)? else {
            return damaged("it extends beyond the end of the file");
        };
        let (header, data) = match wire::first(&record) {
            Some(Record::Chunk { header, data }) => (header, data),
            Some(_) => return damaged("it is not a chunk"),
            None => return damaged("its header or its data is too short"),
        };
        let records = match header.compression.as_str() {
            "" => data.into_owned(),
            "lz4" => match decompress(&data, header.uncompressed_size) {
                Ok(records) => records,
                Err(reason) => return damaged(&reason),
            },
            ZSTD => {
                let got = header.compression;
                return Err(RecordingError::Compression { offset, got });
            }
            // The format defines no other compression.
            other => return damaged(&format!("its compression is called {other:?}")),
        };
        if records.len() as u64 != header.uncompressed_size {
            return damaged("the length of its data differs from its header");
        }
        if header.uncompressed_crc != 0 && crc32fast::hash(&records) != header.uncompressed_crc {
            return damaged("its checksum is wrong");
        }
        Ok(Self {
            offset,
            records,
            next: 0,
        })
    }

    /// Returns the kind and the body of the next record; `None` at the end, or if the record is
    /// unreadable.
    pub(super) fn next(&mut self) -> Option<(u8, &[u8])> {
        let (kind, body, _) = wire::split(self.records.get(self.next..)?)?;
        self.next += HEADER as usize + body.len();
        Some((kind, body))
    }

    /// Returns true if unreadable bytes are left.
    pub(super) fn is_cut(&self) -> bool {
        self.next < self.records.len()
    }
}

/// Name of a compression that the MCAP format defines but this reader does not support.
const ZSTD: &str = "zstd";

/// Returns the contents of LZ4 frames, but at most one byte more than `size`. Memory grows only
/// with the actual output.
fn decompress(data: &[u8], size: u64) -> Result<Vec<u8>, String> {
    let mut records = Vec::new();
    let decoder = lz4::Decoder::new(data).map_err(|error| error.to_string())?;
    match decoder
        .take(size.saturating_add(1))
        .read_to_end(&mut records)
    {
        Ok(_) => Ok(records),
        Err(error) => Err(format!("its compressed data: {error}")),
    }
}
