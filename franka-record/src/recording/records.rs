//! The records of a whole MCAP file in memory. The file can contain any bytes.

use mcap::MAGIC;
use mcap::records::{Record, op};

use super::bytes::Bytes;
use super::chunk::Chunk;
use super::error::RecordingError;
use super::index::Index;
use super::wire::{self, Fields, HEADER};

/// Calls `take` first with all metadata, and then with the channels and messages of every chunk, in
/// the order of the file. Stops at the first damaged chunk. Returns a description of the file's
/// damage, if any.
///
/// The function does not trust a length in the file before it has read that many bytes.
///
/// # Errors
/// Returns the errors of `take`, and [`RecordingError::NotMcap`] if the file is not an MCAP file.
pub(crate) fn each_record<E: From<RecordingError>>(
    file: &[u8],
    mut take: impl FnMut(Record<'_>) -> Result<(), E>,
) -> Result<Option<String>, E> {
    let bytes = Bytes::of_memory(file.to_vec());
    let index = Index::of_records(&bytes)?;
    for entry in &index.metadata {
        let record = bytes.read(entry.offset, entry.length);
        let record = record.map_err(RecordingError::from)?;
        match record.as_deref().and_then(wire::first) {
            Some(record) => take(record)?,
            None => return Ok(Some(format!("metadata at byte {}", entry.offset))),
        }
    }
    for entry in &index.chunks {
        let mut chunk = match Chunk::read(&bytes, entry) {
            Ok(chunk) => chunk,
            Err(error) => return Ok(Some(error.to_string())),
        };
        while let Some((kind, body)) = chunk.next() {
            let (op::CHANNEL | op::MESSAGE) = kind else {
                continue;
            };
            let Some(record) = wire::parse(kind, body) else {
                let at = entry.offset;
                return Ok(Some(format!("a short record in the chunk at byte {at}")));
            };
            take(record)?;
        }
        if chunk.is_cut() {
            let at = entry.offset;
            return Ok(Some(format!(
                "the last record of the chunk at byte {at} is cut off"
            )));
        }
    }
    Ok(index
        .damage
        .or_else(|| damage_outside(file, index.data_end)))
}

/// Returns the damage outside of chunks: a wrong checksum over the bytes before `data_end`, or a
/// damaged end of the file.
fn damage_outside(file: &[u8], data_end: Option<u64>) -> Option<String> {
    let data_end = usize::try_from(data_end?).ok()?;
    let (data, rest) = file.split_at_checked(data_end)?;
    let mut fields = Fields(rest.get(HEADER as usize..)?);
    let crc = fields.u32()?;
    if crc != 0 && crc32fast::hash(data) != crc {
        return Some("the checksum of its data is wrong".to_owned());
    }
    (!file.ends_with(MAGIC)).then(|| "its end is missing".to_owned())
}
