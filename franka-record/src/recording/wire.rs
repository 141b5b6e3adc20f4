//! Parses the MCAP records that the reader of recordings needs. Source: the MCAP format
//! specification, version 0.
//!
//! The types come from the crate `mcap`. Its parsers do not suit damaged files: version 0.26
//! reserves memory by lengths that it has not verified, may panic, and returns some data before it
//! verifies the checksum. The functions here trust a length only once they have read that many
//! bytes.

use std::collections::BTreeMap;

use mcap::records::{
    AttachmentHeader, Channel, ChunkHeader, Footer, Header, MessageHeader, Metadata, Record,
    SchemaHeader, op,
};

/// Number of bytes of a record before its body: the record kind and the length of the body.
pub(super) const HEADER: u64 = 9;

/// Returns the record kind and the length of the body.
pub(super) fn header(bytes: &[u8]) -> Option<(u8, u64)> {
    let mut fields = Fields(bytes);
    Some((fields.u8()?, fields.u64()?))
}

/// Splits off the first record. Returns its kind, its body and the bytes after the record.
pub(super) fn split(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (kind, length) = header(bytes)?;
    let rest = &bytes[HEADER as usize..];
    let length = usize::try_from(length).ok()?;
    let (body, rest) = rest.split_at_checked(length)?;
    Some((kind, body, rest))
}

/// Parses the first record; `None` if it is damaged.
pub(super) fn first(bytes: &[u8]) -> Option<Record<'_>> {
    let (kind, body, _) = split(bytes)?;
    parse(kind, body)
}

/// Parses a record; `None` if it is damaged. A kind that the reader does not need is
/// [`Record::Unknown`].
pub(super) fn parse(kind: u8, body: &[u8]) -> Option<Record<'_>> {
    let mut fields = Fields(body);
    let fields = &mut fields;
    Some(match kind {
        op::HEADER => Record::Header(Header {
            profile: fields.text()?,
            library: fields.text()?,
        }),
        op::FOOTER => Record::Footer(Footer {
            summary_start: fields.u64()?,
            summary_offset_start: fields.u64()?,
            summary_crc: fields.u32()?,
        }),
        op::SCHEMA => {
            let header = SchemaHeader {
                id: fields.u16()?,
                name: fields.text()?,
                encoding: fields.text()?,
            };
            let length = fields.u32()?.into();
            let data = fields.bytes(length)?.into();
            Record::Schema { header, data }
        }
        op::CHANNEL => Record::Channel(Channel {
            id: fields.u16()?,
            schema_id: fields.u16()?,
            topic: fields.text()?,
            message_encoding: fields.text()?,
            metadata: fields.map()?,
        }),
        op::MESSAGE => {
            let (header, data) = message(body)?;
            let data = data.into();
            Record::Message { header, data }
        }
        op::CHUNK => {
            let header = chunk_header(body)?;
            // The header takes as many bytes as its fields.
            let length = CHUNK_HEADER as usize + header.compression.len();
            let data = Fields(&body[length..]).bytes(header.compressed_size)?;
            let data = data.into();
            Record::Chunk { header, data }
        }
        op::ATTACHMENT => {
            let header = AttachmentHeader {
                log_time: fields.u64()?,
                create_time: fields.u64()?,
                name: fields.text()?,
                media_type: fields.text()?,
            };
            let length = fields.u64()?;
            let data = fields.bytes(length)?.into();
            let checked = &body[..body.len() - fields.0.len()];
            let crc = fields.u32()?;
            if crc != 0 && crc32fast::hash(checked) != crc {
                return None;
            }
            Record::Attachment { header, data, crc }
        }
        op::METADATA => Record::Metadata(Metadata {
            name: fields.text()?,
            metadata: fields.map()?,
        }),
        opcode => Record::Unknown {
            opcode,
            data: body.into(),
        },
    })
}

/// Parses the body of a message.
pub(super) fn message(body: &[u8]) -> Option<(MessageHeader, &[u8])> {
    let mut fields = Fields(body);
    let header = MessageHeader {
        channel_id: fields.u16()?,
        sequence: fields.u32()?,
        log_time: fields.u64()?,
        publish_time: fields.u64()?,
    };
    Some((header, fields.0))
}

/// Parses the first bytes of the body of a chunk.
pub(super) fn chunk_header(body: &[u8]) -> Option<ChunkHeader> {
    let mut fields = Fields(body);
    Some(ChunkHeader {
        message_start_time: fields.u64()?,
        message_end_time: fields.u64()?,
        uncompressed_size: fields.u64()?,
        uncompressed_crc: fields.u32()?,
        compression: fields.text()?,
        compressed_size: fields.u64()?,
    })
}

/// Number of bytes of the header of a chunk, without the name of its compression.
pub(super) const CHUNK_HEADER: u64 = 8 + 8 + 8 + 4 + 4 + 8;

/// Reads fields in their order. Each method returns `None` if too few bytes are left.
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    fn bytes(&mut self, length: u64) -> Option<&'a [u8]> {
        let (bytes, rest) = self.0.split_at_checked(usize::try_from(length).ok()?)?;
        self.0 = rest;
        Some(bytes)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (array, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*array)
    }

    fn u8(&mut self) -> Option<u8> {
        self.array().map(u8::from_le_bytes)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Reads a text and the length before it.
    fn text(&mut self) -> Option<String> {
        let length = self.u32()?.into();
        std::str::from_utf8(self.bytes(length)?)
            .ok()
            .map(str::to_owned)
    }

    fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let length = self.u32()?.into();
        let mut entries = Fields(self.bytes(length)?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            map.insert(entries.text()?, entries.text()?);
        }
        Some(map)
    }
}
