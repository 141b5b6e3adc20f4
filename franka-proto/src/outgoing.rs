//! A message ready for the stream.

use core::fmt;

use zerocopy::byteorder::little_endian::U32;
use zerocopy::{Immutable, IntoBytes};

use crate::command::CommandId;
use crate::framing::Header;
use crate::wire::{self, CommandNumber};

/// One TCP message, header and payload, to send with one write.
///
/// The longest message is `SetCollisionBehavior` with 428 bytes. The buffer is inline, so creating
/// a message allocates nothing. The variable part of a model reply is not included: see
/// [`server::Session::model_header`](crate::server::Session::model_header).
#[derive(Clone, PartialEq, Eq)]
pub struct Outgoing {
    bytes: [u8; Self::CAPACITY],
    len: usize,
    id: CommandId,
}

impl Outgoing {
    /// Size of the inline buffer in bytes. It is enough for the longest fixed message.
    pub const CAPACITY: usize = 440;

    /// Creates a message of the robot's service: a header followed by `payload`. The header's size
    /// includes `extra` bytes that the caller sends afterwards.
    pub(crate) fn new<P: IntoBytes + Immutable + ?Sized>(
        command: u32,
        id: CommandId,
        payload: &P,
        extra: usize,
    ) -> Self {
        Self::with_header::<U32, P>(command, id, payload, extra)
    }

    /// Like [`Outgoing::new`], for a service whose headers use `N` for the command number.
    pub(crate) fn with_header<N: CommandNumber, P: IntoBytes + Immutable + ?Sized>(
        command: u32,
        id: CommandId,
        payload: &P,
        extra: usize,
    ) -> Self {
        let payload = payload.as_bytes();
        let header_len = size_of::<wire::CommandHeader<N>>();
        let len = header_len + payload.len();
        let mut bytes = [0; Self::CAPACITY];
        let header = Header {
            command,
            command_id: id.0,
            // Callers bound `extra` by `framing::MAX_MESSAGE_SIZE`, far below 2^32.
            size: (len + extra) as u32,
        };
        bytes[..header_len].copy_from_slice(header.to_wire::<N>().as_bytes());
        bytes[header_len..len].copy_from_slice(payload);
        Self { bytes, len, id }
    }

    /// The command id of the message. The replies carry the same id.
    #[must_use]
    pub fn id(&self) -> CommandId {
        self.id
    }

    /// The bytes to send.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes[..self.len]
    }
}

impl AsRef<[u8]> for Outgoing {
    fn as_ref(&self) -> &[u8] {
        self.as_bytes()
    }
}

impl fmt::Debug for Outgoing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Outgoing")
            .field("id", &self.id)
            .field("len", &self.len)
            .finish_non_exhaustive()
    }
}
