//! What the protocols of the Franka Hand and of the vacuum gripper have in common: the 10-byte
//! header, 16-bit statuses, and one reply to every command, given when the action has ended.

mod failure;
mod service;
mod status;

pub use failure::Failure;
pub(crate) use service::{Draft, EndEffector};
pub use status::{Reply, Status};

use zerocopy::byteorder::little_endian::U16;

use crate::framing::{FrameError, MAX_REQUEST_SIZE, Message, next_message_of};

/// The first message in `received`, or `None` while it is incomplete.
///
/// No message of these services is longer than 50 bytes; the bound is [`MAX_REQUEST_SIZE`].
///
/// # Errors
/// [`FrameError`] if its size is below the header's or above the bound. That shows as soon as the
/// header is there.
pub fn next_message(received: &[u8]) -> Result<Option<Message<'_>>, FrameError> {
    next_message_of::<U16>(received, MAX_REQUEST_SIZE)
}
