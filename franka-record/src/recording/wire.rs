//! The MCAP records that the reader of recordings needs.
//!
//! This module replaces the crate `mcap` for reading, because it does not trust a length in a
//! damaged file before it has read that many bytes. Source: the MCAP format specification, version
//! 0.

use std::collections::BTreeMap;

/// Bytes at the beginning and at the end of an MCAP file.
pub(super) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// Kinds of record.
pub(super) mod op {
    pub(in crate::recording) const HEADER: u8 = 0x01;
    pub(in crate::recording) const FOOTER: u8 = 0x02;
    pub(in crate::recording) const SCHEMA: u8 = 0x03;
    pub(in crate::recording) const CHANNEL: u8 = 0x04;
    pub(in crate::recording) const MESSAGE: u8 = 0x05;
    pub(in crate::recording) const CHUNK: u8 = 0x06;
    pub(in crate::recording) const CHUNK_INDEX: u8 = 0x08;
    pub(in crate::recording) const ATTACHMENT: u8 = 0x09;
    pub(in crate::recording) const ATTACHMENT_INDEX: u8 = 0x0a;
    pub(in crate::recording) const METADATA: u8 = 0x0c;
    pub(in crate::recording) const METADATA_INDEX: u8 = 0x0d;
    pub(in crate::recording) const DATA_END: u8 = 0x0f;
}

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

/// Reads fields in their order. Each method returns `None` if too few bytes are left.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    pub(super) fn bytes(&mut self, length: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(bytes)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.try_into().ok()
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.array().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Reads a text and the length before it.
    pub(super) fn text(&mut self) -> Option<&'a str> {
        let length = usize::try_from(self.u32()?).ok()?;
        std::str::from_utf8(self.bytes(length)?).ok()
    }

    pub(super) fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let length = usize::try_from(self.u32()?).ok()?;
        let mut entries = Fields(self.bytes(length)?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            let name = entries.text()?.to_owned();
            map.insert(name, entries.text()?.to_owned());
        }
        Some(map)
    }
}

pub(super) struct Schema<'a> {
    pub(super) id: u16,
    pub(super) name: &'a str,
    pub(super) encoding: &'a str,
    pub(super) data: &'a [u8],
}

impl<'a> Schema<'a> {
    pub(super) fn read(body: &'a [u8]) -> Option<Self> {
        let mut fields = Fields(body);
        let (id, name, encoding) = (fields.u16()?, fields.text()?, fields.text()?);
        let length = usize::try_from(fields.u32()?).ok()?;
        Some(Self {
            id,
            name,
            encoding,
            data: fields.bytes(length)?,
        })
    }
}

pub(super) struct Channel<'a> {
    pub(super) id: u16,
    pub(super) schema: u16,
    pub(super) topic: &'a str,
    pub(super) encoding: &'a str,
    pub(super) metadata: BTreeMap<String, String>,
}

impl<'a> Channel<'a> {
    pub(super) fn read(body: &'a [u8]) -> Option<Self> {
        let mut fields = Fields(body);
        Some(Self {
            id: fields.u16()?,
            schema: fields.u16()?,
            topic: fields.text()?,
            encoding: fields.text()?,
            metadata: fields.map()?,
        })
    }
}

#[derive(Clone, Copy)]
pub(super) struct Message<'a> {
    pub(super) channel: u16,
    pub(super) sequence: u32,
    pub(super) log_time: u64,
    pub(super) publish_time: u64,
    pub(super) data: &'a [u8],
}

impl<'a> Message<'a> {
    pub(super) fn read(body: &'a [u8]) -> Option<Self> {
        let mut fields = Fields(body);
        Some(Self {
            channel: fields.u16()?,
            sequence: fields.u32()?,
            log_time: fields.u64()?,
            publish_time: fields.u64()?,
            data: fields.0,
        })
    }
}

/// The header of a chunk, before its data.
pub(super) struct ChunkHeader<'a> {
    pub(super) begin: u64,
    pub(super) end: u64,
    pub(super) size: u64,
    pub(super) crc: u32,
    pub(super) compression: &'a str,
    pub(super) compressed_size: u64,
}

impl<'a> ChunkHeader<'a> {
    /// Largest length of the header, with any supported compression.
    pub(super) const LENGTH_MAX: u64 = 8 + 8 + 8 + 4 + 4 + 16 + 8;

    pub(super) fn read(fields: &mut Fields<'a>) -> Option<Self> {
        Some(Self {
            begin: fields.u64()?,
            end: fields.u64()?,
            size: fields.u64()?,
            crc: fields.u32()?,
            compression: fields.text()?,
            compressed_size: fields.u64()?,
        })
    }
}

/// An attachment. The position of its data is relative to the record's body.
pub(super) struct AttachmentHeader<'a> {
    pub(super) log_time: u64,
    pub(super) create_time: u64,
    pub(super) name: &'a str,
    pub(super) media_type: &'a str,
}

impl<'a> AttachmentHeader<'a> {
    pub(super) fn read(fields: &mut Fields<'a>) -> Option<Self> {
        Some(Self {
            log_time: fields.u64()?,
            create_time: fields.u64()?,
            name: fields.text()?,
            media_type: fields.text()?,
        })
    }
}
