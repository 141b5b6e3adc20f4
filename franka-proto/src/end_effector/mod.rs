//! Common parts of the protocols of the Franka Hand and of the vacuum gripper: the 10-byte header,
//! the 16-bit statuses, and the single reply to each command after its action.

mod failure;
mod service;
mod status;

pub use failure::Failure;
pub(crate) use service::{Draft, EndEffector};
pub use status::{Reply, Status};

use zerocopy::byteorder::little_endian::U16;

use crate::framing::{FrameError, MAX_REQUEST_SIZE, Message, next_message_of};

/// Returns the first message in `received`, or `None` while the message is incomplete.
///
/// The longest allowed size is [`MAX_REQUEST_SIZE`]. No message of these services is longer than 50
/// bytes.
///
/// # Errors
/// Returns [`FrameError`] if the message size is smaller than the header or larger than
/// [`MAX_REQUEST_SIZE`]. The function returns the error as soon as the header has arrived.
pub fn next_message(received: &[u8]) -> Result<Option<Message<'_>>, FrameError> {
    next_message_of::<U16>(received, MAX_REQUEST_SIZE)
}
