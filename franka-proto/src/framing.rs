//! Splits a byte stream into whole messages.
//!
//! Every message on the robot's TCP stream is a 12-byte [`Header`] and a payload. The header's
//! `size` is the length of header and payload together. The headers of end effectors have 10 bytes:
//! see [`gripper::next_message`](crate::gripper::next_message).
//!
//! ```
//! use franka_proto::framing::{Header, next_message};
//!
//! let header = Header { command: 2, command_id: 7, size: 13 };
//! let mut received = header.to_bytes().to_vec();
//! assert_eq!(next_message(&received), Ok(None)); // the payload is still on its way
//! received.push(0);
//! let message = next_message(&received)?.expect("complete now");
//! assert_eq!((message.header.command_id, message.payload), (7, &[0][..]));
//! # Ok::<(), franka_proto::framing::FrameError>(())
//! ```

use zerocopy::byteorder::little_endian::U32;
use zerocopy::{FromBytes, IntoBytes};

use crate::command::CommandId;
use crate::wire::{self, CommandNumber};

/// The longest message that [`next_message`] waits for, in bytes: 8 MiB.
///
/// The longest messages contain the URDF text of protocol 10 (tens of KiB) or the shared library of
/// protocol 5 (at most a few MiB). Without a bound, four wrong bytes could make a reader collect 4
/// GiB before it detects the error.
pub const MAX_MESSAGE_SIZE: usize = 8 << 20;

/// The longest request that a robot waits for, in bytes.
///
/// The longest defined request, `SetCollisionBehavior`, has 428 bytes. The remaining space is for
/// clients that pad their requests.
pub const MAX_REQUEST_SIZE: usize = 1024;

/// The header of every message on the stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Header {
    /// Number of the command, which depends on the version. A reply repeats this number, but the
    /// client does not check it.
    pub command: u32,
    /// Id of the request. A reply repeats this id.
    pub command_id: u32,
    /// Length of the whole message in bytes, including this header.
    pub size: u32,
}

impl Header {
    /// Length in bytes of a header on the robot's stream.
    pub const SIZE: usize = size_of::<wire::CommandHeader<U32>>();

    /// Returns the id of the request. For a reply, this is the request that it answers.
    #[must_use]
    pub fn id(&self) -> CommandId {
        CommandId(self.command_id)
    }

    /// Returns the bytes for the robot's stream.
    #[must_use]
    pub fn to_bytes(self) -> [u8; Self::SIZE] {
        let mut bytes = [0; Self::SIZE];
        bytes.copy_from_slice(self.to_wire::<U32>().as_bytes());
        bytes
    }

    pub(crate) fn to_wire<N: CommandNumber>(self) -> wire::CommandHeader<N> {
        wire::CommandHeader {
            command: N::new(self.command),
            command_id: self.command_id.into(),
            size: self.size.into(),
        }
    }
}

/// A whole message, borrowed from the bytes received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// The header. Its `size` has been checked.
    pub header: Header,
    /// The bytes after the header.
    pub payload: &'a [u8],
}

impl Message<'_> {
    /// Returns the length of the whole message in bytes. Advance the stream by this number.
    #[must_use]
    pub fn size(&self) -> usize {
        self.header.size as usize
    }
}

/// The bytes of a stream cannot be split into messages. The stream is no longer usable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The size in a header is smaller than the header itself.
    #[error("libfranka: Incorrect TCP message size.")]
    TooShort {
        /// The size in the header, in bytes.
        got: u32,
    },
    /// The size in a header is larger than the longest message allowed.
    #[error("the header announces a message of {got} bytes, expected {limit} at most")]
    TooLong {
        /// The size in the header, in bytes.
        got: u32,
        /// The longest message allowed, in bytes.
        limit: usize,
    },
}

/// Returns the first message in `received`, or `None` while the message is incomplete.
///
/// # Errors
/// Returns [`FrameError`] if the message size is smaller than the header or larger than
/// [`MAX_MESSAGE_SIZE`]. The function returns the error as soon as the header has arrived.
pub fn next_message(received: &[u8]) -> Result<Option<Message<'_>>, FrameError> {
    next_message_within(received, MAX_MESSAGE_SIZE)
}

/// Returns the first message as [`next_message`] does, with a limit such as [`MAX_REQUEST_SIZE`]
/// for its size.
///
/// # Errors
/// Returns [`FrameError`] if the size is smaller than the header or larger than `limit`.
pub fn next_message_within(
    received: &[u8],
    limit: usize,
) -> Result<Option<Message<'_>>, FrameError> {
    next_message_of::<U32>(received, limit)
}

/// Returns the first message as [`next_message_within`] does, for headers with a command number of
/// type `N`.
pub(crate) fn next_message_of<N: CommandNumber>(
    received: &[u8],
    limit: usize,
) -> Result<Option<Message<'_>>, FrameError> {
    let Ok((wire, rest)) = wire::CommandHeader::<N>::read_from_prefix(received) else {
        return Ok(None);
    };
    let header = Header {
        command: wire.command.get(),
        command_id: wire.command_id.get(),
        size: wire.size.get(),
    };
    let size = header.size as usize;
    let Some(length) = size.checked_sub(size_of::<wire::CommandHeader<N>>()) else {
        return Err(FrameError::TooShort { got: header.size });
    };
    if size > limit {
        return Err(FrameError::TooLong {
            got: header.size,
            limit,
        });
    }
    Ok(rest
        .get(..length)
        .map(|payload| Message { header, payload }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn header(size: u32) -> Vec<u8> {
        Header {
            command: 1,
            command_id: 2,
            size,
        }
        .to_bytes()
        .to_vec()
    }

    #[test]
    fn a_message_shows_only_when_its_last_byte_is_there() {
        let mut bytes = header(16);
        bytes.extend([1, 2, 3, 4, 5]);
        for length in 0..16 {
            assert_eq!(next_message(&bytes[..length]), Ok(None), "{length}");
        }
        let message = next_message(&bytes).unwrap().unwrap();
        assert_eq!(message.payload, [1, 2, 3, 4]);
        assert_eq!(message.size(), 16);
        assert_eq!(message.header.id(), CommandId(2));
    }

    #[test]
    fn a_size_below_the_header_is_an_error() {
        for size in 0..12 {
            let error = next_message(&header(size)).unwrap_err();
            assert_eq!(error, FrameError::TooShort { got: size });
            assert_eq!(
                std::format!("{error}"),
                "libfranka: Incorrect TCP message size."
            );
        }
        assert!(next_message(&header(12)).unwrap().is_some());
    }

    #[test]
    fn a_size_above_the_bound_is_an_error_before_the_payload_comes() {
        assert_eq!(next_message(&header(MAX_MESSAGE_SIZE as u32)), Ok(None));
        assert_eq!(
            next_message(&header(u32::MAX)),
            Err(FrameError::TooLong {
                got: u32::MAX,
                limit: MAX_MESSAGE_SIZE
            })
        );
        assert_eq!(
            next_message_within(&header(1025), MAX_REQUEST_SIZE),
            Err(FrameError::TooLong {
                got: 1025,
                limit: 1024
            })
        );
    }
}
