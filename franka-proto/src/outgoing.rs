//! A message that is ready to send.

use core::fmt;

use zerocopy::byteorder::little_endian::U32;
use zerocopy::{Immutable, IntoBytes};

use crate::command::CommandId;
use crate::framing::Header;
use crate::wire::{self, CommandNumber};

/// One TCP message (header and payload). Send it with one write.
///
/// The longest message is `SetCollisionBehavior` with 428 bytes. The buffer is inline, so a message
/// needs no allocation. A reply with a model contains only its fixed part; see
/// [`server::Session::model_header`](crate::server::Session::model_header).
#[derive(Clone, PartialEq, Eq)]
pub struct Outgoing {
    bytes: [u8; Self::CAPACITY],
    len: usize,
    id: CommandId,
}

impl Outgoing {
    /// Size of the inline buffer in bytes. It holds the longest message whose length is fixed.
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

    /// Creates a message as [`Outgoing::new`] does, for headers with a command number of type `N`.
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

    /// Returns the id of the request. Its replies have the same id.
    #[must_use]
    pub fn id(&self) -> CommandId {
        self.id
    }

    /// Returns the bytes to send.
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
