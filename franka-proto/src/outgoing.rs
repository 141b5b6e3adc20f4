//! A message ready for the stream.

use core::fmt;

use zerocopy::{Immutable, IntoBytes};

use crate::framing::Header;
use crate::service::CommandId;

/// One TCP message to send with one write: header and payload.
///
/// The longest is `SetCollisionBehavior` with 428 bytes; the buffer is inline, so making one
/// allocates nothing. The variable part of a model reply is not in here: see
/// [`server::Session::model_header`](crate::server::Session::model_header).
#[derive(Clone, PartialEq, Eq)]
pub struct Outgoing {
    bytes: [u8; Self::CAPACITY],
    len: usize,
    id: CommandId,
}

impl Outgoing {
    /// Size of the inline buffer in bytes: room for the longest fixed message.
    pub const CAPACITY: usize = 440;

    /// A header followed by `payload`; `extra` bytes that the caller sends behind it count in the
    /// header's size.
    pub(crate) fn new<P: IntoBytes + Immutable + ?Sized>(
        command: u32,
        id: CommandId,
        payload: &P,
        extra: usize,
    ) -> Self {
        let payload = payload.as_bytes();
        let len = Header::SIZE + payload.len();
        let mut bytes = [0; Self::CAPACITY];
        let header = Header {
            command,
            command_id: id.0,
            // Callers bound `extra` by `framing::MAX_MESSAGE_SIZE`, far below 2^32.
            size: (len + extra) as u32,
        };
        bytes[..Header::SIZE].copy_from_slice(&header.to_bytes());
        bytes[Header::SIZE..len].copy_from_slice(payload);
        Self { bytes, len, id }
    }

    /// The command id of the message, by which replies are matched.
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
